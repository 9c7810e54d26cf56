// Tests the links between simulator and firmware: all packets arrive, in order; the newest of
// several connected peers is used; positions are interpolated between two samples of a flight.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "sim/firmware/ardupilot_link.hpp"
#include "sim/firmware/firmware_flight.hpp"
#include "sim/firmware/px4_link.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/sitl/json_physics.hpp"

namespace vantage::sim {
namespace {

constexpr Duration kLong = std::chrono::seconds(5);

/// A firmware that sends ArduPilot's JSON packets to a link on a free port.
struct Ardupilot {
  Ardupilot() {
    for (instance = 1200 + getpid() % 1000; !link; ++instance) {
      try {
        link = std::make_unique<ArdupilotLink>(instance);
        port = 9002 + 10 * instance;
        break;
      } catch (const StartupError&) {
      }
    }
  }
  ~Ardupilot() { close(fd); }
  Ardupilot(const Ardupilot&) = delete;
  Ardupilot& operator=(const Ardupilot&) = delete;
  Ardupilot(Ardupilot&&) = delete;
  Ardupilot& operator=(Ardupilot&&) = delete;
  void transmit(const std::vector<std::uint8_t>& bytes) const {
    const sockaddr_in to = address_of(INADDR_LOOPBACK, port);
    ASSERT_EQ(sendto(fd, bytes.data(), bytes.size(), 0, as_sockaddr(to), sizeof to),
              static_cast<ssize_t>(bytes.size()));
  }
  void send_pulses(const std::array<std::uint16_t, 4>& pulses_us) const {
    wire::sitl::ServoOutputs outputs;
    std::copy(pulses_us.begin(), pulses_us.end(), outputs.pulse_us.begin());
    const auto bytes = wire::sitl::format_servo_outputs(outputs);
    transmit({bytes.begin(), bytes.end()});
  }
  [[nodiscard]] std::string read_reply() const {
    std::string out(2048, '\0');
    const ssize_t got = recv(fd, out.data(), out.size(), MSG_DONTWAIT);
    out.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return out;
  }
  int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  int instance = 0;
  int port = 0;
  std::unique_ptr<ArdupilotLink> link;
};

TEST(ArdupilotLink, SendsEverySensorByName) {
  Ardupilot firmware;
  firmware.send_pulses({1'500, 1'500, 1'500, 1'500});
  ASSERT_TRUE(firmware.link->receive(kLong));
  FirmwareSensors sensors;
  sensors.since_start = Duration{12'500'000};
  sensors.gyro_body_radps = {0.1, -0.2, 0.3};
  sensors.specific_force_body_mps2 = {0.5, -0.25, -9.5};
  sensors.position_local_m = {-3.0, 0.25, -1.5};
  sensors.velocity_local_mps = {0.75, -0.5, 0.125};
  sensors.local_from_body = Quaternion(0.5, -0.5, 0.5, -0.5);
  ASSERT_TRUE(firmware.link->send(sensors));
  wire::sitl::JsonSensors expected;
  expected.time_s = 12.5;
  expected.gyro_body_radps = sensors.gyro_body_radps;
  expected.specific_force_body_mps2 = sensors.specific_force_body_mps2;
  expected.position_local_m = sensors.position_local_m;
  expected.velocity_local_mps = sensors.velocity_local_mps;
  expected.local_from_body = sensors.local_from_body;
  EXPECT_EQ(firmware.read_reply(), wire::sitl::format_json_sensors(expected));
}

TEST(ArdupilotLink, ReturnsTheNewestThrottlePerMotor) {
  Ardupilot firmware;
  EXPECT_FALSE(firmware.link->receive(Duration{0}));
  EXPECT_FALSE(firmware.link->receive(Duration{1'500}));
  firmware.send_pulses({1'900, 1'900, 1'900, 1'900});
  firmware.send_pulses({1'100, 1'200, 1'300, 1'400});
  firmware.transmit(std::vector<std::uint8_t>{1, 2, 3});  // not a packet
  const auto motors = firmware.link->receive(kLong);
  ASSERT_TRUE(motors);
  for (std::size_t i = 0; i < kMotors; ++i) {
    EXPECT_NEAR(motors->throttles[i], 0.1 * static_cast<double>(i + 1), 1e-12);
  }
  EXPECT_FALSE(firmware.link->receive(Duration{0}));
  firmware.transmit(std::vector<std::uint8_t>{1, 2, 3});
  EXPECT_FALSE(firmware.link->receive(kLong)) << "no other packet";
  EXPECT_TRUE(firmware.link->is_lockstep());
  EXPECT_EQ(firmware.link->period(), Duration{1'250});
}

TEST(ArdupilotLink, ReportsUnavailablePort) {
  const Ardupilot firmware;
  try {
    const ArdupilotLink second(firmware.instance);
    FAIL();
  } catch (const StartupError& error) {
    EXPECT_EQ(std::string(error.what()), "firmware instance " + std::to_string(firmware.instance) +
                                             ": UDP port " + std::to_string(firmware.port) +
                                             " on this host: Address already in use");
  }
}

/// A PX4 connected to a link on a free port.
struct Px4 {
  Px4() {
    for (int instance = 1200 + getpid() % 1000; !link; ++instance) {
      try {
        link = Px4Link::listening(instance);
        port = 4560 + instance;
      } catch (const StartupError&) {
      }
    }
    connect_anew();
  }
  ~Px4() { close(fd); }
  Px4(const Px4&) = delete;
  Px4& operator=(const Px4&) = delete;
  Px4(Px4&&) = delete;
  Px4& operator=(Px4&&) = delete;
  void connect_anew() {
    if (fd >= 0) {
      close(fd);
    }
    fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in to = address_of(INADDR_LOOPBACK, port);
    EXPECT_EQ(connect(fd, as_sockaddr(to), sizeof to), 0);
    parser = {};
  }
  void transmit(std::uint64_t time_usec, float throttle) const {
    wire::mavlink::HilActuatorControls controls;
    controls.time_usec = time_usec;
    controls.mode = wire::mavlink::kArmedFlag;
    for (std::size_t i = 0; i < 4; ++i) {
      controls.controls[i] = throttle * static_cast<float>(i + 1);
    }
    send(controls);
  }
  template <class Message>
  void send(const Message& message) const {
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(wire::mavlink::pack(message, {1, 1, 0}), bytes);
    ASSERT_EQ(write(fd, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  /// Returns the frames received since the last call.
  std::vector<wire::mavlink::Frame> read_reply() {
    std::vector<wire::mavlink::Frame> out;
    std::array<std::uint8_t, 4096> bytes{};
    ssize_t got = 0;
    while ((got = recv(fd, bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0) {
      parser.feed({bytes.data(), static_cast<std::size_t>(got)},
                  [&](const wire::mavlink::Frame& frame) { out.push_back(frame); });
    }
    return out;
  }
  static FirmwareSensors at(std::int64_t us) {
    FirmwareSensors out;
    out.since_start = Duration{us};
    return out;
  }
  int fd = -1;
  int port = 0;
  std::unique_ptr<Px4Link> link;
  wire::mavlink::Parser parser;
};

// A heartbeat precedes the first sample and every 250th sample. Frames are sent by system 200, with
// consecutive numbers. Compass and barometer data are sent in turn.
TEST(Px4Link, SendsHeartbeatEachSecondAndNumbersFrames) {
  Px4 firmware;
  std::vector<wire::mavlink::Frame> frames;
  for (int k = 1; k <= 510; ++k) {
    ASSERT_TRUE(firmware.link->send(Px4::at(4'000 * k)));
    for (const wire::mavlink::Frame& frame : firmware.read_reply()) {
      frames.push_back(frame);
    }
  }
  std::vector<std::size_t> heartbeats;
  std::vector<std::uint32_t> fields;
  std::uint8_t sequence = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(frames[k].origin.system_id, 200);
    EXPECT_EQ(frames[k].origin.component_id, 1);
    EXPECT_EQ(frames[k].origin.sequence, sequence++);
    if (const auto sensors = wire::mavlink::unpack<wire::mavlink::HilSensor>(frames[k])) {
      fields.push_back(sensors->fields_updated);
    } else {
      heartbeats.push_back(k);
    }
  }
  EXPECT_EQ(heartbeats, (std::vector<std::size_t>{0, 251, 502}));
  ASSERT_EQ(fields.size(), 510u);
  for (std::size_t k = 0; k < fields.size(); ++k) {
    EXPECT_EQ(fields[k], k % 5 == 0 ? 0x1FFU : k % 5 == 2 ? 0x1A3FU : 0x3FU) << k;
  }
  EXPECT_EQ(firmware.link->period(), Duration{4'000});
  EXPECT_EQ(firmware.link->counts().unsent, 0);
}

TEST(Px4Link, ReturnsCommandsThatAnswerTheLastSensors) {
  Px4 firmware;
  ASSERT_TRUE(firmware.link->send(Px4::at(4'000)));
  firmware.send(wire::mavlink::Heartbeat{});  // contains no motor commands
  EXPECT_FALSE(firmware.link->receive(Duration{0}));
  firmware.transmit(4'001, 0.125F);
  const auto motors = firmware.link->receive(kLong);
  ASSERT_TRUE(motors);
  EXPECT_EQ(motors->throttles, (Throttles{0.125, 0.25, 0.375, 0.5}));
  ASSERT_TRUE(firmware.link->send(Px4::at(8'000)));
  EXPECT_FALSE(firmware.link->receive(Duration{0})) << "each answer is returned once";
  EXPECT_EQ(firmware.link->counts().stale, 0);
  firmware.transmit(7'999, 0.2F);
  EXPECT_FALSE(firmware.link->receive(Duration{2'000}));
  EXPECT_EQ(firmware.link->counts().stale, 1);
}

// An incomplete frame of the previous firmware does not affect the next firmware.
TEST(Px4Link, DropsPartialFrameOfOldFirmware) {
  Px4 firmware;
  ASSERT_TRUE(firmware.link->send(Px4::at(4'000)));
  std::vector<std::uint8_t> bytes;
  wire::mavlink::HilActuatorControls controls;
  controls.time_usec = 4'000;
  controls.mode = wire::mavlink::kArmedFlag;
  wire::mavlink::append_bytes(wire::mavlink::pack(controls, {1, 1, 0}), bytes);
  ASSERT_EQ(write(firmware.fd, bytes.data(), 20), 20);
  EXPECT_FALSE(firmware.link->receive(Duration{0}));
  firmware.connect_anew();
  ASSERT_TRUE(firmware.link->send(Px4::at(8'000)));
  firmware.transmit(8'000, 0.25F);
  const auto motors = firmware.link->receive(kLong);
  ASSERT_TRUE(motors);
  EXPECT_EQ(motors->throttles[3], 1.0);
}

TEST(Px4Link, ReportsInvalidBaudRate) {
  const auto why = [](const std::string& line) {
    try {
      Px4Link::on_serial_line(line);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(why("/dev/x:12345"), "firmware: serial line /dev/x:12345: 12345 is not a baud rate");
  EXPECT_EQ(why("/dev/x:57600x"), "firmware: serial line /dev/x:57600x: 57600x is not a baud rate");
  EXPECT_EQ(why("/dev/x:57600"), "");
  EXPECT_EQ(why("/dev/x"), "");
}

/// A firmware that makes a body turn and climb. While the test pauses the firmware, the flight
/// pauses too.
class PausableFirmware : public FirmwareLink {
 public:
  struct Shared {
    std::atomic<bool> is_paused{false};
    std::atomic<bool> is_waiting{false};
  };
  explicit PausableFirmware(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
  [[nodiscard]] Duration period() const override { return Duration{2'500}; }
  [[nodiscard]] bool is_lockstep() const override { return true; }
  bool send(const FirmwareSensors&) override { return true; }
  std::optional<MotorCommand> receive(Duration) override {
    while (shared_->is_paused) {
      shared_->is_waiting = true;
      std::this_thread::yield();
    }
    return MotorCommand{{0.8, 0.8, 0.82, 0.82}};
  }

 private:
  std::shared_ptr<Shared> shared_;
};

TEST(FirmwareFlight, InterpolatesAndExtrapolatesBriefly) {
  constexpr std::int64_t kPeriodNs = 2'500'000;
  constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max() / 2;
  for (int attempt = 0; attempt < 20; ++attempt) {
    auto shared = std::make_shared<PausableFirmware::Shared>();
    FirmwareFlight flight({}, {}, 1, {1.0, 2.0, 3.0}, std::make_unique<PausableFirmware>(shared));
    const FirmwareFlight::Sample standing = flight.at(0);
    EXPECT_NEAR(flatten(standing.world_from_body).x_m, 1.0, 1e-3);
    while (flight.counts().steps < 150) {
      std::this_thread::yield();
    }
    shared->is_paused = true;
    while (!shared->is_waiting) {
      std::this_thread::yield();
    }
    const FirmwareFlight::Sample far = flight.at(kFar);
    const std::int64_t newest_ns = far.monotonic_ns - 20'000'000;
    const FirmwareFlight::Sample newest = flight.at(newest_ns);
    const FirmwareFlight::Sample before = flight.at(newest_ns - kPeriodNs);
    const FirmwareFlight::Sample oldest = flight.at(0);
    const bool was_away = flight.counts().resumed > 0;
    const FirmwareFlight::Sample beyond = flight.at(newest_ns + 5'000'000);
    const FirmwareFlight::Sample between = flight.at(newest_ns - kPeriodNs / 4);
    const FirmwareFlight::Sample far_back = flight.at(newest_ns - 62 * kPeriodNs - kPeriodNs / 2);
    shared->is_paused = false;
    if (was_away) {
      continue;  // the machine was busy, so the sample spacing is not one period
    }
    const auto place = [](const FirmwareFlight::Sample& sample) {
      return sample.world_from_body.translation_m;
    };
    EXPECT_GT(newest.velocity_world_mps.z(), 0.3);
    EXPECT_EQ(newest.monotonic_ns, newest_ns);
    EXPECT_LT((place(far) - place(newest) - 0.02 * newest.velocity_world_mps).norm(), 1e-12);
    EXPECT_LT((place(beyond) - place(newest) - 0.005 * newest.velocity_world_mps).norm(), 1e-12);
    EXPECT_EQ(beyond.monotonic_ns, newest_ns + 5'000'000);
    EXPECT_LT((place(between) - 0.75 * place(newest) - 0.25 * place(before)).norm(), 1e-12);
    EXPECT_LT((between.velocity_world_mps - 0.75 * newest.velocity_world_mps -
               0.25 * before.velocity_world_mps)
                  .norm(),
              1e-12);
    EXPECT_EQ(between.monotonic_ns, newest_ns - kPeriodNs / 4);
    const auto turned_rad = [&](const FirmwareFlight::Sample& from,
                                const FirmwareFlight::Sample& to) {
      return from.world_from_body.rotation.angularDistance(to.world_from_body.rotation);
    };
    EXPECT_GT(turned_rad(before, newest), 1e-5);
    EXPECT_NEAR(turned_rad(before, between) / turned_rad(before, newest), 0.75, 0.01);
    // 64 samples are stored. For earlier times, the oldest sample is used.
    EXPECT_EQ(oldest.monotonic_ns, newest_ns - 63 * kPeriodNs);
    EXPECT_GT(place(far_back).z(), place(oldest).z());
    EXPECT_LT(place(far_back).z(), place(newest).z());
    EXPECT_LT(flight.battery_share(), 1.0);
    return;
  }
  FAIL() << "the thread was delayed each time";
}

}  // namespace
}  // namespace vantage::sim
