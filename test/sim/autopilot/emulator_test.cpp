// The emulated autopilots compared with measurements of the real ones.

#include <gtest/gtest.h>

#include "sim/autopilot/pose_estimator.hpp"
#include "sim/autopilot/profile.hpp"
#include "test/sim/autopilot/hand.hpp"

namespace vantage::sim {
namespace {

using models::AutopilotDialect;
using Hand = test::EmulatorHand;

constexpr std::uint32_t kOffboard = 6U << 16U;
constexpr std::uint32_t kPx4Land = 4U << 16U | 6U << 24U;

void listen(Hand& hand) {
  for (const float id : {32.0F, 230.0F, 193.0F}) {
    hand.command(511, id, 50'000.0F);
  }
}

Hand flying_px4() {
  Hand hand(AutopilotDialect::kPx4);
  listen(hand);
  hand.sends_poses = true;
  hand.run(5.0);
  hand.target = Hand::position(1.0F, -2.0F, -1.6F, -0.5F);
  hand.run(1.5);
  EXPECT_EQ(hand.command(176, 1, 6), 0);
  EXPECT_EQ(hand.command(400, 1), 0);
  hand.run(8.0);
  EXPECT_NEAR(hand.height_m(), 1.5, 0.1);
  return hand;
}

// Returns an ArduPilot on the ground that receives poses and has its origin.
Hand placed_ardupilot() {
  Hand hand(AutopilotDialect::kArdupilot);
  listen(hand);
  hand.sends_poses = true;
  hand.run(5.0);
  hand.send(wire::mavlink::SetGpsGlobalOrigin{});
  return hand;
}

Hand flying_ardupilot() {
  Hand hand = placed_ardupilot();
  hand.run(21.0);
  EXPECT_EQ(hand.command(176, 1, 4), 0);
  EXPECT_EQ(hand.command(400, 1), 0);
  EXPECT_EQ(hand.command(22, 0, 0, 0, 1.5F), 0);
  hand.run(6.0);
  EXPECT_NEAR(hand.height_m(), 1.5, 0.1);
  return hand;
}

// A late pose is compared with the vehicle's position at its capture time.
TEST(PoseEstimator, IsExactWithLatePosesInMotion) {
  PoseEstimatorTraits traits;
  traits.converge_s = 0.1;
  for (const int late_ms : {0, 20, 200}) {
    PoseEstimator estimator(traits);
    estimator.set_loss(1.0);
    const Time start = from_utime(1'000'000);
    for (int ms = 0; ms < 2'000; ms += 10) {
      const auto at = [&](int of_ms) { return Eigen::Vector3d(0.0015 * of_ms, 0.3, 1.0); };
      estimator.move(start + std::chrono::milliseconds(ms), at(ms), 0.01);
      if (ms >= late_ms) {
        estimator.fuse(start + std::chrono::milliseconds(ms),
                       start + std::chrono::milliseconds(ms - late_ms), at(ms - late_ms), 0);
        EXPECT_LT((estimator.position_m() - at(ms)).norm(), 1e-9) << late_ms << " ms late";
      }
    }
    EXPECT_TRUE(estimator.is_ready(start + std::chrono::milliseconds(1'990)));
  }
}

// ArduPilot checks for its station three times per second.
TEST(AutopilotProfile, ChecksStationAtTheRealRate) {
  EXPECT_DOUBLE_EQ(3.0 * profile_of(AutopilotDialect::kArdupilot).station_check_s, 1.0);
}

TEST(EmulatedPx4, IsReadySoonAfterTheFirstPose) {
  Hand hand(AutopilotDialect::kPx4);
  listen(hand);
  hand.run(10.0);
  EXPECT_EQ(hand.flags, 0x0A5);
  EXPECT_EQ(hand.command(400, 1), 1);
  hand.sends_poses = true;
  hand.run(0.5);
  EXPECT_EQ(hand.flags, 0x1AF);
  EXPECT_EQ(hand.command(400, 1), 0);
}

// PX4 1.18 sends STATUSTEXT only where it receives a heartbeat of type GCS.
TEST(EmulatedPx4, SendsReasonsOnlyToGroundStations) {
  Hand hand(AutopilotDialect::kPx4);
  listen(hand);
  hand.run(1.0);
  wire::mavlink::Heartbeat heartbeat;
  heartbeat.type = wire::mavlink::type::kOnboardController;
  hand.send(heartbeat);
  EXPECT_EQ(hand.command(400, 1), 1);
  EXPECT_TRUE(hand.last_text.empty());
  heartbeat.type = wire::mavlink::type::kGroundStation;
  hand.send(heartbeat);
  EXPECT_EQ(hand.command(400, 1), 1);
  EXPECT_FALSE(hand.last_text.empty());
}

TEST(EmulatedPx4, IgnoresMocapPoses) {
  Hand hand(AutopilotDialect::kPx4);
  hand.sends_poses = true;
  hand.estimator_type = 6;
  hand.run(10.0);
  EXPECT_EQ(hand.command(400, 1), 1);
  EXPECT_EQ(hand.emulator.controller().estimator().poses(), 0);
}

TEST(EmulatedPx4, ArmsInOffboardAfterOneSecondOfSetPoints) {
  Hand hand(AutopilotDialect::kPx4);
  hand.sends_poses = true;
  hand.run(5.0);
  EXPECT_EQ(hand.command(176, 1, 6), 0);
  EXPECT_EQ(hand.mode(), kOffboard);
  EXPECT_EQ(hand.command(400, 1), 1);
  hand.target = Hand::position(1.0F, -2.0F, -1.6F, 0.0F);
  hand.run(0.8);
  EXPECT_EQ(hand.command(400, 1), 1);
  hand.run(0.5);
  EXPECT_EQ(hand.command(400, 1), 0);
}

// COM_OF_LOSS_T, with the default and set values.
TEST(EmulatedPx4, LandsAfterComOfLossT) {
  for (const double timeout_s : {0.3, 1.0, 2.0}) {
    Hand hand = flying_px4();
    hand.set_parameter("COM_OF_LOSS_T", timeout_s);
    hand.target.reset();
    hand.run(timeout_s - 0.02);
    EXPECT_EQ(hand.mode(), kOffboard);
    hand.run(0.2);
    EXPECT_EQ(hand.mode(), kPx4Land);
    hand.run(12.0);
    EXPECT_FALSE(hand.armed());
  }
}

TEST(EmulatedPx4, HoldsOnSetPointLossUnlessConfiguredToLand) {
  Hand hand = flying_px4();
  hand.set_parameter("COM_OBL_RC_ACT", 0.0);
  hand.target.reset();
  hand.run(20.0);
  EXPECT_EQ(hand.mode(), kOffboard);
  EXPECT_TRUE(hand.armed());
}

TEST(EmulatedPx4, KeepsMotorsRunningWithANegativeDisarmDelay) {
  Hand hand = flying_px4();
  hand.set_parameter("COM_DISARM_LAND", -1.0);
  EXPECT_EQ(hand.command(21, 0), 0);
  hand.run(30.0);
  EXPECT_TRUE(hand.armed());
}

TEST(EmulatedPx4, LosesHeightWithoutPosesAndBarometer) {
  Hand hand = flying_px4();
  hand.set_parameter("EKF2_BARO_CTRL", 0.0);
  hand.sends_poses = false;
  hand.run(2.0);
  EXPECT_EQ(hand.flags, 0x00F);
  hand.run(3.0);
  EXPECT_EQ(hand.flags, 0x005);
}

TEST(EmulatedPx4, FollowsVelocitiesSmoothly) {
  Hand hand = flying_px4();
  const Eigen::Vector3d before_m = hand.emulator.world_from_body().translation_m;
  hand.target = Hand::velocity(0.5F, 0.0F, 0.0F, 0.0F);
  hand.run(2.0);
  const double at_two_m = hand.emulator.world_from_body().translation_m.x();
  hand.run(2.0);
  const double mean_mps = (hand.emulator.world_from_body().translation_m.x() - at_two_m) / 2.0;
  EXPECT_GT(mean_mps, 0.43);
  EXPECT_LT(mean_mps, 0.51);
  EXPECT_NEAR(hand.emulator.world_from_body().translation_m.y(), before_m.y(), 0.1);
}

TEST(EmulatedArdupilot, DoesNotArmWithoutAnOrigin) {
  Hand hand(AutopilotDialect::kArdupilot);
  listen(hand);
  hand.sends_poses = true;
  hand.run(4.9);
  EXPECT_EQ(hand.positions, 0);
  hand.run(1.1);
  EXPECT_GT(hand.positions, 0);
  EXPECT_EQ(hand.flags, 0x33F);
  hand.run(20.0);
  EXPECT_EQ(hand.command(400, 1), 4);
  EXPECT_EQ(hand.last_text, "Arm: AHRS: waiting for home");
  hand.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(hand.command(400, 1), 0);
}

TEST(EmulatedArdupilot, RefusesAnOriginBeforeItsEstimatorRuns) {
  Hand hand(AutopilotDialect::kArdupilot);
  hand.run(3.0);
  hand.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(hand.origins, 0);
  hand.run(1.0);
  hand.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(hand.origins, 1);  // it reports its origin once and accepts no other
  hand.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(hand.origins, 1);
}

TEST(EmulatedArdupilot, RefusesToArmFor22SecondsWithReason) {
  Hand hand = placed_ardupilot();
  hand.run(5.0);
  EXPECT_EQ(hand.command(400, 1), 4);
  EXPECT_EQ(hand.last_text, "Arm: Accels inconsistent");
  hand.run(11.0);
  EXPECT_EQ(hand.command(400, 1), 4);
  EXPECT_EQ(hand.last_text, "Arm: Gyros inconsistent");
  hand.run(2.0);
  EXPECT_EQ(hand.command(400, 1), 0);
}

TEST(EmulatedArdupilot, IgnoresPosesInOtherFrames) {
  Hand hand(AutopilotDialect::kArdupilot);
  hand.sends_poses = true;
  hand.frame = wire::mavlink::frame::kLocalNed;
  hand.run(7.0);
  EXPECT_EQ(hand.emulator.controller().estimator().poses(), 0);
  hand.frame = wire::mavlink::frame::kLocalFrd;
  hand.run(2.0);
  EXPECT_GT(hand.emulator.controller().estimator().poses(), 0);
}

// GUID_TIMEOUT, with the default and set values.
TEST(EmulatedArdupilot, StopsAfterGuidTimeout) {
  for (const double timeout_s : {0.3, 3.0}) {
    Hand hand = flying_ardupilot();
    hand.set_parameter("GUID_TIMEOUT", timeout_s);
    hand.target = Hand::velocity(0.5F, 0.0F, 0.0F, 0.0F);
    hand.run(4.0);
    EXPECT_NEAR(hand.emulator.velocity_world_mps().x(), 0.5, 0.03);
    hand.target.reset();
    hand.run(timeout_s - 0.1);
    EXPECT_NEAR(hand.emulator.velocity_world_mps().x(), 0.5, 0.03);
    hand.run(2.2);
    EXPECT_NEAR(hand.emulator.velocity_world_mps().x(), 0.0, 0.1);
    EXPECT_EQ(hand.mode(), 4U);
  }
}

// FS_GCS_ENABLE, FS_GCS_TIMEOUT, SYSID_MYGCS. A station that never sent anything cannot be lost.
TEST(EmulatedArdupilot, LandsOnStationLossIfConfigured) {
  const auto mode_after = [](double silence_s, const std::string& name, double value) {
    Hand hand = flying_ardupilot();
    hand.set_parameter(name, value);
    hand.sends_heartbeats = true;
    hand.run(2.0);
    hand.sends_heartbeats = false;
    hand.run(silence_s);
    return hand.mode();
  };
  EXPECT_EQ(mode_after(0.7, "FS_GCS_TIMEOUT", 1.0), 4U);
  EXPECT_EQ(mode_after(1.4, "FS_GCS_TIMEOUT", 1.0), 9U);
  EXPECT_EQ(mode_after(2.7, "FS_GCS_TIMEOUT", 3.0), 4U);
  EXPECT_EQ(mode_after(3.4, "FS_GCS_TIMEOUT", 3.0), 9U);
  EXPECT_EQ(mode_after(10.0, "FS_GCS_ENABLE", 0.0), 4U);
  EXPECT_EQ(mode_after(10.0, "SYSID_MYGCS", 200.0), 4U);
  Hand hand = flying_ardupilot();
  hand.run(10.0);
  EXPECT_EQ(hand.mode(), 4U);
}

TEST(EmulatedArdupilot, FollowsTheYawRate) {
  Hand hand = flying_ardupilot();
  hand.target = Hand::velocity(0.0F, 0.0F, 0.0F, 0.5F);
  hand.run(2.0);
  const double before_rad = flatten(hand.emulator.world_from_body()).yaw_rad;
  hand.run(2.0);
  const double after_rad = flatten(hand.emulator.world_from_body()).yaw_rad;
  // Clockwise for an autopilot is negative here.
  EXPECT_NEAR(wrap_to_pi(after_rad - before_rad) / 2.0, -0.5, 0.01);
}

TEST(EmulatedArdupilot, LandsEightSecondsAfterTheLastPose) {
  Hand hand = flying_ardupilot();
  hand.target = Hand::position(1.0F, -2.0F, -1.6F, -0.5F);
  hand.sends_poses = false;
  hand.run(7.5);
  EXPECT_EQ(hand.mode(), 4U);
  hand.run(1.0);
  EXPECT_EQ(hand.mode(), 9U);
  EXPECT_EQ(hand.flags, 0x025);
}

TEST(EmulatedArdupilot, DisarmsTenSecondsAfterArmingWithoutTakeOff) {
  Hand hand = placed_ardupilot();
  hand.run(21.0);
  EXPECT_EQ(hand.command(176, 1, 4), 0);
  EXPECT_EQ(hand.command(400, 1), 0);
  hand.run(9.0);
  EXPECT_TRUE(hand.armed());
  hand.run(2.0);
  EXPECT_FALSE(hand.armed());
}

TEST(EmulatedArdupilot, LandsAndDisarmsAutomatically) {
  Hand hand = flying_ardupilot();
  EXPECT_EQ(hand.command(176, 1, 9), 0);
  hand.run(3.0);
  EXPECT_TRUE(hand.armed());
  hand.run(4.0);
  EXPECT_FALSE(hand.armed());
  EXPECT_NEAR(hand.height_m(), 0.0, 1e-9);
}

TEST(EmulatedAutopilot, RefusesToStopItsMotorsInTheAirUnlessForced) {
  for (Hand hand : {flying_px4(), flying_ardupilot()}) {
    EXPECT_NE(hand.command(400, 0), 0);
    EXPECT_TRUE(hand.armed());
    EXPECT_EQ(hand.command(400, 0, 21196.0F), 0);
    EXPECT_FALSE(hand.armed());
    hand.run(1.0);
    EXPECT_NEAR(hand.height_m(), 0.0, 1e-9);
  }
}

TEST(EmulatedAutopilot, ReportsBatteryLikeTheRealOne) {
  Hand hand(AutopilotDialect::kPx4);
  hand.command(511, 147.0F, 50'000.0F);
  hand.run(0.2);
  ASSERT_TRUE(hand.last_battery);
  EXPECT_EQ(hand.last_battery->voltages[0], 12'600) << "full, and nothing turns";
  EXPECT_EQ(hand.last_battery->voltages[1], 0xFFFF) << "no cells are told apart";
  EXPECT_EQ(hand.last_battery->current_battery, 0);
  EXPECT_EQ(hand.last_battery->temperature, 2'500) << "25 degrees Celsius";
  EXPECT_EQ(hand.last_battery->charge_state, 1);
}

TEST(EmulatedAutopilot, IsDeterministic) {
  const auto fly = [] {
    Hand hand = flying_px4();
    hand.target = Hand::velocity(0.3F, -0.2F, 0.1F, 0.4F);
    hand.run(3.0);
    return hand.emulator.world_from_body().translation_m;
  };
  EXPECT_EQ(fly(), fly());
}

}  // namespace
}  // namespace vantage::sim
