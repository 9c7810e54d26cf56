// Tests the position, as seen by the simulated world, of a vehicle flown by real firmware in its
// own time.

#include "sim/app/wire_firmware.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "test/sim/lab_scenario.hpp"
#include "wire/sitl/json_physics.hpp"

namespace vantage::sim {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'003'000);
constexpr Duration kMs{1'000};

/// A vehicle in wind, and a firmware that sends the same command to all motors.
struct Lab {
  Lab() {
    scenario::RobotSpec robot = test::lab_scenario().robots[1];
    robot.autopilot.emplace();
    robot.autopilot->dialect = models::AutopilotDialect::kArdupilot;
    robot.firmware.emplace();
    for (int instance = 3400 + getpid() % 1000; !vehicle; ++instance) {
      try {
        vehicle =
            std::make_unique<WireFirmware>(robot, scenario::WindSpec{8.0, -4.0, 0.0}, instance, 1);
        port = wire::sitl::kJsonPort + 10 * instance;
      } catch (const StartupError&) {
      }
    }
  }
  ~Lab() { close(fd); }
  Lab(const Lab&) = delete;
  Lab& operator=(const Lab&) = delete;
  Lab(Lab&&) = delete;
  Lab& operator=(Lab&&) = delete;

  /// Sends `steps` motor commands and waits for the sensor message that answers each. After the
  /// last answer, the body waits for the next command, for a quarter of a second at most.
  void fly(int steps, std::uint16_t pulse_us) const {
    const sockaddr_in to = address_of(INADDR_LOOPBACK, port);
    wire::sitl::ServoOutputs outputs;
    outputs.pulse_us.fill(pulse_us);
    const auto bytes = wire::sitl::format_servo_outputs(outputs);
    std::array<char, 2048> received{};
    for (int k = 0; k < steps; ++k) {
      ASSERT_EQ(sendto(fd, bytes.data(), bytes.size(), 0, as_sockaddr(to), sizeof to),
                static_cast<ssize_t>(bytes.size()));
      pollfd polled{fd, POLLIN, 0};
      ASSERT_EQ(poll(&polled, 1, 10'000), 1);
      ASSERT_GT(recv(fd, received.data(), received.size(), 0), 0);
    }
  }
  Eigen::Vector3d place_at(Time now, double dt_s = 0.0) const {
    vehicle->step(now, dt_s);
    return vehicle->world_from_body().translation_m;
  }
  int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  int port = 0;
  std::unique_ptr<WireFirmware> vehicle;
};

// Times refer to the clock that was set last. Positions of the last 0.1 s are stored, and up to 20
// ms are extrapolated. Before a clock is set, the current position is returned.
TEST(WireFirmware, ReturnsItsPoseAtTheRequestedTime) {
  for (int attempt = 0; attempt < 30; ++attempt) {
    Lab lab;
    lab.fly(150, 1'800);
    const std::int64_t begin_ns = monotonic_ns();
    const Eigen::Vector3d untold_m = lab.place_at(kStart);
    lab.vehicle->exchange(kStart);
    const Eigen::Vector3d now_m = lab.place_at(kStart);
    std::array<Eigen::Vector3d, 4> back_m;
    std::array<Eigen::Vector3d, 4> back_mps;
    for (int k = 0; k < 4; ++k) {
      back_m[static_cast<std::size_t>(k)] = lab.place_at(kStart - (10 + 10 * k) * kMs);
      back_mps[static_cast<std::size_t>(k)] = lab.vehicle->velocity_world_mps();
    }
    const Eigen::Vector3d by_step_m = lab.place_at(kStart - 25 * kMs, 0.015);
    const Eigen::Vector3d far_m = lab.place_at(kStart + 1'000 * kMs);
    const Eigen::Vector3d velocity_mps = lab.vehicle->velocity_world_mps();
    lab.vehicle->exchange(kStart + 77 * kMs);
    const Eigen::Vector3d told_anew_m = lab.place_at(kStart + 67 * kMs);
    if (monotonic_ns() - begin_ns > 2'000'000 ||
        (far_m - now_m).norm() < 0.012 * velocity_mps.norm()) {
      continue;  // repeat, because the machine was busy
    }
    ASSERT_GT(velocity_mps.z(), 0.3);
    // The extrapolation covers at most the time since the newest sample.
    EXPECT_LT((now_m - untold_m).norm(), 0.003 * velocity_mps.norm());
    EXPECT_LT((far_m - now_m).norm(), 0.0201 * velocity_mps.norm());
    EXPECT_LT((told_anew_m - back_m[0]).norm(), 0.003 * velocity_mps.norm());
    // Between positions 10 ms apart lies the distance flown in that time.
    EXPECT_EQ(by_step_m, back_m[0]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d mean_mps = 0.5 * (back_mps[k] + back_mps[k + 1]);
      EXPECT_LT((back_m[k] - back_m[k + 1] - 0.01 * mean_mps).norm(), 2e-4) << k;
      EXPECT_GT(mean_mps.z(), 0.1);
    }
    return;
  }
  FAIL() << "the machine was busy each time";
}

// In a wind without gusts the body drifts with the wind, as far as drag accelerates it.
TEST(WireFirmware, IsMovedByTheScenariosWind) {
  Lab lab;
  lab.fly(150, 1'800);
  lab.vehicle->step(kStart, 0.0);
  const Eigen::Vector3d velocity_mps = lab.vehicle->velocity_world_mps();
  const MultirotorParameters p;
  EXPECT_GT(velocity_mps.x(), 0.05);
  EXPECT_LT(velocity_mps.x(), 8.0 * p.drag_per_s * 0.5);
  EXPECT_NEAR(velocity_mps.y(), -0.5 * velocity_mps.x(), 1e-6);
}

}  // namespace
}  // namespace vantage::sim
