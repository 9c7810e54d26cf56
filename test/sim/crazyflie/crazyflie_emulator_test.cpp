// The emulated Crazyflie has the properties that were measured with firmware 2026.08. Times are
// those of the firmware's log.

#include "sim/crazyflie/crazyflie_emulator.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "wire/crtp/system.hpp"

namespace vantage::sim {
namespace {

namespace crtp = wire::crtp;
namespace info = wire::crtp::info;

class CrazyflieEmulatorTest : public ::testing::Test {
 protected:
  CrazyflieEmulatorTest() { restart({}); }

  void restart(const CrazyflieEmulatorSpec& spec) {
    vehicle.emplace(spec, now);
    start_spec = spec;
  }
  void send(const std::optional<crtp::Packet>& packet) {
    vehicle->receive(crtp::encode(packet.value()).bytes(), now);
  }
  /// Runs with poses at 100 Hz while `has_pose`, and with set-points at 50 Hz while `setpoint`.
  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end) {
      step();
    }
  }
  void step() {
    now += Duration{10'000};
    ++ticks;
    vehicle->advance_to(now);
    for (const auto& bytes : vehicle->take_output()) {
      replies.push_back(*crtp::decode(bytes));
    }
    if (has_pose) {
      send(crtp::encode(crtp::ExternalPose{vehicle->world_from_body().translation_m + pose_error_m,
                                           vehicle->world_from_body().rotation}));
    }
    if (setpoint && ticks % 2 == 0) {
      send(crtp::encode(*setpoint));
    }
    lowest_m = std::min(lowest_m, height_m());
    highest_m = std::max(highest_m, height_m());
  }
  /// Returns the time until the bits are set (or cleared), s; at most `limit_s`.
  double until(std::uint16_t bits, bool are_set, double limit_s) {
    const Time begin = now;
    while (has(bits) != are_set && to_seconds(now - begin) < limit_s) {
      step();
    }
    return to_seconds(now - begin);
  }
  double until_motors_stop(double limit_s) {
    const Time begin = now;
    while (vehicle->are_motors_running() && to_seconds(now - begin) < limit_s) {
      step();
    }
    return to_seconds(now - begin);
  }
  void set_parameter(std::uint16_t id, double value) {
    send(crtp::parameter_write(id, crtp::ValueType::kU8, value));
  }
  /// Flies to 1 m on the set-point stream and hovers there.
  void hover(bool uses_mellinger = true) {
    set_parameter(1, uses_mellinger ? 2.0 : 1.0);
    run(1.0);
    setpoint.emplace();
    setpoint->position_world_m = {0.0, 0.0, 1.0};
    run(5.0);
    ASSERT_NEAR(height_m(), 1.0, 0.03);
    lowest_m = highest_m = height_m();
  }
  [[nodiscard]] bool has(std::uint16_t bits) const { return (vehicle->info() & bits) == bits; }
  [[nodiscard]] double height_m() const { return vehicle->world_from_body().translation_m.z(); }
  std::optional<std::uint8_t> command(const std::optional<crtp::Packet>& packet) {
    replies.clear();
    send(packet);
    step();
    for (const crtp::Packet& reply : replies) {
      if (const auto answer = crtp::decode_high_level_reply(reply)) {
        return answer->error;
      }
    }
    return std::nullopt;
  }

  Time now = from_utime(1'700'000'000'000'000);
  CrazyflieEmulatorSpec start_spec;
  std::optional<CrazyflieEmulator> vehicle;
  bool has_pose = true;
  Eigen::Vector3d pose_error_m = Eigen::Vector3d::Zero();
  std::optional<crtp::FullStateSetpoint> setpoint;
  std::vector<crtp::Packet> replies;
  int ticks = 0;
  double lowest_m = 0.0;
  double highest_m = 0.0;
};

TEST_F(CrazyflieEmulatorTest, StartsArmedOrDisarmedAsConfigured) {
  run(0.1);
  EXPECT_EQ(vehicle->info(), 0x20E);
  CrazyflieEmulatorSpec spec;
  spec.arms_itself = false;
  restart(spec);
  run(0.1);
  EXPECT_EQ(vehicle->info(), 0x201);
  EXPECT_EQ(command(crtp::encode(crtp::HighLevelHeight{false, 1.0, {}, 2.0})),
            crtp::kHighLevelBusy);
  send(crtp::arm_request(true));
  EXPECT_LE(until(info::kArmed | info::kCanFly, true, 1.0), 0.06);
  EXPECT_NEAR(until(info::kArmed, false, 40.0), 30.05, 0.1);
}

// Without set-points the vehicle keeps its height until the motors lock after 2 s.
TEST_F(CrazyflieEmulatorTest, LevelsAndThenLocksWithoutSetpoints) {
  hover();
  setpoint->velocity_world_mps.x() = 0.0;
  setpoint.reset();
  run(1.9);
  EXPECT_GT(lowest_m, 0.9) << "it levels and keeps its height";
  EXPECT_FALSE(has(info::kLocked));
  EXPECT_TRUE(has(info::kFlying)) << "the levelling is not visible";
  EXPECT_NEAR(until(info::kLocked, true, 1.0), 0.1, 0.06);
  run(1.5);
  EXPECT_LT(height_m(), 0.02) << "it falls";
  EXPECT_EQ(command(crtp::encode(crtp::HighLevelHeight{false, 1.0, {}, 2.0})),
            crtp::kHighLevelBusy);
  replies.clear();
  send(crtp::arm_request(true));
  step();
  EXPECT_TRUE(std::ranges::find(replies, crtp::supervisor_reply(crtp::SupervisorCommand::kArm,
                                                                false, false)) != replies.end());
}

TEST_F(CrazyflieEmulatorTest, OneSetpointEndsAHighLevelFlight) {
  run(1.0);
  EXPECT_EQ(command(crtp::encode(crtp::HighLevelHeight{false, 1.0, {}, 2.0})), crtp::kHighLevelOk);
  run(8.0);
  EXPECT_NEAR(height_m(), 1.0, 0.05);
  send(crtp::encode(crtp::PositionSetpoint{{0.0, 0.0, 1.0}, 0.0}));
  EXPECT_NEAR(until(info::kLocked, true, 4.0), 2.0, 0.1);
}

// The firmware reports nothing when poses stop, and the vehicle drifts.
TEST_F(CrazyflieEmulatorTest, DoesNotReportALostPose) {
  hover();
  const std::uint16_t before = vehicle->info();
  has_pose = false;
  run(5.0);
  EXPECT_EQ(vehicle->info(), before);
  const Eigen::Vector3d off_m(vehicle->world_from_body().translation_m.x(),
                              vehicle->world_from_body().translation_m.y(), 0.0);
  EXPECT_NEAR(off_m.norm(), 0.49, 0.1) << "the measured drift";
}

// A packet of a wrong length or kind ends the firmware.
TEST_F(CrazyflieEmulatorTest, StopsForeverAfterAMalformedPacket) {
  const auto killed_by = [this](std::uint8_t channel, std::vector<std::uint8_t> bytes,
                                crtp::Port port = crtp::Port::kSetpoint) {
    restart({});
    crtp::Packet packet;
    packet.port = port;
    packet.channel = channel;
    packet.size = static_cast<std::uint8_t>(bytes.size());
    std::ranges::copy(bytes, packet.data.begin());
    send(packet);
    run(0.1);
    return vehicle->has_crashed_firmware();
  };
  const auto of_size = [](std::uint8_t kind, std::size_t size) {
    std::vector<std::uint8_t> out(size, 0);
    out[0] = kind;
    return out;
  };
  EXPECT_TRUE(killed_by(0, of_size(8, 12))) << "velocity";
  EXPECT_TRUE(killed_by(0, of_size(6, 10))) << "full state";
  EXPECT_TRUE(killed_by(0, of_size(10, 15))) << "hover";
  EXPECT_TRUE(killed_by(0, {})) << "empty";
  EXPECT_TRUE(killed_by(1, {0})) << "set-points end";
  EXPECT_FALSE(killed_by(0, of_size(99, 9))) << "unknown kind";
  EXPECT_FALSE(killed_by(0, of_size(7, 5))) << "short position";
  EXPECT_FALSE(killed_by(1, of_size(8, 11), crtp::Port::kLocalisation)) << "short pose";
  EXPECT_FALSE(killed_by(1, of_size(8, 29), crtp::Port::kLocalisation)) << "zero quaternion";
  std::vector<std::uint8_t> pose = of_size(8, 29);
  for (std::size_t i = 13; i < 17; ++i) {
    pose[i] = 0xFF;  // NaN as x of the quaternion
  }
  EXPECT_TRUE(killed_by(1, pose, crtp::Port::kLocalisation)) << "NaN";
}

TEST_F(CrazyflieEmulatorTest, FallsAfterASetpointWithNan) {
  hover();
  std::vector<std::uint8_t> bytes(30, 0);
  bytes[0] = 0x6D;
  bytes[1] = 8;
  for (std::size_t i = 2; i < 6; ++i) {
    bytes[i] = 0xFF;
  }
  bytes[28] = 0x80;
  bytes[29] = 0x3F;
  vehicle->receive(bytes, now);
  run(1.0);
  EXPECT_FALSE(vehicle->has_crashed_firmware());
  EXPECT_TRUE(has(info::kFlying));
  EXPECT_LT(height_m(), 0.05) << "valid poses do not repair the estimate";
}

// The message "set-points end" without a landing command stops the motors.
TEST_F(CrazyflieEmulatorTest, StopsTheMotorsOnSetpointsEndWithoutALanding) {
  hover();
  setpoint.reset();
  send(crtp::encode(crtp::SetpointsEnd{}));
  EXPECT_LE(until_motors_stop(1.0), 0.02);
  run(1.0);
  EXPECT_LT(height_m(), 0.02);
}

TEST_F(CrazyflieEmulatorTest, LandsAfterLandCommandAndSetpointsEnd) {
  hover();
  setpoint.reset();
  EXPECT_EQ(command(crtp::encode(crtp::HighLevelHeight{true, 0.0, {}, 2.0})), crtp::kHighLevelOk);
  EXPECT_EQ(command(crtp::encode(crtp::HighLevelHeight{true, 0.0, {}, 2.0})),
            crtp::kHighLevelRefused);
  send(crtp::encode(crtp::SetpointsEnd{}));
  step();
  EXPECT_TRUE(vehicle->are_motors_running());
  EXPECT_TRUE(has(info::kHighLevelActive));
  EXPECT_NEAR(until_motors_stop(4.0), 2.0, 0.06);
  EXPECT_LT(height_m(), 0.05);
  EXPECT_NEAR(until(info::kFlying, false, 4.0), 2.0, 0.06);
  EXPECT_FALSE(has(info::kLocked));
}

TEST_F(CrazyflieEmulatorTest, IgnoresALandingWithoutSetpointsEnd) {
  hover();
  setpoint.reset();
  EXPECT_EQ(command(crtp::encode(crtp::HighLevelHeight{true, 0.0, {}, 2.0})), crtp::kHighLevelOk);
  run(1.5);
  EXPECT_GT(height_m(), 0.9);
  EXPECT_NEAR(until(info::kLocked, true, 2.0), 0.5, 0.1);
}

// Only the Mellinger controller uses the velocities of set-points.
TEST_F(CrazyflieEmulatorTest, OnlyMellingerControllerUsesVelocities) {
  for (const bool uses_mellinger : {false, true}) {
    restart({});
    setpoint.reset();
    hover(uses_mellinger);
    double square_m2 = 0.0;
    int count = 0;
    for (double t = 0.0; t < 12.0; t += 0.01) {  // circle of radius 0.5 m at 1 rad/s
      setpoint->position_world_m = {0.5 * std::sin(t), 0.5 - 0.5 * std::cos(t), 1.0};
      setpoint->velocity_world_mps = {0.5 * std::cos(t), 0.5 * std::sin(t), 0.0};
      setpoint->acceleration_world_mps2 = {-0.5 * std::sin(t), 0.5 * std::cos(t), 0.0};
      step();
      if (t > 3.0) {
        square_m2 +=
            (vehicle->world_from_body().translation_m - setpoint->position_world_m).squaredNorm();
        ++count;
      }
    }
    const double rms_m = std::sqrt(square_m2 / count);
    if (uses_mellinger) {
      EXPECT_LT(rms_m, 0.08) << "measured: 0.052";
    } else {
      EXPECT_NEAR(rms_m, 0.28, 0.1);
    }
  }
}

// The firmware trusts every pose, so a jump of the poses moves the vehicle.
TEST_F(CrazyflieEmulatorTest, FollowsAJumpOfThePose) {
  hover();
  pose_error_m.x() = 0.3;
  run(3.0);
  EXPECT_NEAR(vehicle->world_from_body().translation_m.x(), -0.3, 0.05);
}

// The firmware takes off even if it has never received a pose.
TEST_F(CrazyflieEmulatorTest, ClimbsWithoutAPose) {
  has_pose = false;
  run(1.0);
  EXPECT_TRUE(has(info::kCanFly));
  EXPECT_EQ(command(crtp::encode(crtp::HighLevelHeight{false, 1.0, {}, 2.0})), crtp::kHighLevelOk);
  run(4.0);
  EXPECT_GT(height_m(), 10.0);
}

// A set-point from before arming starts the motors and then locks them.
TEST_F(CrazyflieEmulatorTest, LocksWhenArmedWithAnOldSetpoint) {
  CrazyflieEmulatorSpec spec;
  spec.arms_itself = false;
  restart(spec);
  run(1.0);
  send(crtp::encode(crtp::PositionSetpoint{{0.0, 0.0, 0.5}, 0.0}));
  run(2.5);
  send(crtp::arm_request(true));
  bool have_run = false;
  for (int i = 0; i < 20; ++i) {
    step();
    have_run = have_run || vehicle->are_motors_running();
  }
  EXPECT_TRUE(have_run);
  EXPECT_TRUE(has(info::kLocked));
}

TEST_F(CrazyflieEmulatorTest, EmergencyStopLocksTheMotors) {
  hover();
  send(crtp::supervisor_request(crtp::SupervisorCommand::kEmergencyStop));
  EXPECT_LE(until_motors_stop(1.0), 0.02);
  EXPECT_LE(until(info::kLocked, true, 1.0), 0.05);
}

TEST_F(CrazyflieEmulatorTest, StopWatchdogActsAfterASecond) {
  hover();
  send(crtp::supervisor_request(crtp::SupervisorCommand::kStopWatchdog));
  EXPECT_NEAR(until_motors_stop(3.0), 1.02, 0.03);
  EXPECT_LE(until(info::kLocked, true, 1.0), 0.06);
}

TEST_F(CrazyflieEmulatorTest, CanBeArmedAgainAfterADisarmInFlight) {
  CrazyflieEmulatorSpec spec;
  spec.arms_itself = false;
  restart(spec);
  run(0.5);
  send(crtp::arm_request(true));
  hover();
  send(crtp::arm_request(false));
  EXPECT_LE(until_motors_stop(1.0), 0.02);
  send(crtp::arm_request(true));
  run(0.2);
  EXPECT_TRUE(has(info::kArmed));
}

TEST_F(CrazyflieEmulatorTest, UsesItsOwnPoseFromAPackedMessage) {
  has_pose = false;
  const crtp::ExternalPose pose{{0.0, 0.0, 0.0}, Quaternion::Identity()};
  const std::vector<crtp::PackedPose> poses{{0x01, pose}, {0xE7, pose}};
  send(crtp::encode(std::span<const crtp::PackedPose>(poses)));
  EXPECT_EQ(vehicle->poses(), 1);
}

TEST_F(CrazyflieEmulatorTest, LogsAtTheRequestedRate) {
  const std::vector<crtp::LogVariable> variables{{2, crtp::ValueType::kF32}};
  send(crtp::log_create(7, variables));
  send(crtp::log_create(7, variables));
  send(crtp::log_start(7, 20));
  run(0.01);
  ASSERT_GE(replies.size(), 3U);
  EXPECT_EQ(crtp::decode_log_reply(replies[0])->error, crtp::kLogOk);
  EXPECT_EQ(crtp::decode_log_reply(replies[1])->error, crtp::kLogExists);
  replies.clear();
  run(1.0);
  EXPECT_NEAR(static_cast<double>(replies.size()), 50.0, 1.0);
  ASSERT_TRUE(crtp::decode_log_data(replies[0]));
  EXPECT_EQ(crtp::decode_log_data(replies[0])->block, 7);
}

}  // namespace
}  // namespace vantage::sim
