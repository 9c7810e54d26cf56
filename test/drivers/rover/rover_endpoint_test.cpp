// Tests a driver and an emulated rover, connected by a real loopback socket, in virtual time.

#include "sim/rover/rover_endpoint.hpp"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "drivers/rover/link.hpp"
#include "drivers/vehicle/port.hpp"
#include "test/support/udp_port.hpp"

namespace vantage::drivers {
namespace {

using test::port_of_this_test;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// Sends commands at 50 Hz for one second; expects that the rover drives and reports its motion.
void drive(const std::string& url) {
  const std::unique_ptr<Port> port = open_port(url);
  sim::RoverEmulatorSpec spec;
  spec.number = 7;
  sim::RoverEndpoint rover(spec, url, kStart);
  RoverLink link(7, 41);
  std::array<std::uint8_t, 2048> buffer{};
  Time now = kStart;
  for (int i = 0; i < 50; ++i) {
    now += Duration{20'000};
    rover.run_to(now);
    while (const std::size_t got = port->read(buffer, now)) {
      if (link.receive({buffer.data(), got}, now)) {
        port->accept(now);
      }
    }
    port->write(link.command({0.4, 0.2}, wire::rover::kDrive, now), now);
  }
  EXPECT_NEAR(rover.emulator().state().speed_mps, 0.4, 1e-6);
  EXPECT_NEAR(static_cast<double>(link.telemetry().speed_mps), 0.4, 1e-6);
  EXPECT_NEAR(static_cast<double>(link.telemetry().yaw_rate_radps), 0.2, 1e-6);
  EXPECT_TRUE(link.has_flag(wire::rover::kDriving));
  EXPECT_TRUE(link.is_ours());
  EXPECT_LE(link.taken_command_age_s(now), 0.1);
  EXPECT_EQ(rover.emulator().refused(), 0);
}

TEST(RoverEndpoint, IsDrivenByADriverThatSendsFirst) {
  drive("udpout://127.0.0.1:" + port_of_this_test(0));
}

TEST(RoverEndpoint, IsDrivenByAWaitingDriver) { drive("udp://127.0.0.1:" + port_of_this_test(1)); }

}  // namespace
}  // namespace vantage::drivers
