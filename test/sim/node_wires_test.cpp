// Tests device connections of vantage-sim: system numbers, rates and latencies.

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/convert/channels.hpp"
#include "core/address.hpp"
#include "core/check.hpp"
#include "sim/app/node.hpp"
#include "sim/vehicle_socket.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/bus_pair.hpp"
#include "test/support/udp_port.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/rover/packet.hpp"
#include "wire/vicon/datastream_blocks.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::sim {
namespace {

using test::port_of_this_test;

// Start time, 0.7 s after a whole second.
constexpr Time kStart = from_utime(1'700'000'123'700'000);

/// A clock that reports real time, but advances only when the test sets it.
class StandingClock : public bus::Clock {
 public:
  [[nodiscard]] Time now() const override { return time; }
  [[nodiscard]] bool is_real_time() const override { return true; }
  Time time = kStart;
};

struct Lab {
  explicit Lab(const scenario::Scenario& scenario) : node(net.own, clock, scenario) {}
  void tick_at(Time time) {
    clock.time = time;
    node.tick(time);
    net.other.handle(std::chrono::microseconds(0));
  }
  void run(int ticks) {
    for (int k = 0; k < ticks; ++k) {
      tick_at(node.next_tick());
    }
  }
  [[nodiscard]] std::map<std::string, std::int64_t> counts() const {
    std::map<std::string, std::int64_t> out;
    for (const models::NamedCount& counter : node.counters()) {
      out[counter.name] = counter.count;
    }
    return out;
  }
  StandingClock clock;
  test::BusPair net{11, 22};
  SimNode node;
};

// An autopilot without a configured system id has the index of its robot among all robots as its
// id. The boot number of a rover is the second of its start.
TEST(SimNode, DerivesWireIdsFromIndexAndStart) {
  scenario::Scenario scenario = test::lab_scenario();
  for (const std::size_t i : {1U, 2U}) {
    scenario.robots[i].device = scenario::DeviceSource::kWire;
  }
  scenario.robots[1].rover.emplace();
  scenario.robots[1].rover->url = "udp://127.0.0.1:" + port_of_this_test(0);
  scenario.robots[1].rover->number = 77;
  scenario.robots[2].autopilot.emplace();
  scenario.robots[2].autopilot->url = "udp://127.0.0.1:" + port_of_this_test(1);
  VehicleSocket rovers_driver("udpout://127.0.0.1:" + port_of_this_test(0));
  VehicleSocket autopilots_driver("udpout://127.0.0.1:" + port_of_this_test(1));
  Lab lab(scenario);
  lab.run(20);
  std::vector<wire::rover::Telemetry> telemetry;
  rovers_driver.read_each([&](auto bytes, Time) {
    telemetry.emplace_back();
    EXPECT_EQ(wire::rover::decode(bytes, telemetry.back()), wire::rover::Verdict::kAccepted);
  });
  ASSERT_FALSE(telemetry.empty());
  EXPECT_EQ(telemetry[0].boot, 1'700'000'123U);
  EXPECT_EQ(telemetry[0].robot, 77U);
  std::vector<int> systems;
  wire::mavlink::Parser parser;
  autopilots_driver.read_each([&](auto bytes, Time) {
    parser.feed(bytes, [&](const wire::mavlink::Frame& frame) {
      systems.push_back(frame.origin.system_id);
    });
  });
  ASSERT_FALSE(systems.empty());
  EXPECT_EQ(systems.front(), 3);
  // The node adds the counters of both vehicles.
  EXPECT_TRUE(lab.counts().empty());
  rovers_driver.write(std::vector<std::uint8_t>{1, 2});
  autopilots_driver.write(std::vector<std::uint8_t>{1, 2, 3});
  lab.run(2);
  EXPECT_EQ(lab.counts(), (std::map<std::string, std::int64_t>{{"wire.Q2.refused", 1},
                                                               {"wire.Q3.bytes_skipped", 3}}));
}

// Each frame is sent when its latency has passed, even if that is between two steps of the world.
TEST(SimNode, PublishesFrameAfterItsLatency) {
  for (const int latency_ms : {2, 5, 7, 12, 26}) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.mocap.latency_s = 1e-3 * latency_ms;
    scenario.robots[1].device = scenario::DeviceSource::kWire;
    scenario.robots[1].autopilot.emplace();
    scenario.robots[1].autopilot->url = "udp://127.0.0.1:" + port_of_this_test(2);
    Lab lab(scenario);
    std::vector<Time> captured;
    lab.net.other.subscribe<models::MocapFrame>(bus::kVicon, [&](const models::MocapFrame& frame) {
      captured.push_back(frame.stamp.time);
      EXPECT_EQ(lab.clock.time - frame.stamp.time, Duration{1'000 * latency_ms});
    });
    while (lab.node.next_tick() <= kStart + Duration{210'000}) {
      lab.run(1);
    }
    // Frames are published at 50 Hz from the beginning.
    std::vector<Time> expected;
    for (int k = 0; 20 * k + latency_ms <= 210; ++k) {
      expected.push_back(kStart + Duration{20'000 * k});
    }
    EXPECT_EQ(captured, expected) << latency_ms;
    EXPECT_EQ(lab.node.deadlines_missed(), 0);
  }
}

/// A client of a mocap server on a port of this test.
class Client {
 public:
  explicit Client(const std::string& port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in to = address_of(INADDR_LOOPBACK, std::stoi(port));
    EXPECT_EQ(connect(fd_, as_sockaddr(to), sizeof to), 0);
  }
  ~Client() { close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  Client(Client&&) = delete;
  Client& operator=(Client&&) = delete;
  void transmit(const std::vector<std::uint8_t>& bytes) const {
    ASSERT_EQ(send(fd_, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  }
  std::vector<std::uint8_t> read_reply() const {
    std::vector<std::uint8_t> out;
    std::array<std::uint8_t, 4096> bytes{};
    ssize_t got = 0;
    while ((got = recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0) {
      out.insert(out.end(), bytes.begin(), bytes.begin() + got);
    }
    return out;
  }

 private:
  int fd_;
};

scenario::Scenario lab_of(scenario::MocapProtocol protocol, const std::string& port) {
  scenario::Scenario out = test::lab_scenario();
  out.mocap.device = scenario::DeviceSource::kWire;
  out.mocap.protocol = protocol;
  out.mocap.port = std::stoi(port);
  out.mocap.rate_hz = 80.0;
  out.mocap.latency_s = 0.004;
  return out;
}

/// Runs up to the tick that sends the next frame; returns its capture time.
Time run_up_to_a_frame(Lab& lab) {
  while (to_utime(lab.node.next_tick()) % 12'500 != 4'000) {
    lab.run(1);
  }
  return lab.node.next_tick() - Duration{4'000};
}

// A frame that is sent 3 ms late reports its real latency.
TEST(SimNode, ReportsRealStreamRateAndLatency) {
  namespace vicon = wire::vicon;
  const std::string port = port_of_this_test(3);
  Lab lab(lab_of(scenario::MocapProtocol::kDataStream, port));
  lab.run(2);
  const Client client(port);
  lab.run(2);
  std::vector<std::uint8_t> request;
  vicon::PacketWriter packet(request);
  append(packet,
         vicon::ObjectEnums{{vicon::kStreamInfo, vicon::kFrameRateInfo, vicon::kLatencyInfo}});
  append(packet, vicon::RequestFrame{true});
  packet.finish();
  client.transmit(request);
  lab.run(1);
  client.read_reply();  // reads the server's greeting
  const Time capture = run_up_to_a_frame(lab);
  lab.tick_at(capture + Duration{7'000});
  const std::vector<std::uint8_t> received = client.read_reply();
  const vicon::Framed framed = vicon::next_packet(received);
  ASSERT_EQ(framed.state, vicon::Framing::kWhole);
  EXPECT_EQ(framed.bytes, received.size()) << "one frame";
  std::map<std::uint32_t, vicon::Bytes> blocks;
  vicon::BlockCursor cursor(framed.body);
  while (const auto block = cursor.next()) {
    blocks[block->type] = block->body;
  }
  vicon::FrameInfo number;
  ASSERT_TRUE(decode(blocks[vicon::kFrameInfo], number));
  EXPECT_EQ(number.frame_number, static_cast<std::uint32_t>(to_utime(capture) / 12'500));
  vicon::FrameRateInfo rates;
  ASSERT_TRUE(decode(blocks[vicon::kFrameRateInfo], rates));
  EXPECT_EQ(rates.rates.at(0).rate_hz, 80.0);
  vicon::LatencyInfo latency;
  ASSERT_TRUE(decode(blocks[vicon::kLatencyInfo], latency));
  EXPECT_NEAR(latency.total_s(), 0.007, 1e-9);
  EXPECT_EQ(lab.node.deadlines_missed(), 0);
}

TEST(SimNode, StampsVrpnWithTheCaptureTime) {
  namespace vicon = wire::vicon;
  const std::string port = port_of_this_test(3);
  Lab lab(lab_of(scenario::MocapProtocol::kVrpn, port));
  lab.run(2);
  const Client client(port);
  std::vector<std::uint8_t> cookie;
  vicon::append_vrpn_cookie(cookie);
  client.transmit(cookie);
  lab.run(3);
  const Time capture = run_up_to_a_frame(lab);
  client.read_reply();
  lab.run(1);
  const std::vector<std::uint8_t> received = client.read_reply();
  vicon::Bytes left(received);
  int poses = 0;
  while (!left.empty()) {
    vicon::VrpnHeader header;
    const vicon::Framed framed = vicon::next_vrpn_message(left, header);
    ASSERT_EQ(framed.state, vicon::Framing::kWhole);
    left = left.subspan(framed.bytes);
    if (header.type < 0) {
      continue;  // defines a name
    }
    ++poses;
    EXPECT_EQ(1'000'000 * std::int64_t{header.seconds} + header.microseconds, to_utime(capture));
  }
  EXPECT_EQ(poses, 8);
}

}  // namespace
}  // namespace vantage::sim
