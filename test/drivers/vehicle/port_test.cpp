#include "drivers/vehicle/port.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "core/check.hpp"
#include "test/support/emulation.hpp"
#include "test/support/free_port.hpp"

namespace vantage::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr Time kNow = from_utime(1'700'000'000'000'000);

/// A plain UDP socket on the loopback with a port chosen by the kernel.
class Socket {
 public:
  Socket() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = loopback(0);
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~Socket() { close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  Socket(Socket&&) = delete;
  Socket& operator=(Socket&&) = delete;

  int port() const { return port_; }
  void send(const Bytes& bytes, int to) const {
    const sockaddr_in address = loopback(to);
    ASSERT_EQ(sendto(fd_, bytes.data(), bytes.size(), 0,
                     reinterpret_cast<const sockaddr*>(&address), sizeof address),
              static_cast<ssize_t>(bytes.size()));
  }
  Bytes receive() const {
    pollfd waiting{fd_, POLLIN, 0};
    if (poll(&waiting, 1, 2000) != 1) {
      return {};
    }
    Bytes bytes(2048);
    bytes.resize(static_cast<std::size_t>(recv(fd_, bytes.data(), bytes.size(), 0)));
    return bytes;
  }

 private:
  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    return address;
  }
  int fd_;
  int port_ = 0;
};

Bytes read_all(Port& port, Time now) {
  Bytes bytes(2048);
  bytes.resize(port.read(bytes, now));
  return bytes;
}

TEST(UdpPort, RepliesToTheAcceptedSender) {
  const int number = test::free_port();
  const auto port = open_port("udp://127.0.0.1:" + std::to_string(number));
  EXPECT_TRUE(port->is_datagram());
  port->write(Bytes{1}, kNow);  // lost, because the port has no recipient yet
  const Socket vehicle;
  vehicle.send({1, 2, 3}, number);
  EXPECT_EQ(read_all(*port, kNow), (Bytes{1, 2, 3}));
  port->write(Bytes{6}, kNow);  // no reply, because no sender is accepted yet
  port->accept(kNow);
  EXPECT_TRUE(read_all(*port, kNow).empty());
  port->write(Bytes{7, 8}, kNow);
  EXPECT_EQ(vehicle.receive(), (Bytes{7, 8}));
}

// Another sender that sends first and continues must not prevent the connection to the vehicle.
TEST(UdpPort, ReceivesFromAllSendersUntilOneIsAccepted) {
  const int number = test::free_port();
  const auto port = open_port("udp://127.0.0.1:" + std::to_string(number));
  const Socket stranger;
  const Socket vehicle;
  for (int second = 0; second < 5; ++second) {
    stranger.send({2}, number);
    EXPECT_EQ(read_all(*port, kNow + std::chrono::seconds(second)), Bytes{2});
  }
  vehicle.send({1}, number);
  EXPECT_EQ(read_all(*port, kNow + std::chrono::seconds(5)), Bytes{1});
  port->accept(kNow + std::chrono::seconds(5));
  port->write(Bytes{9}, kNow);
  EXPECT_EQ(vehicle.receive(), Bytes{9});
}

TEST(UdpPort, ReceivesOnlyFromTheAcceptedSender) {
  const int number = test::free_port();
  const auto port = open_port("udp://127.0.0.1:" + std::to_string(number));
  const Socket vehicle;
  const Socket other;
  vehicle.send({1}, number);
  EXPECT_EQ(read_all(*port, kNow), Bytes{1});
  other.send({2}, number);  // is queued in the socket when the vehicle is accepted
  port->accept(kNow);
  EXPECT_TRUE(read_all(*port, kNow + std::chrono::seconds(1)).empty());
  ASSERT_EQ(port->counters().size(), 1U);
  EXPECT_EQ(port->counters()[0].name, "port.strangers");
  other.send({3}, number);  // dropped by the kernel
  EXPECT_TRUE(read_all(*port, kNow + std::chrono::seconds(2)).empty());
  EXPECT_TRUE(read_all(*port, kNow + std::chrono::seconds(4)).empty());
  other.send({4}, number);
  EXPECT_EQ(read_all(*port, kNow + std::chrono::seconds(4)), Bytes{4});
  port->accept(kNow + std::chrono::seconds(4));
  port->write(Bytes{9}, kNow);
  EXPECT_EQ(other.receive(), Bytes{9});
}

TEST(UdpPort, SendsFirstWhenConfigured) {
  const Socket vehicle;
  const auto port = open_port("udpout://127.0.0.1:" + std::to_string(vehicle.port()));
  port->write(Bytes{4, 5}, kNow);
  EXPECT_EQ(vehicle.receive(), (Bytes{4, 5}));
}

/// The other end of a serial line, emulated by a pseudo terminal.
class Line {
 public:
  Line() : fd_(posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_EQ(grantpt(fd_), 0);
    EXPECT_EQ(unlockpt(fd_), 0);
    name = ptsname(fd_);
  }
  ~Line() { hang_up(); }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  Line(Line&&) = delete;
  Line& operator=(Line&&) = delete;

  void send(const Bytes& bytes) const {
    ASSERT_EQ(write(fd_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  Bytes receive(std::size_t count) const {
    Bytes out;
    while (out.size() < count) {
      pollfd waiting{fd_, POLLIN, 0};
      if (poll(&waiting, 1, 2000) != 1) {
        break;
      }
      std::array<std::uint8_t, 256> some{};
      const ssize_t got = read(fd_, some.data(), some.size());
      if (got <= 0) {
        break;
      }
      out.insert(out.end(), some.begin(), some.begin() + got);
    }
    return out;
  }
  void hang_up() {
    if (fd_ >= 0) {
      close(fd_);
    }
    fd_ = -1;
  }

  std::string name;

 private:
  int fd_;
};

TEST(SerialPort, TransmitsEveryByteUnchanged) {
  if (test::is_emulated()) {
    GTEST_SKIP() << "qemu's user mode has no pseudo terminals";
  }
  const Line line;
  const auto port = open_port("serial:" + line.name + ":921600");
  EXPECT_FALSE(port->is_datagram());
  EXPECT_TRUE(read_all(*port, kNow).empty());
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = static_cast<std::uint8_t>(i);
  }
  port->write(all, kNow);
  EXPECT_EQ(line.receive(all.size()), all);
  line.send(all);
  EXPECT_EQ(read_all(*port, kNow), all);
}

TEST(SerialPort, WaitsForAMissingDevice) {
  const auto port = open_port("serial:/nowhere/at/all");
  EXPECT_TRUE(read_all(*port, kNow).empty());
  port->write(Bytes{1}, kNow);
  EXPECT_EQ(port->counters()[0].name, "port.messages_dropped");
}

TEST(SerialPort, DropsQueuedMessagesWhenTheLineIsCut) {
  if (test::is_emulated()) {
    GTEST_SKIP() << "qemu's user mode has no pseudo terminals";
  }
  Line line;
  const auto port = open_port("serial:" + line.name + ":230400");
  EXPECT_TRUE(read_all(*port, kNow).empty());
  line.hang_up();
  for (int i = 0; i < 3; ++i) {
    port->write(Bytes{1, 2, 3}, kNow);
    EXPECT_TRUE(read_all(*port, kNow).empty());
  }
  const auto counters = port->counters();
  ASSERT_FALSE(counters.empty());
  EXPECT_EQ(counters.back().name, "port.losses");
}

// While a line is blocked, only complete messages are dropped, the oldest first.
TEST(SerialPort, DropsTheOldestWholeMessages) {
  if (test::is_emulated()) {
    GTEST_SKIP() << "qemu's user mode has no pseudo terminals";
  }
  constexpr std::size_t kBytes = 90;
  constexpr int kMessages = 400;
  const Line line;
  const auto port = open_port("serial:" + line.name);
  for (int i = 0; i < kMessages; ++i) {
    Bytes message(kBytes, static_cast<std::uint8_t>(i % 256));
    message[0] = 255;
    message[1] = static_cast<std::uint8_t>(i / 256);
    port->write(message, kNow);
  }
  const auto counters = port->counters();
  ASSERT_EQ(counters.size(), 1U);
  EXPECT_EQ(counters[0].name, "port.messages_dropped");
  const auto sent = static_cast<std::size_t>(kMessages - counters[0].count);
  Bytes received;
  for (int i = 0; i < 100 && received.size() < sent * kBytes; ++i) {
    const Bytes some = line.receive(std::min<std::size_t>(2000, sent * kBytes - received.size()));
    received.insert(received.end(), some.begin(), some.end());
    port->write({}, kNow);  // continues to send the queued messages
  }
  ASSERT_EQ(received.size(), sent * kBytes);
  std::vector<int> numbers;
  for (std::size_t at = 0; at < received.size(); at += kBytes) {
    ASSERT_EQ(received[at], 255);
    numbers.push_back(256 * received[at + 1] + received[at + 2]);
    for (std::size_t k = 2; k < kBytes; ++k) {
      ASSERT_EQ(received[at + k], received[at + 2]);
    }
  }
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  EXPECT_EQ(numbers.back(), kMessages - 1);
  EXPECT_GT(counters[0].count, 100);
}

TEST(SerialPort, RefusesSlowBaudRates) {
  for (const char* const baud : {"9600", "57600", "115200"}) {
    EXPECT_THROW(static_cast<void>(open_port(std::string("serial:/dev/x:") + baud)), StartupError);
  }
  for (const char* const baud : {"230400", "460800", "921600"}) {
    EXPECT_NO_THROW(static_cast<void>(open_port(std::string("serial:/dev/x:") + baud)));
  }
}

TEST(OpenPort, RefusesInvalidUrls) {
  for (const char* const url :
       {"", "tcp://a:1", "udp://127.0.0.1", "udp://:0", "udp://:65536", "udp://:12x", "udpout://:1",
        "serial:/dev/x:fast", "serial:/dev/x:12345"}) {
    EXPECT_THROW(static_cast<void>(open_port(url)), StartupError) << url;
  }
}

}  // namespace
}  // namespace vantage::drivers
