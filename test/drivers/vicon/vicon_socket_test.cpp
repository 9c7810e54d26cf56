#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/convert/channels.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "drivers/vicon/app/node.hpp"
#include "sim/vicon/recorded_flight.hpp"
#include "sim/vicon/socket_server.hpp"
#include "test/drivers/vicon/vicon_bench.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/free_port.hpp"
#include "wire/vicon/vrpn.hpp"

// Tests the node with the emulated server on real loopback sockets. The result does not depend on
// the speed of the machine, because each step waits for its condition.

namespace vantage::drivers {
namespace {

using scenario::MocapProtocol;
using sim::vicon::EmulatedFrame;
using sim::vicon::SocketServer;

constexpr std::int64_t kTimeLimit_ns = 60'000'000'000;  // time limit of a wait

struct SocketBench {
  explicit SocketBench(MocapProtocol protocol, const std::string& host = "127.0.0.1") {
    scenario.mocap.host = host;
    scenario.mocap.device = scenario::DeviceSource::kReal;
    scenario.mocap.protocol = protocol;
    scenario.mocap.rate_hz = 100.0;
    scenario.mocap.port = test::free_port();
    settings = test::ViconBench::settings_for(scenario.mocap);
    start_server();
    listener.subscribe<models::MocapFrame>(
        bus::kVicon, [this](const models::MocapFrame& frame) { frames.push_back(frame); });
    node = std::make_unique<ViconNode>(
        bus, clock, scenario, test::any_session_row(protocol),
        [this](const std::string& status) { statuses.push_back(status); });
  }

  void start_server() {
    server = std::make_unique<SocketServer>(settings, "127.0.0.1", scenario.mocap.port);
  }

  /// Runs both sides until `is_done` is true, at most for kTimeLimit_ns; returns false on time-out.
  template <class IsDone>
  bool until(const IsDone& is_done) {
    const std::int64_t end_ns = monotonic_ns() + kTimeLimit_ns;
    while (!is_done()) {
      if (monotonic_ns() > end_ns) {
        return false;
      }
      if (server) {
        server->wait(std::chrono::microseconds(100));
      }
      node->tick(clock.now());
      listener.handle(std::chrono::microseconds(0));
    }
    return true;
  }

  /// Sends frames until one arrives, so that no later frame is lost.
  void warm_up() {
    ASSERT_TRUE(until([&] {
      if (frames.empty()) {
        server->publish(next(7));
      }
      return !frames.empty();
    })) << node->driver().status();
    // Receives and discards the frames that are still in transit.
    const std::int64_t last = number - 1;
    ASSERT_TRUE(until([&] {
      return scenario.mocap.protocol == MocapProtocol::kVrpn ||
             frames.back().frame_number == last || node->driver().frame_counts().frames == 0;
    }));
    frames.clear();
  }

  EmulatedFrame next(int bodies) {
    EmulatedFrame frame = test::circling(bodies, 0.01 * static_cast<double>(number));
    frame.number = number++;
    return frame;
  }

  scenario::Scenario scenario = test::lab_scenario();
  sim::vicon::ServerSettings settings;
  bus::InProcessHub hub;
  bus::SystemClock clock;
  std::unique_ptr<bus::Transport> node_side = hub.connect();
  std::unique_ptr<bus::Transport> other_side = hub.connect();
  bus::Bus bus{*node_side, 11};
  bus::Bus listener{*other_side, 22};
  std::unique_ptr<SocketServer> server;
  std::unique_ptr<ViconNode> node;
  std::vector<models::MocapFrame> frames;
  std::vector<std::string> statuses;
  std::uint32_t number = 0;
};

/// Resolution of the numbers of a protocol.
struct Resolution {
  double position_m = 0.0;
  double angle_rad = 0.0;
};

Resolution resolution_of(MocapProtocol protocol) {
  const bool has_floats = protocol.driver() != std::string("vicon");  // coordinates up to 16 m
  return has_floats ? Resolution{2e-6, 2e-6} : Resolution{1e-9, 1e-7};
}

class ViconSocket : public ::testing::TestWithParam<MocapProtocol> {};

TEST_P(ViconSocket, CarriesRecordedFlightsWithoutLoss) {
  std::vector<sim::vicon::RecordedFlight> flights;
  for (const char* name : {"v1_01", "v1_02", "v1_03"}) {
    try {
      flights.push_back(sim::vicon::read_flight(std::string(VANTAGE_DATA_DIR) + "/vicon_flights/" +
                                                name + ".csv"));
    } catch (const StartupError&) {
      GTEST_SKIP() << "recorded flights are not on this machine";
    }
  }
  SocketBench bench(GetParam());
  bench.warm_up();
  double worst_m = 0.0;
  double worst_rad = 0.0;
  // Each frame must arrive before the next is sent, so only 15 s of flight are used.
  for (std::size_t k = 0; k < 1500; ++k) {
    EmulatedFrame frame;
    // The server clock advances by 10 ms per frame, at any real sending rate.
    frame.captured = test::ViconBench::kEpoch + 10'000 * Duration{bench.number};
    frame.number = bench.number++;
    for (const auto& flight : flights) {
      frame.bodies.push_back({flight.name, flight.world_from_body[k], false});
    }
    const std::size_t before = bench.frames.size();
    bench.server->publish(frame);
    ASSERT_TRUE(bench.until([&] { return bench.frames.size() > before; })) << k;
    if (k == 0 && bench.frames.back().find("v1_03") == nullptr) {
      continue;  // a frame with new bodies may arrive in parts
    }
    for (const auto& body : frame.bodies) {
      const models::MocapBody* found = bench.frames.back().find(body.name);
      ASSERT_TRUE(found != nullptr && !found->occluded) << body.name << " at " << k;
      worst_m = std::max(
          worst_m,
          (found->world_from_body.translation_m - body.world_from_body.translation_m).norm());
      worst_rad =
          std::max(worst_rad,
                   found->world_from_body.rotation.angularDistance(body.world_from_body.rotation));
    }
  }
  EXPECT_LT(worst_m, resolution_of(GetParam()).position_m);
  EXPECT_LT(worst_rad, resolution_of(GetParam()).angle_rad);
  EXPECT_EQ(bench.node->driver().frame_counts().frames_lost, 0);
  EXPECT_EQ(bench.listener.messages_lost(), 0);
}

// Datagrams from a sender other than the configured one are ignored.
TEST(ViconObjectStream, AcceptsOnlyTheConfiguredSender) {
  const auto counted = [](const SocketBench& bench) {
    const auto counters = bench.node->counters();
    const auto found = std::find_if(counters.begin(), counters.end(), [](const auto& counter) {
      return counter.name == "vicon.strangers";
    });
    return found == counters.end() ? 0 : found->count;
  };
  SocketBench other(MocapProtocol::kObjectStream, "127.0.0.2");
  ASSERT_TRUE(other.until([&] {
    other.server->publish(other.next(7));
    return counted(other) > 20;
  }));
  EXPECT_TRUE(other.frames.empty());
  SocketBench named(MocapProtocol::kObjectStream, "localhost");
  named.warm_up();
  EXPECT_EQ(counted(named), 0);
}

TEST_P(ViconSocket, ReconnectsAfterAServerRestart) {
  SocketBench bench(GetParam());
  for (int life = 0; life < 3; ++life) {
    bench.warm_up();
    const std::size_t before = bench.frames.size();
    for (int k = 0; k < 20; ++k) {
      const std::size_t had = bench.frames.size();
      bench.server->publish(bench.next(7));
      ASSERT_TRUE(bench.until([&] { return bench.frames.size() > had; }));
    }
    EXPECT_EQ(bench.frames.size() - before, 20u);
    EXPECT_EQ(bench.frames.back().bodies.size(), 7u);
    bench.server.reset();
    if (GetParam().transport() == scenario::MocapTransport::kTcp) {
      ASSERT_TRUE(bench.until([&] { return !bench.node->driver().is_open(); }));
    }
    bench.frames.clear();
    bench.number = 0;
    bench.start_server();
  }
  EXPECT_EQ(bench.node->driver().link_counts().connections_lost,
            GetParam().transport() == scenario::MocapTransport::kTcp ? 3 : 0);
}

INSTANTIATE_TEST_SUITE_P(Protocols, ViconSocket,
                         testing::Values(MocapProtocol::kDataStream, MocapProtocol::kObjectStream,
                                         MocapProtocol::kVrpn, MocapProtocol::kNatNet,
                                         MocapProtocol::kQtm),
                         [](const auto& protocol) { return std::string(protocol.param.name()); });

// A multicast server answers requests but sends frames only to its group.
TEST(NatNetSocket, ReceivesTheServersMulticastGroup) {
  SocketBench bench(MocapProtocol::kNatNet);
  bench.settings.is_multicast = true;
  bench.settings.data_port = static_cast<std::uint16_t>(test::free_port());
  bench.server.reset();
  bench.start_server();
  bench.warm_up();
  for (int k = 0; k < 20; ++k) {
    bench.server->publish(bench.next(7));
    ASSERT_TRUE(bench.until([&] { return bench.frames.size() > static_cast<std::size_t>(k); }));
  }
  EXPECT_EQ(bench.frames.back().bodies.size(), 7u);
  EXPECT_FALSE(bench.frames.back().bodies[0].occluded);
  EXPECT_EQ(bench.node->driver().frame_counts().frames_repeated, 0)
      << "not sent by unicast as well";
  EXPECT_EQ(bench.node->name(), "NATNET");
}

TEST(ViconNode, ReportsAnotherServerType) {
  SocketBench bench(MocapProtocol::kVrpn);
  bench.scenario.mocap.protocol = MocapProtocol::kDataStream;
  std::vector<std::string> statuses;
  ViconNode lost(bench.bus, bench.clock, bench.scenario,
                 [&](const std::string& status) { statuses.push_back(status); });
  ASSERT_TRUE(bench.until([&] {
    lost.tick(bench.clock.now());
    return !statuses.empty() && statuses.back().find("is a VRPN server, not") != std::string::npos;
  }));
  EXPECT_NE(statuses.back().find("set mocap.protocol: vrpn"), std::string::npos);
  EXPECT_GE(lost.counters().size(), 1u);
}

TEST(ViconNode, RefusesAScenarioWithDirectMocap) {
  SocketBench bench(MocapProtocol::kVrpn);
  bench.scenario.mocap.device = scenario::DeviceSource::kDirect;
  EXPECT_THROW(ViconNode(bench.bus, bench.clock, bench.scenario, [](const std::string&) {}),
               StartupError);
}

TEST(SocketServer, ConnectsBackToAVrpnClient) {
  sim::vicon::ServerSettings settings;
  settings.protocol = MocapProtocol::kVrpn;
  SocketServer server(settings, "127.0.0.1", 0);
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&own), size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  getsockname(listener, reinterpret_cast<sockaddr*>(&own), &size);

  const int caller = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to = own;
  to.sin_port = htons(static_cast<std::uint16_t>(server.port()));
  std::vector<std::uint8_t> call;
  wire::vicon::append_vrpn_callback(call, {"127.0.0.1", ntohs(own.sin_port)});
  ASSERT_GT(sendto(caller, call.data(), call.size(), 0, reinterpret_cast<sockaddr*>(&to), size), 0);
  server.wait(std::chrono::seconds(10));  // returns when the connection request has arrived
  const int line = accept(listener, nullptr, nullptr);
  ASSERT_GE(line, 0);
  server.wait(std::chrono::milliseconds(10));
  std::vector<std::uint8_t> cookie(wire::vicon::kVrpnCookieBytes);
  ASSERT_EQ(recv(line, cookie.data(), cookie.size(), MSG_WAITALL),
            static_cast<ssize_t>(cookie.size()));
  EXPECT_TRUE(wire::vicon::decode_vrpn_cookie(cookie));
  EXPECT_EQ(server.clients(), 1u);
  for (const int fd : {line, caller, listener}) {
    close(fd);
  }
}

TEST(SocketServer, SkipsFramesForAClientThatDoesNotRead) {
  sim::vicon::ServerSettings settings;
  settings.backlog_bytes_max = 10'000;
  SocketServer server(settings, "127.0.0.1", 0);
  scenario::Scenario scenario = test::lab_scenario();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  scenario.mocap.port = server.port();
  std::vector<std::size_t> received(3, 0);
  const bus::SystemClock clock;
  std::vector<std::unique_ptr<vicon::ViconDriver>> drivers;
  std::vector<std::unique_ptr<vicon::SocketLink>> links;
  for (std::size_t i = 0; i < received.size(); ++i) {
    drivers.push_back(std::make_unique<vicon::ViconDriver>(
        scenario.mocap, [&received, i](const models::MocapFrame&) { ++received[i]; }));
    links.push_back(std::make_unique<vicon::SocketLink>(*drivers.back(), [&clock] {
      return vicon::Moment{clock.now(), Duration{monotonic_ns() / 1'000}};
    }));
  }
  const std::int64_t end_ns = monotonic_ns() + kTimeLimit_ns;
  EmulatedFrame frame = test::circling(100, 0.0);
  // The third client requests frames and then stops reading.
  while ((server.frames_skipped() == 0 || received[0] < 100 || received[1] < 100) &&
         monotonic_ns() < end_ns) {
    server.wait(std::chrono::microseconds(0));
    ++frame.number;
    server.publish(frame);
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (i < 2 || received[2] == 0) {
        links[i]->step();
      }
    }
  }
  EXPECT_EQ(server.clients(), 3u);
  EXPECT_GE(received[0], 100u);
  EXPECT_GE(received[1], 100u);
  EXPECT_GT(server.frames_skipped(), 0);
  EXPECT_EQ(drivers[0]->frame_counts().frames_lost, 0);
}

// A client beyond the limit is disconnected immediately. When a client leaves, another can connect.
TEST(SocketServer, LimitsTheNumberOfClients) {
  SocketServer server({}, "127.0.0.1", 0);
  std::vector<int> clients;
  const auto connect_one = [&] {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
    clients.push_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    ASSERT_EQ(connect(clients.back(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  };
  const auto until = [&](const auto& is_done) {
    const std::int64_t end_ns = monotonic_ns() + kTimeLimit_ns;
    while (!is_done() && monotonic_ns() < end_ns) {
      server.wait(std::chrono::microseconds(100));
    }
    return is_done();
  };
  const auto is_closed = [&] {
    char byte = 0;
    return recv(clients.back(), &byte, 1, MSG_DONTWAIT) == 0;
  };
  while (clients.size() < SocketServer::kClientsMax) {
    connect_one();
    ASSERT_TRUE(until([&] { return server.clients() == clients.size(); }));
  }
  for (int turn = 0; turn < 2; ++turn) {
    connect_one();
    EXPECT_TRUE(until(is_closed));
    EXPECT_EQ(server.clients(), SocketServer::kClientsMax);
    close(clients.front());
    clients.erase(clients.begin());
    ASSERT_TRUE(until([&] { return server.clients() == SocketServer::kClientsMax - 1; }));
    connect_one();
    ASSERT_TRUE(until([&] { return server.clients() == SocketServer::kClientsMax; }));
    EXPECT_FALSE(is_closed());
  }
  for (const int fd : clients) {
    close(fd);
  }
}

}  // namespace
}  // namespace vantage::drivers
