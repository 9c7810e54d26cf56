// Tests the data that clients receive over sockets from the emulated server and its program. The
// limits on times are so wide that a busy machine cannot violate them.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/node/clock.hpp"
#include "core/address.hpp"
#include "core/deadline.hpp"
#include "sim/vicon/app/emulator.hpp"
#include "sim/vicon/socket_server.hpp"
#include "test/support/udp_port.hpp"
#include "wire/vicon/datastream_blocks.hpp"
#include "wire/vicon/object_stream.hpp"
#include "wire/vicon/rotation.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::sim::vicon {
namespace {

namespace wire = vantage::wire::vicon;
using Bytes = std::vector<std::uint8_t>;

/// A socket on this host.
class Socket {
 public:
  explicit Socket(int type) : fd(socket(AF_INET, type | SOCK_CLOEXEC, 0)) {}
  ~Socket() { close(fd); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  Socket(Socket&&) = delete;
  Socket& operator=(Socket&&) = delete;
  [[nodiscard]] bool connect_to(int port) const {
    const sockaddr_in address = address_of(INADDR_LOOPBACK, port);
    return connect(fd, as_sockaddr(address), sizeof address) == 0;
  }
  void send_all(const Bytes& bytes) const {
    ASSERT_EQ(send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Appends the bytes that have arrived. Without MSG_DONTWAIT, appends all bytes until the other
  /// end closes.
  void append_received(Bytes& out, int flags) const {
    std::array<std::uint8_t, 65'536> bytes{};
    ssize_t got = 0;
    while ((got = recv(fd, bytes.data(), bytes.size(), flags)) > 0) {
      out.insert(out.end(), bytes.begin(), bytes.begin() + got);
    }
  }
  const int fd;
};

// Each client receives each frame, or the frame is counted as skipped for this client. The counters
// may be read at any time.
TEST(SocketServer, CountsSkippedFramesPerClient) {
  ServerSettings settings;
  settings.backlog_bytes_max = 200'000;
  SocketServer server(settings, "127.0.0.1", 0);
  const Socket idle(SOCK_STREAM);
  const Socket reader(SOCK_STREAM);
  Bytes request;
  wire::PacketWriter packet(request);
  append(packet, wire::ObjectEnums{{wire::kGlobalSegments}});
  append(packet, wire::RequestFrame{true});
  packet.finish();
  for (const Socket* client : {&idle, &reader}) {
    ASSERT_TRUE(client->connect_to(server.port()));
    client->send_all(request);
  }
  server.wait(std::chrono::nanoseconds(0));  // connects the clients
  server.wait(std::chrono::nanoseconds(0));  // receives the requests of the clients
  ASSERT_EQ(server.clients(), 2u);
  EmulatedFrame frame;
  for (int i = 0; i < 200; ++i) {
    frame.bodies.push_back({"B" + std::to_string(i), {}, false});
  }
  Bytes of_idle;
  Bytes of_reader;
  std::int64_t published = 0;
  while (server.frames_skipped() < 20 && published < 20'000) {
    frame.number = static_cast<std::uint32_t>(++published);
    server.publish(frame);
    reader.append_received(of_reader, MSG_DONTWAIT);
  }
  EXPECT_GE(server.frames_skipped(), 20);
  const auto frames_in = [](const Bytes& bytes) {
    std::int64_t frames = -1;  // −1: the first packet is the greeting
    for (wire::Bytes left(bytes); !left.empty(); ++frames) {
      const wire::Framed framed = wire::next_packet(left);
      if (framed.state != wire::Framing::kWhole) {
        break;
      }
      left = left.subspan(framed.bytes);
    }
    return frames;
  };
  constexpr std::int64_t kPatienceNs = 20'000'000'000;
  const std::int64_t begin_ns = monotonic_ns();
  std::int64_t accounted = 0;
  while (accounted != 2 * published && monotonic_ns() - begin_ns < kPatienceNs) {
    server.wait(std::chrono::nanoseconds(0));
    idle.append_received(of_idle, MSG_DONTWAIT);
    reader.append_received(of_reader, MSG_DONTWAIT);
    accounted = frames_in(of_idle) + frames_in(of_reader) + server.frames_skipped();
  }
  EXPECT_EQ(accounted, 2 * published);
  EXPECT_EQ(server.send_errors(), 0);
}

int run(std::vector<std::string> words) {
  words.insert(words.begin(), "vantage-vicon-emulator");
  std::vector<char*> argv;
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  return run_emulator(static_cast<int>(argv.size()), argv.data());
}

/// Returns the headers of the poses in the bytes of a VRPN server.
std::vector<wire::VrpnHeader> poses_in(const Bytes& received) {
  std::vector<wire::VrpnHeader> out;
  if (received.size() < wire::kVrpnCookieBytes) {
    return out;
  }
  wire::Bytes left = wire::Bytes(received).subspan(wire::kVrpnCookieBytes);
  while (!left.empty()) {
    wire::VrpnHeader header;
    const wire::Framed framed = wire::next_vrpn_message(left, header);
    if (framed.state != wire::Framing::kWhole) {
      break;
    }
    if (header.type >= 0) {  // messages with other types define names
      out.push_back(header);
    }
    left = left.subspan(framed.bytes);
  }
  return out;
}

// With a latency of a second, each frame was captured at least a second before its arrival. The
// program runs for the given duration.
TEST(RunEmulator, CaptureTimesIncludeLatency) {
  const std::string port = test::port_of_this_test(0);
  const bus::SystemClock clock;
  std::vector<wire::VrpnHeader> poses;
  Time begin{};
  Time end{};
  for (int attempt = 0; attempt < 50 && poses.empty(); ++attempt) {
    begin = clock.now();
    const std::int64_t begin_ns = monotonic_ns();
    std::atomic<bool> is_over{false};
    std::atomic<int> result{-1};
    std::thread program([&] {
      result = run({"--protocol", "vrpn", "--host", "127.0.0.1", "--port", port, "--bodies", "2",
                    "--rate", "200", "--latency-s", "1", "--duration-s", "0.06"});
      is_over = true;
    });
    Bytes received;
    while (!is_over) {
      const Socket client(SOCK_STREAM);
      if (client.connect_to(std::stoi(port))) {
        Bytes cookie;
        wire::append_vrpn_cookie(cookie);
        send(client.fd, cookie.data(), cookie.size(), MSG_NOSIGNAL);
        client.append_received(received, 0);
        break;
      }
      std::this_thread::yield();
    }
    program.join();
    end = clock.now();
    EXPECT_EQ(result, 0);
    EXPECT_GE(monotonic_ns() - begin_ns, 60'000'000);
    poses = poses_in(received);
  }
  ASSERT_FALSE(poses.empty());
  EXPECT_EQ(poses.size() % 2, 0u) << "of two bodies each";
  std::int64_t last_us = to_utime(begin) - 1'000'000;
  for (const wire::VrpnHeader& header : poses) {
    const std::int64_t stamp_us = 1'000'000 * std::int64_t{header.seconds} + header.microseconds;
    EXPECT_GE(stamp_us, last_us);
    last_us = stamp_us;
  }
  EXPECT_LE(last_us, to_utime(end) - 1'000'000);
}

// The program uses the configured up axis and datagram size.
TEST(RunEmulator, SendsTheConfiguredAxisAndBytes) {
  for (const std::string& up : {std::string("z"), std::string("y")}) {
    for (const std::size_t bytes : {256U, 1'024U}) {
      const Socket receiver(SOCK_DGRAM);
      sockaddr_in address = address_of(INADDR_LOOPBACK, 0);
      socklen_t size = sizeof address;
      ASSERT_EQ(bind(receiver.fd, as_sockaddr(address), size), 0);
      ASSERT_EQ(getsockname(receiver.fd, reinterpret_cast<sockaddr*>(&address), &size), 0);
      EXPECT_EQ(run({"--protocol", "object_stream", "--port",
                     std::to_string(ntohs(address.sin_port)), "--bodies", "1", "--rate", "500",
                     "--duration-s", "0.001", "--up", up, "--block-bytes", std::to_string(bytes)}),
                0);
      Bytes datagram;
      receiver.append_received(datagram, MSG_DONTWAIT);
      EXPECT_EQ(datagram.size(), bytes);
      wire::ObjectBlock block;
      ASSERT_TRUE(wire::decode_object_block(datagram, block));
      ASSERT_EQ(block.objects.size(), 1u);
      Pose3 pose{1e-3 * block.objects[0].translation_mm,
                 wire::rotation_from_euler_xyz(block.objects[0].euler_xyz_rad)};
      EXPECT_EQ(block.objects[0].translation_mm.z() > 999.0, up == "z");
      pose = up == "y" ? wire::z_up_from_y_up(pose) : pose;
      EXPECT_LT((pose.translation_m - Eigen::Vector3d(0.5, 0.0, 1.0)).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace vantage::sim::vicon
