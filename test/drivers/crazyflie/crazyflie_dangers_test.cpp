// Tests dangerous reactions of the firmware, which the emulated vehicle reproduces. The driver must
// not cause any of them.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "test/drivers/crazyflie/crazyflie_bench.hpp"

namespace vantage::test {
namespace {

namespace crtp = wire::crtp;
using models::FlightState;
using models::OperatorAction;

class CrazyflieDangers : public ::testing::Test {
 protected:
  /// Returns the longest time between two set-points in `seconds`.
  double longest_gap_s(double seconds) {
    const Time end = bench.now + from_seconds(seconds);
    Time last = bench.now;
    Duration longest{};
    while (bench.now < end) {
      const std::int64_t before = bench.vehicle->setpoints();
      bench.run(0.005);
      if (bench.vehicle->setpoints() != before) {
        longest = std::max(longest, bench.now - last);
        last = bench.now;
      }
    }
    return to_seconds(std::max(longest, bench.now - last));
  }

  CrazyflieBench bench;
};

// 1. If set-points stop, the firmware locks the motors after 2 s.
TEST_F(CrazyflieDangers, SetpointsNeverStopInFlight) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  EXPECT_LT(longest_gap_s(10.0), 0.05) << "while the vehicle holds";
  bench.has_mocap = false;
  EXPECT_LT(longest_gap_s(0.3), 0.05) << "without poses";
}

TEST_F(CrazyflieDangers, RestartedDriverLandsTheVehicle) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.has_driver = false;  // killed
  bench.run(1.0);
  bench.restart_driver();
  bench.has_driver = true;
  ASSERT_TRUE(bench.run_until([this] { return !bench.is_flying(); }, 12.0)) << bench.reasons();
  EXPECT_LT(bench.height_m(), 0.02);
  EXPECT_LT(bench.descent_max_mps, 0.8) << "the vehicle did not fall";
  EXPECT_TRUE(bench.is_sound());
}

// 2. The firmware does not report that it receives no poses.
TEST_F(CrazyflieDangers, DetectsThatPosesDoNotArrive) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.loses_sent = [](const crtp::Packet& packet) {
    return packet.port == crtp::Port::kLocalisation;
  };
  ASSERT_TRUE(bench.run_until([this] { return bench.state() == FlightState::kLand; }, 4.0))
      << bench.reasons();
  ASSERT_TRUE(bench.run_until([this] { return !bench.is_flying(); }, 15.0));
  EXPECT_TRUE(bench.is_sound());
}

TEST_F(CrazyflieDangers, LandsWithoutMocap) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.has_mocap = false;
  ASSERT_TRUE(bench.run_until([this] { return bench.state() == FlightState::kLand; }, 2.0))
      << bench.reasons();
  ASSERT_TRUE(bench.run_until([this] { return !bench.is_flying(); }, 15.0)) << bench.reasons();
  EXPECT_LT(bench.height_m(), 0.02);
  EXPECT_LT(bench.descent_max_mps, 0.9) << "the vehicle did not fall";
  EXPECT_TRUE(bench.is_sound());
}

// 3. A NaN or a packet of wrong length crashes the firmware.
TEST_F(CrazyflieDangers, NeverSendsNonFiniteNumbersOrWrongLengths) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  int count = 0;
  bench.alter_frame = [&count](models::MocapFrame& frame) {
    Pose3& pose = frame.bodies[0].world_from_body;
    switch (++count % 5) {
      case 1:
        pose.translation_m.z() = kNan;
        break;
      case 2:
        pose.rotation.coeffs().setConstant(kNan);
        break;
      case 3:
        pose.rotation.coeffs().setZero();
        break;
      case 4:
        pose.translation_m.x() = 1e30;
        break;
      default:
        break;
    }
  };
  bench.run(2.0);
  EXPECT_FALSE(bench.vehicle->has_crashed_firmware());
  for (const crtp::Packet& packet : bench.sent) {
    const auto message = crtp::decode_flight(packet);
    const bool is_flight = packet.port == crtp::Port::kSetpoint ||
                           packet.port == crtp::Port::kHighLevel ||
                           (packet.port == crtp::Port::kLocalisation && packet.size > 1);
    EXPECT_TRUE(message.has_value() || !is_flight);
    if (message) {
      if (const auto* pose = std::get_if<crtp::ExternalPose>(&*message)) {
        EXPECT_TRUE(pose->position_world_m.allFinite());
        EXPECT_TRUE(pose->world_from_body.coeffs().allFinite());
      }
    }
  }
}

// 4. The firmware stops the motors if it receives "set-points end" without a command to land. It
// ignores a command to land without "set-points end".
TEST_F(CrazyflieDangers, HandsTheLandingToTheFirmwareWithoutAFall) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.sent.clear();
  bench.command(OperatorAction::kLand);
  ASSERT_TRUE(bench.run_until([this] { return bench.state() == FlightState::kIdle; }, 25.0));
  bool has_landing = false;
  for (const crtp::Packet& packet : bench.sent) {
    has_landing = has_landing || packet.port == crtp::Port::kHighLevel;
    const bool is_end = packet.is(crtp::Port::kSetpoint, 1);
    EXPECT_TRUE(!is_end || has_landing) << "set-points end only after the command to land";
    const bool is_setpoint = packet.is(crtp::Port::kSetpoint, 0);
    EXPECT_FALSE(is_setpoint && has_landing) << "a set-point would erase the landing";
  }
  EXPECT_TRUE(has_landing);
  EXPECT_LT(bench.descent_max_mps, 0.8);
}

TEST_F(CrazyflieDangers, HandsTheLandingToTheFirmwareOnALossyLink) {
  for (const unsigned pattern : {2U, 3U, 5U}) {
    CrazyflieBench lossy;
    ASSERT_TRUE(lossy.take_off()) << lossy.reasons();
    unsigned count = 0;
    lossy.loses_sent = [&count, pattern](const crtp::Packet&) { return ++count % pattern != 0; };
    lossy.command(OperatorAction::kLand);
    ASSERT_TRUE(lossy.run_until([&] { return !lossy.is_flying(); }, 25.0)) << lossy.reasons();
    EXPECT_LT(lossy.height_m(), 0.02);
    EXPECT_LT(lossy.descent_max_mps, 1.0) << "one of " << pattern << " packets arrives";
    EXPECT_TRUE(lossy.is_sound());
  }
}

// 5. The default controller of the firmware ignores the velocities in set-points.
TEST_F(CrazyflieDangers, FollowsWithoutLag) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(1.0);
  ASSERT_TRUE(bench.follow_straight(0.6, 3.0)) << bench.reasons();
  bench.run(1.0);
  const auto setpoint = bench.vehicle->setpoint_m();
  ASSERT_TRUE(setpoint);
  const Eigen::Vector3d off_m = *setpoint - bench.vehicle->world_from_body().translation_m;
  EXPECT_LT(off_m.norm(), 0.08);
}

// 6. The firmware uses every pose immediately, even after a jump.
TEST_F(CrazyflieDangers, DoesNotFollowAJumpOfThePose) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(1.0);
  const Eigen::Vector3d here_m = bench.vehicle->world_from_body().translation_m;
  for (const double jump_m : {0.3, 1.0, 3.0}) {
    int frames = 0;
    bench.alter_frame = [&frames, jump_m](models::MocapFrame& frame) {
      if (++frames < 4) {
        frame.bodies[0].world_from_body.translation_m.y() += jump_m;
      }
    };
    double farthest_m = 0.0;
    for (int i = 0; i < 60; ++i) {
      bench.run(0.02);
      farthest_m =
          std::max(farthest_m, (bench.vehicle->world_from_body().translation_m - here_m).norm());
    }
    EXPECT_LT(farthest_m, 0.1) << jump_m;
    bench.run(2.0);
  }
}

// 7. The firmware takes off even if it has never received a pose.
TEST_F(CrazyflieDangers, RefusesToArmWhenPosesDoNotReachTheVehicle) {
  bench.loses_sent = [](const crtp::Packet& packet) {
    return packet.port == crtp::Port::kLocalisation;
  };
  bench.run(5.0);
  EXPECT_FALSE(bench.reasons().empty());
  bench.command(OperatorAction::kArm);
  bench.command(OperatorAction::kTakeOff);
  bench.run(5.0);
  EXPECT_EQ(bench.state(), FlightState::kIdle);
  EXPECT_FALSE(bench.vehicle->are_motors_running());
  EXPECT_EQ(bench.vehicle->setpoints(), 0);
}

TEST_F(CrazyflieDangers, RefusesToArmWhenTheEstimateDiffersFromMocap) {
  ASSERT_TRUE(bench.ready()) << bench.reasons();
  bench.loses_sent = [](const crtp::Packet& packet) {
    return packet.port == crtp::Port::kLocalisation;
  };
  bench.alter_frame = [](models::MocapFrame& frame) {
    frame.bodies[0].world_from_body.translation_m.x() += 0.4;
  };
  bench.run(0.9);
  bench.command(OperatorAction::kArm);
  bench.run(0.3);
  EXPECT_FALSE(bench.driver->inputs().autopilot_armed) << bench.reasons();
}

// 8. If a set-point was sent before arming, the firmware starts the motors at arming and then locks
// them.
TEST_F(CrazyflieDangers, ClearsAnOldSetpointBeforeArming) {
  for (const bool arms_itself : {true, false}) {
    CrazyflieBench other(arms_itself);
    ASSERT_TRUE(other.ready()) << other.reasons();
    if (!arms_itself) {
      const crtp::Encoded old =
          crtp::encode(*crtp::encode(crtp::PositionSetpoint{{2.0, 2.0, 1.0}, 0.0}));
      other.vehicle->receive(old.bytes(), other.now);
      other.run(3.0);
    }
    ASSERT_TRUE(other.arm()) << other.reasons();
    other.run(1.0);
    EXPECT_TRUE(other.is_sound());
    other.command(OperatorAction::kTakeOff);
    EXPECT_TRUE(other.hovers()) << other.reasons();
  }
}

TEST_F(CrazyflieDangers, SendsNoSetpointOnTheGround) {
  ASSERT_TRUE(bench.ready()) << bench.reasons();
  ASSERT_TRUE(bench.arm()) << bench.reasons();
  bench.run(5.0);
  EXPECT_EQ(bench.vehicle->setpoints(), 0);
}

}  // namespace
}  // namespace vantage::test
