// Compares emulated autopilots with measurements of real ones.

#include <gtest/gtest.h>

#include "sim/autopilot/pose_estimator.hpp"
#include "sim/autopilot/profile.hpp"
#include "test/sim/autopilot/scripted_station.hpp"

namespace vantage::sim {
namespace {

using models::AutopilotDialect;
using Station = test::EmulatorStation;

constexpr std::uint32_t kOffboard = 6U << 16U;
constexpr std::uint32_t kPx4Land = 4U << 16U | 6U << 24U;

void request_messages(Station& station) {
  for (const float id : {32.0F, 230.0F, 193.0F}) {
    station.command(511, id, 50'000.0F);
  }
}

Station flying_px4() {
  Station station(AutopilotDialect::kPx4);
  request_messages(station);
  station.sends_poses = true;
  station.run(5.0);
  station.target = Station::position(1.0F, -2.0F, -1.6F, -0.5F);
  station.run(1.5);
  EXPECT_EQ(station.command(176, 1, 6), 0);
  EXPECT_EQ(station.command(400, 1), 0);
  station.run(8.0);
  EXPECT_NEAR(station.height_m(), 1.5, 0.1);
  return station;
}

// Returns an ArduPilot on the ground that receives poses and has an origin.
Station placed_ardupilot() {
  Station station(AutopilotDialect::kArdupilot);
  request_messages(station);
  station.sends_poses = true;
  station.run(5.0);
  station.send(wire::mavlink::SetGpsGlobalOrigin{});
  return station;
}

Station flying_ardupilot() {
  Station station = placed_ardupilot();
  station.run(21.0);
  EXPECT_EQ(station.command(176, 1, 4), 0);
  EXPECT_EQ(station.command(400, 1), 0);
  EXPECT_EQ(station.command(22, 0, 0, 0, 1.5F), 0);
  station.run(6.0);
  EXPECT_NEAR(station.height_m(), 1.5, 0.1);
  return station;
}

// A late pose is compared with the vehicle's position at the capture time of the pose.
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

// ArduPilot checks the connection to its ground station three times per second.
TEST(AutopilotProfile, ChecksStationAsOftenAsTheFirmware) {
  EXPECT_DOUBLE_EQ(3.0 * profile_of(AutopilotDialect::kArdupilot).station_check_s, 1.0);
}

TEST(EmulatedPx4, IsReadySoonAfterTheFirstPose) {
  Station station(AutopilotDialect::kPx4);
  request_messages(station);
  station.run(10.0);
  EXPECT_EQ(station.flags, 0x0A5);
  EXPECT_EQ(station.command(400, 1), 1);
  station.sends_poses = true;
  station.run(0.5);
  EXPECT_EQ(station.flags, 0x1AF);
  EXPECT_EQ(station.command(400, 1), 0);
}

// PX4 1.18 sends STATUSTEXT only on links on which it receives a heartbeat of type GCS.
TEST(EmulatedPx4, SendsReasonsOnlyToGroundStations) {
  Station station(AutopilotDialect::kPx4);
  request_messages(station);
  station.run(1.0);
  wire::mavlink::Heartbeat heartbeat;
  heartbeat.type = wire::mavlink::type::kOnboardController;
  station.send(heartbeat);
  EXPECT_EQ(station.command(400, 1), 1);
  EXPECT_TRUE(station.last_text.empty());
  heartbeat.type = wire::mavlink::type::kGroundStation;
  station.send(heartbeat);
  EXPECT_EQ(station.command(400, 1), 1);
  EXPECT_FALSE(station.last_text.empty());
}

TEST(EmulatedPx4, IgnoresMocapPoses) {
  Station station(AutopilotDialect::kPx4);
  station.sends_poses = true;
  station.estimator_type = 6;
  station.run(10.0);
  EXPECT_EQ(station.command(400, 1), 1);
  EXPECT_EQ(station.emulator.controller().estimator().poses(), 0);
}

TEST(EmulatedPx4, ArmsInOffboardAfterOneSecondOfSetPoints) {
  Station station(AutopilotDialect::kPx4);
  station.sends_poses = true;
  station.run(5.0);
  EXPECT_EQ(station.command(176, 1, 6), 0);
  EXPECT_EQ(station.mode(), kOffboard);
  EXPECT_EQ(station.command(400, 1), 1);
  station.target = Station::position(1.0F, -2.0F, -1.6F, 0.0F);
  station.run(0.8);
  EXPECT_EQ(station.command(400, 1), 1);
  station.run(0.5);
  EXPECT_EQ(station.command(400, 1), 0);
}

// The time until the landing is COM_OF_LOSS_T; tested with the default and with other values.
TEST(EmulatedPx4, LandsAfterComOfLossT) {
  for (const double timeout_s : {0.3, 1.0, 2.0}) {
    Station station = flying_px4();
    station.set_parameter("COM_OF_LOSS_T", timeout_s);
    station.target.reset();
    station.run(timeout_s - 0.02);
    EXPECT_EQ(station.mode(), kOffboard);
    station.run(0.2);
    EXPECT_EQ(station.mode(), kPx4Land);
    station.run(12.0);
    EXPECT_FALSE(station.armed());
  }
}

TEST(EmulatedPx4, HoldsOnSetPointLossUnlessConfiguredToLand) {
  Station station = flying_px4();
  station.set_parameter("COM_OBL_RC_ACT", 0.0);
  station.target.reset();
  station.run(20.0);
  EXPECT_EQ(station.mode(), kOffboard);
  EXPECT_TRUE(station.armed());
}

TEST(EmulatedPx4, KeepsMotorsRunningWithANegativeDisarmDelay) {
  Station station = flying_px4();
  station.set_parameter("COM_DISARM_LAND", -1.0);
  EXPECT_EQ(station.command(21, 0), 0);
  station.run(30.0);
  EXPECT_TRUE(station.armed());
}

TEST(EmulatedPx4, LosesHeightWithoutPosesAndBarometer) {
  Station station = flying_px4();
  station.set_parameter("EKF2_BARO_CTRL", 0.0);
  station.sends_poses = false;
  station.run(2.0);
  EXPECT_EQ(station.flags, 0x00F);
  station.run(3.0);
  EXPECT_EQ(station.flags, 0x005);
}

TEST(EmulatedPx4, FollowsVelocitiesSmoothly) {
  Station station = flying_px4();
  const Eigen::Vector3d before_m = station.emulator.world_from_body().translation_m;
  station.target = Station::velocity(0.5F, 0.0F, 0.0F, 0.0F);
  station.run(2.0);
  const double at_two_m = station.emulator.world_from_body().translation_m.x();
  station.run(2.0);
  const double mean_mps = (station.emulator.world_from_body().translation_m.x() - at_two_m) / 2.0;
  EXPECT_GT(mean_mps, 0.43);
  EXPECT_LT(mean_mps, 0.51);
  EXPECT_NEAR(station.emulator.world_from_body().translation_m.y(), before_m.y(), 0.1);
}

TEST(EmulatedArdupilot, DoesNotArmWithoutAnOrigin) {
  Station station(AutopilotDialect::kArdupilot);
  request_messages(station);
  station.sends_poses = true;
  station.run(4.9);
  EXPECT_EQ(station.positions, 0);
  station.run(1.1);
  EXPECT_GT(station.positions, 0);
  EXPECT_EQ(station.flags, 0x33F);
  station.run(20.0);
  EXPECT_EQ(station.command(400, 1), 4);
  EXPECT_EQ(station.last_text, "Arm: AHRS: waiting for home");
  station.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(station.command(400, 1), 0);
}

TEST(EmulatedArdupilot, RefusesAnOriginBeforeItsEstimatorRuns) {
  Station station(AutopilotDialect::kArdupilot);
  station.run(3.0);
  station.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(station.origins, 0);
  station.run(1.0);
  station.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(station.origins, 1);  // the firmware reports its origin once and accepts no other
  station.send(wire::mavlink::SetGpsGlobalOrigin{});
  EXPECT_EQ(station.origins, 1);
}

TEST(EmulatedArdupilot, RefusesToArmFor22SecondsWithReason) {
  Station station = placed_ardupilot();
  station.run(5.0);
  EXPECT_EQ(station.command(400, 1), 4);
  EXPECT_EQ(station.last_text, "Arm: Accels inconsistent");
  station.run(11.0);
  EXPECT_EQ(station.command(400, 1), 4);
  EXPECT_EQ(station.last_text, "Arm: Gyros inconsistent");
  station.run(2.0);
  EXPECT_EQ(station.command(400, 1), 0);
}

TEST(EmulatedArdupilot, IgnoresPosesInOtherFrames) {
  Station station(AutopilotDialect::kArdupilot);
  station.sends_poses = true;
  station.frame = wire::mavlink::frame::kLocalNed;
  station.run(7.0);
  EXPECT_EQ(station.emulator.controller().estimator().poses(), 0);
  station.frame = wire::mavlink::frame::kLocalFrd;
  station.run(2.0);
  EXPECT_GT(station.emulator.controller().estimator().poses(), 0);
}

// The time until the stop is GUID_TIMEOUT; tested with the default and with other values.
TEST(EmulatedArdupilot, StopsAfterGuidTimeout) {
  for (const double timeout_s : {0.3, 3.0}) {
    Station station = flying_ardupilot();
    station.set_parameter("GUID_TIMEOUT", timeout_s);
    station.target = Station::velocity(0.5F, 0.0F, 0.0F, 0.0F);
    station.run(4.0);
    EXPECT_NEAR(station.emulator.velocity_world_mps().x(), 0.5, 0.03);
    station.target.reset();
    station.run(timeout_s - 0.1);
    EXPECT_NEAR(station.emulator.velocity_world_mps().x(), 0.5, 0.03);
    station.run(2.2);
    EXPECT_NEAR(station.emulator.velocity_world_mps().x(), 0.0, 0.1);
    EXPECT_EQ(station.mode(), 4U);
  }
}

// Tests FS_GCS_ENABLE, FS_GCS_TIMEOUT and SYSID_MYGCS. A station that never sent anything cannot be
// lost.
TEST(EmulatedArdupilot, LandsOnStationLossIfConfigured) {
  const auto mode_after = [](double silence_s, const std::string& name, double value) {
    Station station = flying_ardupilot();
    station.set_parameter(name, value);
    station.sends_heartbeats = true;
    station.run(2.0);
    station.sends_heartbeats = false;
    station.run(silence_s);
    return station.mode();
  };
  EXPECT_EQ(mode_after(0.7, "FS_GCS_TIMEOUT", 1.0), 4U);
  EXPECT_EQ(mode_after(1.4, "FS_GCS_TIMEOUT", 1.0), 9U);
  EXPECT_EQ(mode_after(2.7, "FS_GCS_TIMEOUT", 3.0), 4U);
  EXPECT_EQ(mode_after(3.4, "FS_GCS_TIMEOUT", 3.0), 9U);
  EXPECT_EQ(mode_after(10.0, "FS_GCS_ENABLE", 0.0), 4U);
  EXPECT_EQ(mode_after(10.0, "SYSID_MYGCS", 200.0), 4U);
  Station station = flying_ardupilot();
  station.run(10.0);
  EXPECT_EQ(station.mode(), 4U);
}

TEST(EmulatedArdupilot, FollowsTheYawRate) {
  Station station = flying_ardupilot();
  station.target = Station::velocity(0.0F, 0.0F, 0.0F, 0.5F);
  station.run(2.0);
  const double before_rad = flatten(station.emulator.world_from_body()).yaw_rad;
  station.run(2.0);
  const double after_rad = flatten(station.emulator.world_from_body()).yaw_rad;
  // The autopilot's yaw is clockwise, so a positive rate is negative in the world frame.
  EXPECT_NEAR(wrap_to_pi(after_rad - before_rad) / 2.0, -0.5, 0.01);
}

TEST(EmulatedArdupilot, LandsEightSecondsAfterTheLastPose) {
  Station station = flying_ardupilot();
  station.target = Station::position(1.0F, -2.0F, -1.6F, -0.5F);
  station.sends_poses = false;
  station.run(7.5);
  EXPECT_EQ(station.mode(), 4U);
  station.run(1.0);
  EXPECT_EQ(station.mode(), 9U);
  EXPECT_EQ(station.flags, 0x025);
}

TEST(EmulatedArdupilot, DisarmsTenSecondsAfterArmingWithoutTakeOff) {
  Station station = placed_ardupilot();
  station.run(21.0);
  EXPECT_EQ(station.command(176, 1, 4), 0);
  EXPECT_EQ(station.command(400, 1), 0);
  station.run(9.0);
  EXPECT_TRUE(station.armed());
  station.run(2.0);
  EXPECT_FALSE(station.armed());
}

TEST(EmulatedArdupilot, LandsAndDisarmsAutomatically) {
  Station station = flying_ardupilot();
  EXPECT_EQ(station.command(176, 1, 9), 0);
  station.run(3.0);
  EXPECT_TRUE(station.armed());
  station.run(4.0);
  EXPECT_FALSE(station.armed());
  EXPECT_NEAR(station.height_m(), 0.0, 1e-9);
}

TEST(EmulatedAutopilot, RefusesToStopItsMotorsInTheAirUnlessForced) {
  for (Station station : {flying_px4(), flying_ardupilot()}) {
    EXPECT_NE(station.command(400, 0), 0);
    EXPECT_TRUE(station.armed());
    EXPECT_EQ(station.command(400, 0, 21196.0F), 0);
    EXPECT_FALSE(station.armed());
    station.run(1.0);
    EXPECT_NEAR(station.height_m(), 0.0, 1e-9);
  }
}

TEST(EmulatedAutopilot, ReportsBatteryLikeTheRealOne) {
  Station station(AutopilotDialect::kPx4);
  station.command(511, 147.0F, 50'000.0F);
  station.run(0.2);
  ASSERT_TRUE(station.last_battery);
  EXPECT_EQ(station.last_battery->voltages[0], 12'600) << "full battery, motors off";
  EXPECT_EQ(station.last_battery->voltages[1], 0xFFFF) << "single cells are not reported";
  EXPECT_EQ(station.last_battery->current_battery, 0);
  EXPECT_EQ(station.last_battery->temperature, 2'500) << "25 degrees Celsius";
  EXPECT_EQ(station.last_battery->charge_state, 1);
}

TEST(EmulatedAutopilot, IsDeterministic) {
  const auto fly = [] {
    Station station = flying_px4();
    station.target = Station::velocity(0.3F, -0.2F, 0.1F, 0.4F);
    station.run(3.0);
    return station.emulator.world_from_body().translation_m;
  };
  EXPECT_EQ(fly(), fly());
}

}  // namespace
}  // namespace vantage::sim
