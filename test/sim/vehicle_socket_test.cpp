#include "sim/vehicle_socket.hpp"

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "test/support/free_port.hpp"

namespace vantage::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A datagram socket on this host with its own port.
class Port {
 public:
  Port() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = address_of(INADDR_LOOPBACK, 0);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(fd_, as_sockaddr(address), size), 0);
    EXPECT_EQ(getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    number = ntohs(address.sin_port);
  }
  ~Port() { close(fd_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  Port(Port&&) = delete;
  Port& operator=(Port&&) = delete;
  void send_to(int port, const Bytes& bytes) const {
    const sockaddr_in to = address_of(INADDR_LOOPBACK, port);
    EXPECT_EQ(sendto(fd_, bytes.data(), bytes.size(), 0, as_sockaddr(to), sizeof to),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Returns the next received datagram; empty if there is none.
  [[nodiscard]] Bytes receive_next() {
    Bytes out(4096);
    socklen_t size = sizeof from;
    const ssize_t got = recvfrom(fd_, out.data(), out.size(), MSG_DONTWAIT,
                                 reinterpret_cast<sockaddr*>(&from), &size);
    out.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return out;
  }
  int number = 0;
  sockaddr_in from{};  ///< sender of the newest datagram

 private:
  int fd_;
};

std::vector<Bytes> read_all(VehicleSocket& socket) {
  std::vector<Bytes> out;
  socket.read_each([&](auto bytes, Time) { out.emplace_back(bytes.begin(), bytes.end()); });
  return out;
}

TEST(VehicleSocket, AnswersTheLastSender) {
  for (const char* host : {"127.0.0.1", "0.0.0.0"}) {
    const int port = test::free_port();
    VehicleSocket vehicle("udpout://" + std::string(host) + ":" + std::to_string(port));
    vehicle.write(Bytes{1});  // lost, because the socket has no recipient yet
    EXPECT_EQ(vehicle.send_errors(), 0);
    Port first;
    Port second;
    first.send_to(port, {1, 2, 3});
    second.send_to(port, {4});
    EXPECT_EQ(read_all(vehicle), (std::vector<Bytes>{{1, 2, 3}, {4}}));
    vehicle.write(Bytes{7, 8});
    EXPECT_EQ(second.receive_next(), (Bytes{7, 8}));
    EXPECT_EQ(ntohs(second.from.sin_port), port);
    EXPECT_TRUE(first.receive_next().empty());
    first.send_to(port, {5});
    EXPECT_EQ(read_all(vehicle), std::vector<Bytes>{{5}});
    vehicle.write(Bytes{9});
    EXPECT_EQ(first.receive_next(), Bytes{9});
    EXPECT_TRUE(read_all(vehicle).empty());
  }
}

TEST(VehicleSocket, SendsFirstInUdpoutMode) {
  for (const char* host : {"127.0.0.1", "", "0.0.0.0"}) {
    Port driver;
    VehicleSocket vehicle("udp://" + std::string(host) + ":" + std::to_string(driver.number));
    vehicle.write(Bytes{1, 2});
    EXPECT_EQ(driver.receive_next(), (Bytes{1, 2})) << host;
    driver.send_to(ntohs(driver.from.sin_port), {3});
    EXPECT_EQ(read_all(vehicle), std::vector<Bytes>{{3}});
  }
}

TEST(VehicleSocket, SkipsEmptyDatagramsAndReadsAFloodInParts) {
  const int port = test::free_port();
  VehicleSocket vehicle("udpout://127.0.0.1:" + std::to_string(port));
  Port driver;
  for (std::uint8_t k = 0; k < 100; ++k) {
    driver.send_to(port, {});
    driver.send_to(port, {k});
  }
  std::vector<Bytes> received = read_all(vehicle);
  ASSERT_EQ(received.size(), 64u);
  EXPECT_EQ(received.back(), Bytes{63});
  received = read_all(vehicle);
  ASSERT_EQ(received.size(), 36u);
  EXPECT_EQ(received.front(), Bytes{64});
}

// The kernel's time stamp lies between the clock readings before sending and after reading.
TEST(VehicleSocket, ReportsArrivalTime) {
  const auto clock_us = [] {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return now.tv_sec * 1'000'000 + now.tv_nsec / 1'000;
  };
  const int port = test::free_port();
  VehicleSocket vehicle("udpout://127.0.0.1:" + std::to_string(port));
  Port driver;
  const std::int64_t before_us = clock_us();
  driver.send_to(port, {1});
  int received = 0;
  vehicle.read_each([&](auto, Time arrival) {
    ++received;
    EXPECT_GE(to_utime(arrival), before_us);
    EXPECT_LE(to_utime(arrival), clock_us());
  });
  EXPECT_EQ(received, 1);
}

TEST(VehicleSocket, CountsSendErrorsButNotAClosedPort) {
  VehicleSocket vehicle("udp://127.0.0.1:" + std::to_string(test::free_port()));
  for (int k = 0; k < 3; ++k) {
    vehicle.write(Bytes{1});  // refused; the next call reports the error
  }
  EXPECT_TRUE(read_all(vehicle).empty());
  EXPECT_EQ(vehicle.send_errors(), 0);
  vehicle.write(Bytes(70'000, 0));  // longer than the maximum of a datagram
  vehicle.write(Bytes(70'000, 0));
  EXPECT_EQ(vehicle.send_errors(), 2);
}

TEST(VehicleSocket, ReportsWhyItCannotOpen) {
  const auto why = [](const std::string& url) {
    try {
      const VehicleSocket socket(url);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(why("serial:/dev/ttyUSB0"),
            "vehicle 'serial:/dev/ttyUSB0': a simulated vehicle needs a udp:// or udpout:// url");
  EXPECT_NE(why("udp:/127.0.0.1:1"), "");
  EXPECT_EQ(why("udp://127.0.0.1:x").rfind("udp://127.0.0.1:x: ", 0), 0u);
  EXPECT_EQ(why("udpout://127.0.0.1").rfind("udpout://127.0.0.1: ", 0), 0u);
  const Port taken;
  const std::string url = "udpout://127.0.0.1:" + std::to_string(taken.number);
  EXPECT_EQ(why(url), url + ": Address already in use");
}

}  // namespace
}  // namespace vantage::sim
