// Flies the simulated Crazyflie with the real firmware, cf2. Without it in PATH the tests are
// skipped (docs/guide/firmware-crazyflie.md).

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/child.hpp"
#include "core/deadline.hpp"
#include "sim/firmware/crazyflie_link.hpp"
#include "sim/firmware/firmware_flight.hpp"
#include "test/support/free_port.hpp"

namespace vantage::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr Pose2 kStart{0.3, -0.2, 0.5};
constexpr std::uint16_t kLockedBit = 1U << 6U;
constexpr std::uint16_t kFlyingBit = 1U << 4U;

/// A firmware in flight with a client that sends the true pose every 10 ms.
class CrazyflieFirmware : public testing::Test {
 protected:
  void SetUp() override {
    const CrazyflieLink::Ports ports{test::free_port(), test::free_port()};
    flight_ = std::make_unique<FirmwareFlight>(crazyflie_body(), crazyflie_noise(), 1, kStart,
                                               std::make_unique<CrazyflieLink>(ports));
    const sockaddr_in at = address_of(INADDR_LOOPBACK, ports.client);
    ASSERT_EQ(connect(fd_, as_sockaddr(at), sizeof at), 0);
    ChildOptions options;
    options.output = null_;
    Result<Child> started =
        Child::start({"cf2", std::to_string(ports.firmware), "127.0.0.1"}, options);
    if (!started.ok()) {
      GTEST_SKIP() << "no Crazyflie firmware in PATH: " << started.error().message;
    }
    firmware_.emplace(std::move(started).value());
    // Calibrates gyro and accelerometer at rest: 2 s of samples after the hello.
    fly_ms(3'500, [](std::int64_t) {});
    ASSERT_TRUE(info()) << "the firmware does not answer";
    dropped_before_ = counts().dropped;  // poses sent before the firmware's hello
  }
  ~CrazyflieFirmware() override {
    close(fd_);
    close(null_);
  }

  static void append(Bytes& out, double value) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    for (unsigned i = 0; i < 4; ++i) {
      out.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
    }
  }
  void send(const Bytes& packet) const {
    EXPECT_EQ(::send(fd_, packet.data(), packet.size(), 0), static_cast<ssize_t>(packet.size()));
  }
  /// Sends command `number` of the high-level commander, 7 take-off or 8 landing.
  void send_high_level(std::uint8_t number, double height_m, double duration_s) const {
    Bytes packet{0x8C, number, 0};
    append(packet, height_m);
    append(packet, 0.0);
    packet.push_back(1);  // keep the yaw
    append(packet, duration_s);
    send(packet);
  }
  void send_position(double height_m) const {
    Bytes packet{0x7C, 7};
    for (const double value : {kStart.x_m, kStart.y_m, height_m, 28.6}) {
      append(packet, value);
    }
    send(packet);
  }
  /// Flies for `ms` simulated milliseconds and calls `each` every 10 ms.
  template <class Each>
  void fly_ms(std::int64_t ms, Each&& each) {
    const std::int64_t first = flight_->counts().steps;
    for (std::int64_t due = first; due < first + ms; due += 10) {
      while (flight_->counts().steps < due) {
        pollfd polled{fd_, POLLIN, 0};
        if (poll(&polled, 1, 1) > 0) {
          read();
        }
      }
      send_pose();
      each(due - first);
      if ((due - first) % 40 == 0) {
        send({0x9C, 0x0C});
      }
    }
  }
  /// True if the firmware was kept from computing for so long that the simulator stopped the
  /// motors.
  [[nodiscard]] bool was_held_up() const { return counts().silences > 0 || counts().resumed > 0; }
  [[nodiscard]] std::int64_t dropped() const { return counts().dropped - dropped_before_; }
  [[nodiscard]] std::optional<std::uint16_t> info() const { return info_; }
  [[nodiscard]] bool has(std::uint16_t bit) const { return (info_.value_or(0) & bit) != 0; }
  [[nodiscard]] Eigen::Vector3d place_m() const {
    return flight_->at(monotonic_ns()).world_from_body.translation_m;
  }
  [[nodiscard]] FirmwareFlight::Counts counts() const { return flight_->counts(); }

 private:
  void send_pose() const {
    const Pose3 pose = flight_->at(monotonic_ns()).world_from_body;
    Bytes packet{0x6D, 8};
    for (const double value :
         {pose.translation_m.x(), pose.translation_m.y(), pose.translation_m.z(), pose.rotation.x(),
          pose.rotation.y(), pose.rotation.z(), pose.rotation.w()}) {
      append(packet, value);
    }
    send(packet);
  }
  void read() {
    std::array<std::uint8_t, 64> buffer{};
    ssize_t got = 0;
    while ((got = recv(fd_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0) {
      if (got == 4 && buffer[0] >> 4 == 9 && buffer[1] == 0x8C) {
        info_ = static_cast<std::uint16_t>(buffer[2] + 256 * buffer[3]);
      }
    }
  }

  int fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  int null_ = open("/dev/null", O_WRONLY | O_CLOEXEC);
  std::optional<Child> firmware_;
  std::unique_ptr<FirmwareFlight> flight_;
  std::optional<std::uint16_t> info_;
  std::int64_t dropped_before_ = 0;
};

TEST_F(CrazyflieFirmware, TakesOffHoversAndLands) {
  send_high_level(7, 0.5, 2.0);
  fly_ms(3'500, [](std::int64_t) {});
  EXPECT_TRUE(has(kFlyingBit));
  double farthest_m = 0.0;
  fly_ms(2'000, [&](std::int64_t) {
    const Eigen::Vector3d wanted_m(kStart.x_m, kStart.y_m, 0.5);
    farthest_m = std::max(farthest_m, (place_m() - wanted_m).norm());
  });
  if (was_held_up()) {
    GTEST_SKIP() << "the machine was too busy for firmware in real time";
  }
  EXPECT_LT(farthest_m, 0.15);
  EXPECT_GT(farthest_m, 0.0);
  send_high_level(8, 0.0, 2.0);
  fly_ms(5'000, [](std::int64_t) {});
  EXPECT_NEAR(place_m().z(), 0.0, 0.01);
  EXPECT_FALSE(has(kFlyingBit));
  EXPECT_FALSE(has(kLockedBit));
  EXPECT_EQ(dropped(), 0);
}

// The most dangerous property of the firmware (docs/reference/crazyflie-firmware.md).
TEST_F(CrazyflieFirmware, FallsAndLocksTwoSecondsAfterTheLastSetpoint) {
  fly_ms(3'500, [&](std::int64_t) { send_position(0.5); });
  if (was_held_up()) {
    GTEST_SKIP() << "the machine was too busy for firmware in real time";
  }
  EXPECT_GT(place_m().z(), 0.3);
  std::optional<std::int64_t> locked_ms;
  fly_ms(4'000, [&](std::int64_t ms) {
    if (!locked_ms && has(kLockedBit)) {
      locked_ms = ms;
    }
  });
  ASSERT_TRUE(locked_ms);
  EXPECT_NEAR(static_cast<double>(*locked_ms), 2'000.0, 400.0);
  EXPECT_NEAR(place_m().z(), 0.0, 0.05);
}

}  // namespace
}  // namespace vantage::sim
