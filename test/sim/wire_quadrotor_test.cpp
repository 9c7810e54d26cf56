#include "sim/app/wire_quadrotor.hpp"

#include <array>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/check.hpp"
#include "test/sim/lab_scenario.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::sim {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'003'000);

/// A free UDP port on the loopback, used as a driver's port.
class DriverPort {
 public:
  DriverPort() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    number_ = ntohs(address.sin_port);
  }
  ~DriverPort() { close(fd_); }
  DriverPort(const DriverPort&) = delete;
  DriverPort& operator=(const DriverPort&) = delete;
  DriverPort(DriverPort&&) = delete;
  DriverPort& operator=(DriverPort&&) = delete;

  [[nodiscard]] std::string url() const { return "udp://127.0.0.1:" + std::to_string(number_); }

  /// Returns the frames received so far. All frames sent earlier on the loopback have arrived.
  std::vector<wire::mavlink::Frame> frames() {
    std::vector<wire::mavlink::Frame> out;
    std::array<std::uint8_t, 2048> buffer{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    ssize_t got = 0;
    while ((got = recvfrom(fd_, buffer.data(), buffer.size(), MSG_DONTWAIT,
                           reinterpret_cast<sockaddr*>(&from), &size)) > 0) {
      vehicle_ = from;
      parser_.feed({buffer.data(), static_cast<std::size_t>(got)},
                   [&](const wire::mavlink::Frame& frame) { out.push_back(frame); });
    }
    return out;
  }
  template <class Message>
  void send(const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(wire::mavlink::pack(message, {255, 191, sequence_++}), bytes);
    EXPECT_EQ(sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&vehicle_),
                     sizeof vehicle_),
              static_cast<ssize_t>(bytes.size()));
  }

 private:
  int fd_;
  std::uint16_t number_ = 0;
  sockaddr_in vehicle_{};
  wire::mavlink::Parser parser_;
  std::uint8_t sequence_ = 0;
};

scenario::RobotSpec robot_at(const std::string& url) {
  scenario::RobotSpec robot = test::lab_scenario().robots[1];
  robot.device = scenario::DeviceSource::kWire;
  robot.autopilot.emplace();
  robot.autopilot->url = url;
  return robot;
}

TEST(WireQuadrotor, RestsAtItsStartAndSendsToTheDriversPort) {
  DriverPort port;
  const scenario::RobotSpec robot = robot_at(port.url());
  WireQuadrotor vehicle(robot, {}, 7, 1, kStart);
  Time now = kStart;
  std::vector<wire::mavlink::Frame> all_frames;
  for (int k = 0; k < 410; ++k, now += Duration{5'000}) {
    vehicle.step(now, 0.005);
    vehicle.exchange(now + Duration{5'000});
    for (const wire::mavlink::Frame& frame : port.frames()) {
      all_frames.push_back(frame);
    }
  }
  EXPECT_EQ(vehicle.world_from_body().translation_m,
            Eigen::Vector3d(robot.start.x_m, robot.start.y_m, 0.0));
  EXPECT_NEAR(flatten(vehicle.world_from_body()).yaw_rad, robot.start.yaw_rad, 1e-12);
  int heartbeats = 0;
  for (const wire::mavlink::Frame& frame : all_frames) {
    EXPECT_EQ(frame.origin.system_id, 7);
    heartbeats += wire::mavlink::unpack<wire::mavlink::Heartbeat>(frame) ? 1 : 0;
  }
  EXPECT_EQ(heartbeats, 3);  // heartbeats at 1 Hz for 2.05 s
}

TEST(WireQuadrotor, ReceivesDriverAndMeasuresPoseAge) {
  DriverPort port;
  WireQuadrotor vehicle(robot_at(port.url()), {}, 1, 1, kStart);
  vehicle.step(kStart, 0.005);
  vehicle.exchange(kStart + Duration{5'000});
  ASSERT_FALSE(port.frames().empty());
  wire::mavlink::CommandLong command;
  command.target_system = 1;
  command.command = wire::mavlink::command::kArmDisarm;
  command.param1 = 1.0F;
  port.send(command);
  wire::mavlink::Odometry odometry;
  odometry.time_usec = static_cast<std::uint64_t>(to_utime(kStart));  // captured years ago
  port.send(odometry);
  vehicle.exchange(kStart + Duration{5'000});
  bool is_refused = false;
  for (const wire::mavlink::Frame& frame : port.frames()) {
    const auto ack = wire::mavlink::unpack<wire::mavlink::CommandAck>(frame);
    is_refused = is_refused || (ack && ack->result != 0);
  }
  EXPECT_TRUE(is_refused);  // the autopilot does not arm without a position
  std::int64_t age_us = 0;
  for (const models::NamedCount& counter : vehicle.counters()) {
    age_us = counter.name == "wire.Q2.pose_max_us" ? counter.count : age_us;
  }
  EXPECT_GT(age_us, 365LL * 86'400 * 1'000'000);
}

TEST(WireQuadrotor, RefusesUnsupportedSpecs) {
  scenario::RobotSpec robot = test::lab_scenario().robots[0];
  EXPECT_THROW(WireQuadrotor(robot, {}, 1, 1, kStart), StartupError);  // the robot has no autopilot
  for (const char* url : {"", "serial:/dev/ttyUSB0:921600", "udp://127.0.0.1", "udp://:0"}) {
    EXPECT_THROW(WireQuadrotor(robot_at(url), {}, 1, 1, kStart), StartupError) << url;
  }
  robot = robot_at("udp://127.0.0.1:14540");
  robot.autopilot->key_file = "key";
  EXPECT_THROW(WireQuadrotor(robot, {}, 1, 1, kStart), StartupError);
}

TEST(WireQuadrotor, DriftsWithTheScenariosWind) {
  const scenario::WindSpec wind{2.0, 1.0, 0.0};
  Airframe body(airframe_in(wind), 1, {0.0, 0.0, 0.0}, 0.0);
  const Eigen::Vector3d upward(0.0, 0.0, -0.5);  // upward, because z points down
  for (int k = 0; k < 600; ++k) {
    body.step(true, upward, 0.0, 0.005);
  }
  ASSERT_FALSE(body.is_on_ground());
  // The vehicle flies for 3 s, at first on the ground, so it reaches at most 1 − e^(−0.25 · 3) of
  // the wind speed. The local y axis is opposite to the y axis of the world.
  EXPECT_GT(body.velocity_mps().x(), 0.5);
  EXPECT_LT(body.velocity_mps().x(), 0.53 * 2.0);
  EXPECT_NEAR(body.velocity_mps().y(), -0.5 * body.velocity_mps().x(), 1e-6);
}

}  // namespace
}  // namespace vantage::sim
