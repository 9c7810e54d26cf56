#include "sim/firmware/px4_link.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "core/write_file.hpp"
#include "test/support/emulation.hpp"
#include "test/support/temporary_folder.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::sim {
namespace {

constexpr Duration kLong = std::chrono::seconds(5);

/// The firmware's end of the connection to the simulator.
class FakeFirmware {
 public:
  explicit FakeFirmware(int fd) : fd_(fd) {}
  ~FakeFirmware() { hang_up(); }
  FakeFirmware(const FakeFirmware&) = delete;
  FakeFirmware& operator=(const FakeFirmware&) = delete;
  FakeFirmware(FakeFirmware&&) = delete;
  FakeFirmware& operator=(FakeFirmware&&) = delete;

  /// Connects to the simulator's port, as PX4 does.
  static int connected_to(int port) {
    const sockaddr_in address = address_of(INADDR_LOOPBACK, port);
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(connect(fd, as_sockaddr(address), sizeof address), 0);
    const int yes = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    return fd;
  }

  void transmit(std::uint64_t time_usec, std::array<float, 4> throttles, bool is_armed = true) {
    wire::mavlink::HilActuatorControls controls;
    controls.time_usec = time_usec;
    controls.flags = 1;
    controls.mode = is_armed ? wire::mavlink::kArmedFlag : 0;
    std::copy(throttles.begin(), throttles.end(), controls.controls.begin());
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(wire::mavlink::pack(controls, {1, 1, 0}), bytes);
    ASSERT_EQ(write(fd_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  /// Returns the next sensor message of the simulator.
  wire::mavlink::HilSensor read_reply() {
    while (received_.empty()) {
      pollfd polled{fd_, POLLIN, 0};
      std::array<std::uint8_t, 1024> bytes{};
      if (poll(&polled, 1, 5000) != 1) {
        ADD_FAILURE() << "no sensor message";
        return {};
      }
      const ssize_t got = read(fd_, bytes.data(), bytes.size());
      if (got <= 0) {
        ADD_FAILURE() << "the simulator closed the connection";
        return {};
      }
      parser_.feed(
          {bytes.data(), static_cast<std::size_t>(got)}, [this](const wire::mavlink::Frame& frame) {
            if (const auto sensors = wire::mavlink::unpack<wire::mavlink::HilSensor>(frame)) {
              received_.push_back(*sensors);
            }
          });
    }
    const wire::mavlink::HilSensor out = received_.front();
    received_.erase(received_.begin());
    return out;
  }
  /// True if the simulator has closed the connection.
  bool is_let_go() {
    pollfd polled{fd_, POLLIN, 0};
    std::array<std::uint8_t, 1024> bytes{};
    while (poll(&polled, 1, 5000) == 1) {
      if (read(fd_, bytes.data(), bytes.size()) <= 0) {
        return true;
      }
    }
    return false;
  }
  void hang_up() {
    if (fd_ >= 0) {
      close(fd_);
    }
    fd_ = -1;
  }

 private:
  int fd_;
  wire::mavlink::Parser parser_;
  std::vector<wire::mavlink::HilSensor> received_;
};

struct Listening {
  std::unique_ptr<Px4Link> link;
  int port = 0;
};

/// Returns a link that listens on a free port of this machine.
Listening listen_somewhere() {
  for (int instance = 100 + getpid() % 1000;; ++instance) {
    try {
      return {Px4Link::listening(instance), Px4Link::kPort + instance};
    } catch (const StartupError&) {
    }
  }
}

FirmwareSensors sensors_at(Duration since_start) {
  FirmwareSensors out;
  out.since_start = since_start;
  out.gyro_body_radps = {0.1, -0.2, 0.3};
  out.specific_force_body_mps2 = {0.5, -0.25, -9.5};
  out.magnetic_field_body_gauss = {0.25, 0.125, 0.5};
  out.pressure_hpa = 1000.5;
  out.pressure_altitude_m = 107.0;
  out.temperature_c = 21.5;
  return out;
}

TEST(Px4Link, SendsSensorsInFirmwareUnits) {
  const auto [link, port] = listen_somewhere();
  EXPECT_FALSE(link->send(sensors_at(Duration{4'000})));  // no firmware is connected
  FakeFirmware firmware(FakeFirmware::connected_to(port));
  ASSERT_TRUE(link->send(sensors_at(Duration{8'000})));
  const wire::mavlink::HilSensor received = firmware.read_reply();
  EXPECT_EQ(received.time_usec, 8'000U);
  EXPECT_FLOAT_EQ(received.xgyro, 0.1F);
  EXPECT_FLOAT_EQ(received.ygyro, -0.2F);
  EXPECT_FLOAT_EQ(received.zgyro, 0.3F);
  EXPECT_FLOAT_EQ(received.xacc, 0.5F);
  EXPECT_FLOAT_EQ(received.yacc, -0.25F);
  EXPECT_FLOAT_EQ(received.zacc, -9.5F);
  EXPECT_FLOAT_EQ(received.xmag, 0.25F);
  EXPECT_FLOAT_EQ(received.ymag, 0.125F);
  EXPECT_FLOAT_EQ(received.zmag, 0.5F);
  EXPECT_FLOAT_EQ(received.abs_pressure, 1000.5F);
  EXPECT_FLOAT_EQ(received.pressure_alt, 107.0F);
  EXPECT_FLOAT_EQ(received.temperature, 21.5F);
  EXPECT_EQ(received.id, 0);
}

// PX4 uses a sensor only if its bits are set, and refuses a compass that repeats a value at too
// high a rate.
TEST(Px4Link, FlagsInertialDataPerSampleAndOtherDataAt50Hz) {
  const auto [link, port] = listen_somewhere();
  FakeFirmware firmware(FakeFirmware::connected_to(port));
  int magnetic = 0;
  int barometric = 0;
  for (int i = 1; i <= 50; ++i) {
    ASSERT_TRUE(link->send(sensors_at(i * link->period())));
    const std::uint32_t fields = firmware.read_reply().fields_updated;
    EXPECT_EQ(fields & 0x3FU, 0x3FU);
    magnetic += (fields & 0x1C0U) == 0x1C0U ? 1 : 0;
    barometric += (fields & 0x1A00U) == 0x1A00U ? 1 : 0;
    EXPECT_EQ(fields & ~0x1BFFU, 0U);
  }
  EXPECT_EQ(magnetic, 10);
  EXPECT_EQ(barometric, 10);
}

TEST(Px4Link, ReturnsTheMotorsForTheLastSensors) {
  const auto [link, port] = listen_somewhere();
  EXPECT_TRUE(link->is_lockstep());
  FakeFirmware firmware(FakeFirmware::connected_to(port));
  ASSERT_TRUE(link->send(sensors_at(Duration{4'000})));
  EXPECT_EQ(link->receive(Duration{0}), std::nullopt);
  firmware.transmit(4'000, {0.1F, 0.2F, 0.3F, 0.4F});
  const auto command = link->receive(kLong);
  ASSERT_TRUE(command);
  EXPECT_FLOAT_EQ(static_cast<float>(command->throttles[0]), 0.1F);
  EXPECT_FLOAT_EQ(static_cast<float>(command->throttles[3]), 0.4F);
  EXPECT_EQ(link->receive(Duration{0}), std::nullopt) << "each answer is returned once";

  ASSERT_TRUE(link->send(sensors_at(Duration{8'000})));
  firmware.transmit(4'000, {0.9F, 0.9F, 0.9F, 0.9F});  // reply to older sensors
  firmware.transmit(8'000, {0.5F, 0.5F, 0.5F, 0.5F});
  const auto next = link->receive(kLong);
  ASSERT_TRUE(next);
  EXPECT_DOUBLE_EQ(next->throttles[0], 0.5);
  EXPECT_EQ(link->counts().stale, 1);
}

TEST(Px4Link, StopsMotorsWhenDisarmedOrNotFinite) {
  const auto [link, port] = listen_somewhere();
  FakeFirmware firmware(FakeFirmware::connected_to(port));
  ASSERT_TRUE(link->send(sensors_at(Duration{4'000})));
  firmware.transmit(4'000, {0.5F, 0.5F, 0.5F, 0.5F}, false);
  const auto disarmed = link->receive(kLong);
  ASSERT_TRUE(disarmed);
  EXPECT_EQ(disarmed->throttles, Throttles{});

  ASSERT_TRUE(link->send(sensors_at(Duration{8'000})));
  firmware.transmit(8'000, {std::numeric_limits<float>::quiet_NaN(), -0.1F, 7.0F, 1.0F});
  const auto odd = link->receive(kLong);
  ASSERT_TRUE(odd);
  EXPECT_EQ(odd->throttles, (Throttles{0.0, 0.0, 1.0, 1.0}));
}

TEST(Px4Link, AcceptsRestartedFirmware) {
  const auto [link, port] = listen_somewhere();
  FakeFirmware old(FakeFirmware::connected_to(port));
  ASSERT_TRUE(link->send(sensors_at(Duration{4'000})));
  FakeFirmware fresh(FakeFirmware::connected_to(port));  // the old one is stuck but still connected
  ASSERT_TRUE(link->send(sensors_at(Duration{8'000})));
  EXPECT_EQ(fresh.read_reply().time_usec, 8'000U);
  EXPECT_TRUE(old.is_let_go());
  fresh.transmit(8'000, {0.25F, 0.25F, 0.25F, 0.25F});
  EXPECT_TRUE(link->receive(kLong));

  fresh.hang_up();
  EXPECT_EQ(link->receive(kLong), std::nullopt) << "does not wait for a closed connection";
  EXPECT_FALSE(link->send(sensors_at(Duration{12'000})));
  FakeFirmware third(FakeFirmware::connected_to(port));
  EXPECT_TRUE(link->send(sensors_at(Duration{16'000})));
  EXPECT_EQ(third.read_reply().time_usec, 16'000U);
}

// The newest of several connections since the last check is used. The port is released at the end.
TEST(Px4Link, UsesTheNewestMessageAndReleasesItsPort) {
  auto [link, port] = listen_somewhere();
  FakeFirmware first(FakeFirmware::connected_to(port));
  FakeFirmware second(FakeFirmware::connected_to(port));
  FakeFirmware third(FakeFirmware::connected_to(port));
  ASSERT_TRUE(link->send(sensors_at(Duration{4'000})));
  EXPECT_EQ(third.read_reply().time_usec, 4'000U);
  EXPECT_TRUE(first.is_let_go());
  EXPECT_TRUE(second.is_let_go());
  link.reset();
  EXPECT_TRUE(third.is_let_go());
  EXPECT_NO_THROW(Px4Link::listening(port - Px4Link::kPort));
}

TEST(Px4Link, NeverBlocksOnAStalledFirmware) {
  const auto [link, port] = listen_somewhere();
  FakeFirmware firmware(FakeFirmware::connected_to(port));
  std::vector<std::uint64_t> sent_usec;
  constexpr int kSamples = 100'000;  // more than the kernel buffers
  for (int i = 1; i <= kSamples; ++i) {
    const FirmwareSensors sensors = sensors_at(i * link->period());
    if (link->send(sensors)) {
      sent_usec.push_back(static_cast<std::uint64_t>(sensors.since_start.count()));
    }
  }
  const auto sent_count = static_cast<int>(sent_usec.size());
  EXPECT_LT(sent_count, kSamples);
  EXPECT_GE(link->counts().unsent, kSamples - sent_count);
  // The firmware receives complete frames in order; only the last one may be incomplete.
  std::uint64_t last_usec = 0;
  std::vector<std::uint64_t> received_usec;
  for (int i = 0; i < sent_count - 1; ++i) {
    const wire::mavlink::HilSensor received = firmware.read_reply();
    ASSERT_GT(received.time_usec, last_usec);
    last_usec = received.time_usec;
    received_usec.push_back(last_usec);
  }
  const Duration later = (kSamples + 1) * link->period();
  ASSERT_TRUE(link->send(sensors_at(later)));
  sent_usec.push_back(static_cast<std::uint64_t>(later.count()));
  while (last_usec < static_cast<std::uint64_t>(later.count())) {
    const wire::mavlink::HilSensor received = firmware.read_reply();
    ASSERT_GT(received.time_usec, last_usec);
    last_usec = received.time_usec;
    received_usec.push_back(last_usec);
  }
  EXPECT_EQ(received_usec, sent_usec) << "a sample that could not be sent is dropped";
}

TEST(Px4Link, ReportsUnavailablePort) {
  const auto [link, port] = listen_somewhere();
  try {
    Px4Link::listening(port - Px4Link::kPort);
    FAIL();
  } catch (const StartupError& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(port)), std::string::npos);
  }
}

/// The board's end of a serial line, a pseudo terminal.
struct Board {
  Board() : fd(posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_EQ(grantpt(fd), 0);
    EXPECT_EQ(unlockpt(fd), 0);
    device = ptsname(fd);
  }
  int fd;
  std::string device;
};

TEST(Px4Link, SupportsABoardWithASeparateClock) {
  if (test::is_emulated()) {
    GTEST_SKIP() << "qemu's user mode has no pseudo terminals";
  }
  const Board board;
  FakeFirmware firmware(board.fd);
  const auto link = Px4Link::on_serial_line(board.device);
  EXPECT_FALSE(link->is_lockstep());
  ASSERT_TRUE(link->send(sensors_at(Duration{4'000})));
  EXPECT_EQ(firmware.read_reply().time_usec, 4'000U);
  ASSERT_TRUE(link->send(sensors_at(Duration{8'000})));
  firmware.transmit(77, {0.5F, 0.5F, 0.5F, 0.5F});
  const auto command = link->receive(kLong);
  ASSERT_TRUE(command);
  EXPECT_DOUBLE_EQ(command->throttles[0], 0.5);
}

// The number after the last colon is the baud rate; the default is 921600, as in PX4.
TEST(Px4Link, OpensSerialLineAtGivenBaudRate) {
  if (test::is_emulated()) {
    GTEST_SKIP() << "qemu's user mode has no pseudo terminals";
  }
  struct Row {
    std::string behind;
    speed_t speed;
  };
  for (const Row& row : {Row{":57600", B57600}, Row{":115200", B115200}, Row{"", B921600}}) {
    const Board board;
    FakeFirmware firmware(board.fd);
    const auto link = Px4Link::on_serial_line(board.device + row.behind);
    ASSERT_TRUE(link->send(sensors_at(Duration{4'000}))) << row.behind;
    EXPECT_EQ(firmware.read_reply().time_usec, 4'000U);
    termios line{};
    ASSERT_EQ(tcgetattr(board.fd, &line), 0);
    EXPECT_EQ(cfgetospeed(&line), row.speed) << row.behind;
    EXPECT_EQ(cfgetispeed(&line), row.speed) << row.behind;
  }
}

// Opening is tried twice per second, even if send() is called more often. Here the path is a file,
// which is not a serial line.
TEST(Px4Link, RetriesAMissingSerialLineTwicePerSecond) {
  const test::TemporaryFolder folder;
  write_file(folder.file("no_line"), "");
  const int watch = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  ASSERT_GE(inotify_add_watch(watch, folder.file("no_line").c_str(), IN_OPEN | IN_CLOSE), 0);
  const std::int64_t begin_ns = monotonic_ns();
  const auto link = Px4Link::on_serial_line(folder.file("no_line"));
  for (int i = 1; i <= 200; ++i) {
    EXPECT_FALSE(link->send(sensors_at(i * link->period())));
    EXPECT_EQ(link->receive(Duration{0}), std::nullopt);
  }
  const std::int64_t half_seconds = (monotonic_ns() - begin_ns) / 500'000'000;
  std::array<char, 1U << 16U> events{};
  std::int64_t opened = 0;
  std::int64_t closed = 0;
  for (ssize_t got = read(watch, events.data(), events.size()), at = 0; at < got;) {
    inotify_event event{};
    std::memcpy(&event, events.data() + at, sizeof event);
    opened += (event.mask & IN_OPEN) != 0 ? 1 : 0;
    closed += (event.mask & IN_CLOSE) != 0 ? 1 : 0;
    at += static_cast<ssize_t>(sizeof event + event.len);
  }
  close(watch);
  EXPECT_GE(opened, 1);
  EXPECT_LE(opened, 1 + half_seconds);
  EXPECT_EQ(closed, opened);
}

TEST(Px4Link, WaitsForABoardAndRefusesAnInvalidBaudRate) {
  const auto link = Px4Link::on_serial_line("/nowhere/at/all:921600");
  EXPECT_FALSE(link->send(sensors_at(Duration{4'000})));
  EXPECT_EQ(link->receive(kLong), std::nullopt);
  EXPECT_THROW(Px4Link::on_serial_line("/dev/x:12345"), StartupError);
  EXPECT_THROW(Px4Link::on_serial_line("/dev/x:"), StartupError);
}

}  // namespace
}  // namespace vantage::sim
