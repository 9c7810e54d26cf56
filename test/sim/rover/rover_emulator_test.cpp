// Tests of the emulated rover: its delays, its unmeasured motion and its telemetry.

#include "sim/rover/rover_emulator.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "sim/rover/rover_endpoint.hpp"
#include "test/support/udp_port.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::sim {
namespace {

namespace wire = vantage::wire::rover;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// Rover 7, and a driver with session id 11 that sends every 20 ms.
struct Bench {
  explicit Bench(const RoverEmulatorSpec& spec = exact()) : rover(spec, kStart) {}
  static RoverEmulatorSpec exact() {
    RoverEmulatorSpec out;
    out.number = 7;
    out.boot = 99;
    out.delay_s = 0.0;
    out.grip = 1.0;
    out.drift_radps = 0.0;
    return out;
  }
  void transmit(wire::Command command) {
    command.time_us = to_utime(now) - 5;
    rover.receive(wire::encode(command), now);
  }
  wire::Command drive(float speed_mps, float yaw_rate_radps = 0.0F) {
    return {7, 11, ++sequence, 0, speed_mps, yaw_rate_radps, wire::kDrive};
  }
  void drive_for(double seconds, float speed_mps, float yaw_rate_radps = 0.0F) {
    for (const Time end = now + from_seconds(seconds); now < end; now += Duration{20'000}) {
      transmit(drive(speed_mps, yaw_rate_radps));
      rover.advance_to(now + Duration{20'000});
    }
  }
  wire::Telemetry read_telemetry() {
    wire::Telemetry out;
    now += Duration{50'000};
    rover.advance_to(now);
    const auto bytes = rover.take_output();
    EXPECT_TRUE(bytes);
    if (bytes) {
      EXPECT_EQ(wire::decode(*bytes, out), wire::Verdict::kAccepted);
    }
    return out;
  }
  RoverEmulator rover;
  Time now = kStart;
  std::uint32_t sequence = 0;
};

TEST(RoverEmulator, ExecutesCommandsAfterDelay) {
  RoverEmulatorSpec spec = Bench::exact();
  spec.delay_s = 0.1;
  Bench bench(spec);
  bench.transmit(bench.drive(0.5F));
  bench.now += Duration{50'000};
  bench.rover.advance_to(bench.now);
  bench.transmit(bench.drive(0.2F, 1.0F));
  bench.rover.advance_to(kStart + Duration{95'000});
  EXPECT_EQ(bench.rover.state().speed_mps, 0.0);
  bench.rover.advance_to(kStart + Duration{145'000});
  EXPECT_NEAR(bench.rover.state().speed_mps, 0.05, 1e-9);
  EXPECT_EQ(bench.rover.state().yaw_rate_radps, 0.0);
  bench.rover.advance_to(kStart + Duration{170'000});
  EXPECT_NEAR(bench.rover.state().yaw_rate_radps, 5 * 0.005 * 8.0, 1e-9)
      << "the second command, at its own time";
}

// Each command takes effect at its own time, for any step length of the emulator.
TEST(RoverEmulator, IsIndependentOfTheStepLength) {
  RoverEmulatorSpec spec = Bench::exact();
  spec.delay_s = 0.03;
  Bench often(spec);
  Bench seldom(spec);
  for (int k = 0; k < 20; ++k) {
    for (Bench* bench : {&often, &seldom}) {
      bench->now = kStart + k * Duration{100'000};
      bench->transmit(bench->drive(k % 3 == 0 ? 0.8F : 0.2F, k % 2 == 0 ? 1.0F : -0.5F));
    }
    for (int i = 0; i < 100; ++i) {
      often.now += Duration{1'000};
      if (i % 5 == 4) {
        often.rover.advance_to(often.now);
      }
    }
  }
  seldom.rover.advance_to(often.now);
  const RoverState& a = often.rover.state();
  const RoverState& b = seldom.rover.state();
  EXPECT_LT((a.world_from_body.position_m() - b.world_from_body.position_m()).norm(), 1e-12);
  EXPECT_NEAR(a.world_from_body.yaw_rad, b.world_from_body.yaw_rad, 1e-12);
  EXPECT_GT(a.world_from_body.position_m().norm(), 0.3);
}

// Slip and drift affect the true motion but not the measured one, at any heading. Drift acts only
// during motion.
TEST(RoverEmulator, SlipAndDriftAreUnmeasured) {
  for (const double yaw_rad : {0.3, 2.0, -2.5}) {
    RoverEmulatorSpec spec = Bench::exact();
    spec.start = {1.0, -2.0, yaw_rad};
    Bench straight(spec);
    spec.grip = 0.8;
    Bench slipping(spec);
    spec.grip = 1.0;
    spec.drift_radps = 0.25;
    Bench drifting(spec);
    for (Bench* bench : {&straight, &slipping, &drifting}) {
      bench->rover.advance_to(kStart + Duration{100'000});
      bench->now = kStart + Duration{100'000};
      EXPECT_EQ(bench->rover.state().world_from_body, (Pose2{1.0, -2.0, yaw_rad}));
      bench->drive_for(1.0, 0.5F);
      EXPECT_NEAR(bench->rover.state().speed_mps, 0.5, 1e-6);
    }
    const Eigen::Vector2d from_m(1.0, -2.0);
    const Eigen::Vector2d offset_m = straight.rover.state().world_from_body.position_m() - from_m;
    EXPECT_NEAR(offset_m.norm(), 0.5 * 0.5 * 0.5 + 0.5 * 0.5, 1e-6);
    EXPECT_NEAR(std::atan2(offset_m.y(), offset_m.x()), yaw_rad, 1e-9);
    EXPECT_LT(
        (slipping.rover.state().world_from_body.position_m() - from_m - 0.8 * offset_m).norm(),
        1e-9);
    const double turned_rad = drifting.rover.state().world_from_body.yaw_rad - yaw_rad;
    EXPECT_NEAR(wrap_to_pi(turned_rad), 0.25, 1e-9) << "to the left";
    EXPECT_EQ(drifting.rover.state().yaw_rate_radps, 0.0);
  }
}

TEST(RoverEmulator, SendsTelemetryEvery50Ms) {
  Bench bench;
  ASSERT_TRUE(bench.rover.take_output()) << "sent immediately";
  EXPECT_FALSE(bench.rover.take_output());
  wire::Telemetry telemetry = bench.read_telemetry();
  EXPECT_EQ(telemetry.robot, 7U);
  EXPECT_EQ(telemetry.boot, 99U);
  EXPECT_EQ(telemetry.sequence, 1U);
  EXPECT_EQ(telemetry.session, 0U);
  EXPECT_EQ(telemetry.command_sequence, 0U);
  EXPECT_EQ(telemetry.command_time_us, 0);
  EXPECT_EQ(telemetry.speed_mps, 0.0F);
  EXPECT_EQ(telemetry.flags, wire::kWatchdogOut);
  EXPECT_EQ(telemetry.refused, 0U);
  bench.drive_for(1.0, 0.5F, -1.0F);
  const std::int64_t said_us = to_utime(bench.now) - 20'000 - 5;
  telemetry = bench.read_telemetry();
  EXPECT_EQ(telemetry.sequence, 2U) << "number of sent messages";
  EXPECT_EQ(telemetry.session, 11U);
  EXPECT_EQ(telemetry.command_sequence, bench.sequence);
  EXPECT_EQ(telemetry.command_time_us, said_us);
  EXPECT_FLOAT_EQ(telemetry.speed_mps, 0.5F);
  EXPECT_FLOAT_EQ(telemetry.yaw_rate_radps, -1.0F);
  EXPECT_EQ(telemetry.flags, wire::kDriving);
  // 1.1 s of the battery's endurance of two hours have passed.
  EXPECT_NEAR(telemetry.battery_share, 0.9 - 1.1 / 7200.0, 1e-6);
  bench.rover.advance_to(bench.now + Duration{49'999});
  EXPECT_FALSE(bench.rover.take_output());
  bench.rover.advance_to(bench.now + Duration{50'000});
  EXPECT_TRUE(bench.rover.take_output());
}

TEST(RoverEmulator, ReportsWhyItDoesNotDrive) {
  Bench bench;
  bench.rover.take_output();
  bench.drive_for(0.5, 0.5F);
  EXPECT_EQ(bench.read_telemetry().flags, wire::kDriving);
  bench.rover.press_stop();
  EXPECT_EQ(bench.read_telemetry().flags, wire::kStopLatched);
  bench.now += Duration{200'000};
  EXPECT_EQ(bench.read_telemetry().flags, wire::kStopLatched | wire::kWatchdogOut);
  wire::Command release = bench.drive(0.5F);
  release.flags = wire::kReleaseStop;
  bench.transmit(release);
  EXPECT_EQ(bench.read_telemetry().flags, 0U) << "commands are received but do not request driving";
  bench.drive_for(0.5, 0.5F);
  EXPECT_NEAR(bench.rover.state().speed_mps, 0.5, 1e-6);
  bench.rover.fail_motor();
  bench.drive_for(0.5, 0.5F);
  EXPECT_EQ(bench.rover.state().speed_mps, 0.0);
  EXPECT_EQ(bench.read_telemetry().flags, wire::kDriving | wire::kMotorFailed);
}

// A command with the stop flag is a stop, even if it also requests driving or the end of the stop.
TEST(RoverEmulator, StopOverridesOtherFlags) {
  for (const std::uint32_t flags :
       {wire::kEmergencyStop | wire::kDrive, wire::kEmergencyStop | wire::kReleaseStop,
        wire::kEmergencyStop}) {
    Bench bench;
    bench.rover.take_output();
    bench.drive_for(0.5, 0.5F);
    wire::Command both = bench.drive(0.5F);
    both.flags = flags;
    bench.transmit(both);
    EXPECT_TRUE(bench.rover.is_stopped());
    EXPECT_EQ(bench.read_telemetry().flags, wire::kStopLatched);
    bench.rover.advance_to(bench.now + Duration{300'000});
    EXPECT_EQ(bench.rover.state().speed_mps, 0.0);
  }
}

// Commands that are still delayed when the stop begins are dropped. They must not be executed after
// the stop.
TEST(RoverEmulator, DropsDelayedCommandsOnStop) {
  RoverEmulatorSpec spec = Bench::exact();
  spec.delay_s = 0.3;
  Bench bench(spec);
  for (int i = 0; i < 15; ++i) {  // lasts as long as the delay
    bench.transmit(bench.drive(0.5F));
    bench.now += Duration{20'000};
    bench.rover.advance_to(bench.now);
  }
  bench.rover.press_stop();
  bench.now += Duration{20'000};
  bench.rover.advance_to(bench.now);
  wire::Command idle = bench.drive(0.0F);
  idle.flags = wire::kReleaseStop;
  bench.transmit(idle);
  bench.drive_for(0.28, 0.0F);
  EXPECT_EQ(bench.rover.state().speed_mps, 0.0);
}

// The watchdog expires exactly 0.2 s after the last command, to the microsecond. Then a new driver
// may send, with any sequence number.
TEST(RoverEmulator, AcceptsAnotherDriverAfterItsWatchdog) {
  Bench bench;
  wire::Command other{7, 12, 1, 0, 0.1F, 0.0F, wire::kDrive};
  bench.sequence = 1000;
  bench.transmit(bench.drive(0.1F));
  bench.now = kStart + Duration{200'000};
  bench.transmit(other);
  EXPECT_EQ(bench.rover.refused(), 1);
  bench.now += Duration{1};
  bench.transmit(other);
  EXPECT_EQ(bench.rover.refused(), 1);
  bench.transmit(bench.drive(0.1F));
  EXPECT_EQ(bench.rover.refused(), 2) << "the first driver has lost control";
  EXPECT_EQ(bench.read_telemetry().session, 12U);
  EXPECT_EQ(bench.read_telemetry().refused, 2U);
  bench.rover.receive({}, bench.now);
  EXPECT_EQ(bench.read_telemetry().refused, 3U) << "not a command";
}

TEST(RoverEmulator, HasDocumentedDefaults) {
  const RoverEmulatorSpec spec;
  EXPECT_EQ(spec.number, 1U);
  EXPECT_EQ(spec.delay_s, 0.03);
  EXPECT_EQ(spec.grip, 0.97);
  EXPECT_EQ(spec.drift_radps, 0.02);
  RoverEmulatorSpec empty = Bench::exact();
  empty.battery_share = 0.001;
  empty.battery_per_s = 0.01;
  Bench bench(empty);
  bench.now += Duration{1'000'000};
  EXPECT_EQ(bench.read_telemetry().battery_share, 0.0F) << "not negative";
  bench.rover.push_to({4.0, 5.0, -1.0});
  EXPECT_EQ(bench.rover.state().world_from_body, (Pose2{4.0, 5.0, -1.0}));
}

// Both ends of a wire use the same socket class: one listens, the other sends first.
TEST(RoverEndpoint, ExchangesCommandsAndTelemetry) {
  const std::string port = test::port_of_this_test(2);
  RoverEndpoint endpoint(Bench::exact(), "udpout://127.0.0.1:" + port, kStart);
  VehicleSocket driver("udp://127.0.0.1:" + port);
  driver.write(wire::encode(wire::Command{7, 11, 1, 0, 0.5F, 0.0F, wire::kDrive}));
  endpoint.run_to(kStart + Duration{100'000});
  std::vector<wire::Telemetry> received;
  driver.read_each([&](auto bytes, Time) {
    received.emplace_back();
    EXPECT_EQ(wire::decode(bytes, received.back()), wire::Verdict::kAccepted);
  });
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].session, 11U);
  EXPECT_EQ(received[0].speed_mps, 0.0F) << "received at the end of the step";
  endpoint.run_to(kStart + Duration{200'000});
  EXPECT_NEAR(endpoint.emulator().state().speed_mps, 0.1, 1e-9);
  EXPECT_EQ(endpoint.send_errors(), 0);
}

}  // namespace
}  // namespace vantage::sim
