#include "tools/doctor/vicon_doctor.hpp"

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "drivers/natnet/natnet_session.hpp"
#include "drivers/qualisys/qtm_session.hpp"
#include "sim/vicon/socket_server.hpp"
#include "test/support/udp_port.hpp"

namespace vantage::tools {
namespace {

using scenario::MocapProtocol;
using wire::vicon::ServerType;

bool has_line(const std::vector<std::string>& lines, const std::string& words) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

std::string all_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    text += line + "\n";
  }
  return text;
}

ViconPort stream_of(MocapProtocol protocol, ServerType server_type, int port) {
  ViconPort out;
  out.expected = protocol;
  out.port = port;
  out.answer = Answer::kAccepted;
  out.server_type = server_type;
  out.observed.emplace();
  out.observed->frames = 100;
  out.observed->rate_hz = 100.0;
  out.observed->bodies["QUAD"] = {100, 50, {1.0, 2.0, 3.0}};
  return out;
}

TEST(DescribeVicon, ListsSubjectsAndScenarioLines) {
  const std::vector<ViconPort> ports{
      stream_of(MocapProtocol::kDataStream, ServerType::kDataStream, 801)};
  const auto lines = describe("10.0.0.9", ports);
  EXPECT_TRUE(has_line(lines, "10.0.0.9:801: a Vicon DataStream server, 100.0 Hz, 1 bodies"));
  EXPECT_TRUE(has_line(lines, "QUAD: seen in 50 % of the frames, last at (1.000, 2.000, 3.000) m"));
  EXPECT_TRUE(has_line(lines, "mocap: {device: real, protocol: datastream, host: 10.0.0.9}"));
  EXPECT_TRUE(is_usable(ports));
}

TEST(DescribeVicon, NamesTheProductAtAWrongPort) {
  const std::vector<ViconPort> ports{stream_of(MocapProtocol::kDataStream, ServerType::kVrpn, 801)};
  const auto lines = describe("10.0.0.9", ports);
  EXPECT_TRUE(has_line(lines, "10.0.0.9:801: a VRPN server"));
  EXPECT_TRUE(has_line(lines, "protocol: vrpn, host: 10.0.0.9, port: 801"));
}

TEST(DescribeVicon, ExplainsMissingPoses) {
  std::vector<ViconPort> ports{stream_of(MocapProtocol::kDataStream, ServerType::kDataStream, 801)};
  ports[0].observed->bodies["QUAD"].seen = 0;
  EXPECT_TRUE(has_line(describe("h", ports), "Kinematic Fit"));
  EXPECT_FALSE(is_usable(ports));
  ports[0].observed->bodies.clear();
  EXPECT_TRUE(has_line(describe("h", ports), "enable the objects"));
  ports[0].answer = Answer::kRefused;
  EXPECT_TRUE(has_line(describe("h", ports), "no program listens"));
  EXPECT_TRUE(has_line(describe("h", ports), "no motion capture found"));
}

TEST(DescribeVicon, ReportsTheRateOfEachVrpnTracker) {
  std::vector<ViconPort> ports{stream_of(MocapProtocol::kVrpn, ServerType::kVrpn, 3883)};
  ports[0].observed->bodies["QUAD"].rate_hz = 50.0;
  EXPECT_TRUE(has_line(describe("h", ports), "QUAD: 50.0 Hz, seen in 50 % of the frames"));
}

// No message was received, and no connection exists.
TEST(ExamineVicon, ReportsSilence) {
  const auto ports = examine_vicon("127.0.0.1", {}, std::stoi(test::port_of_this_test(0)),
                                   std::chrono::milliseconds(2'500));
  const auto lines = describe("127.0.0.1", ports);
  EXPECT_TRUE(has_line(lines, "no motion capture found")) << all_of(lines);
  EXPECT_FALSE(has_line(lines, "connected")) << all_of(lines);
}

TEST(ExamineVicon, ReturnsItsResultOnStop) {
  int checks = 0;
  const auto ports = examine_vicon("127.0.0.1", {1, 2, 3}, std::stoi(test::port_of_this_test(0)),
                                   std::chrono::hours(1), [&] { return ++checks > 2; });
  EXPECT_LT(ports.size(), 4U);
}

/// Emulated server of a moving body QUAD, in a thread.
class RunningServer {
 public:
  explicit RunningServer(MocapProtocol protocol) : server_(settings_of(protocol), "127.0.0.1", 0) {
    thread_ = std::thread([this] {
      sim::vicon::EmulatedFrame frame;
      frame.bodies.resize(1);
      frame.bodies[0].name = "QUAD";
      while (!is_done_) {
        ++frame.number;
        frame.bodies[0].world_from_body.translation_m.x() += 1e-4;
        frame.captured += Duration{10'000};
        server_.publish(frame);
        server_.wait(std::chrono::milliseconds(10));
      }
    });
  }
  ~RunningServer() {
    is_done_ = true;
    thread_.join();
  }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;
  RunningServer(RunningServer&&) = delete;
  RunningServer& operator=(RunningServer&&) = delete;

  [[nodiscard]] int port() const { return server_.port(); }

 private:
  static sim::vicon::ServerSettings settings_of(MocapProtocol protocol) {
    sim::vicon::ServerSettings settings;
    settings.protocol = protocol;
    settings.is_y_up = protocol.is_y_up();
    return settings;
  }

  sim::vicon::SocketServer server_;
  std::atomic<bool> is_done_ = false;
  std::thread thread_;
};

TEST(ExamineServer, ReportsTheBodiesOfEachSystem) {
  for (const auto* row : {&drivers::natnet::natnet_row(), &drivers::qualisys::qtm_row()}) {
    const RunningServer server(row->protocol);
    const std::vector<ViconPort> ports{
        examine_server("127.0.0.1", *row, server.port(), std::chrono::seconds(2))};
    EXPECT_EQ(ports[0].answer, Answer::kAccepted);
    const auto lines = describe("127.0.0.1", ports);
    EXPECT_TRUE(is_usable(ports)) << all_of(lines);
    EXPECT_TRUE(has_line(lines, "QUAD: seen in ")) << all_of(lines);
    EXPECT_TRUE(has_line(lines, std::string("mocap: {device: real, protocol: ") +
                                    row->protocol.name() + ", host: 127.0.0.1, port: "))
        << all_of(lines);
  }
}

TEST(ExamineServer, ReportsSilenceAndOtherProducts) {
  const std::vector<ViconPort> silent{examine_server("127.0.0.1", drivers::natnet::natnet_row(),
                                                     std::stoi(test::port_of_this_test(0)),
                                                     std::chrono::milliseconds(300))};
  EXPECT_TRUE(has_line(describe("127.0.0.1", silent), "no answer (streaming turned off"));
  EXPECT_FALSE(is_usable(silent));
  const RunningServer vrpn(MocapProtocol::kVrpn);
  const std::vector<ViconPort> other{examine_server("127.0.0.1", drivers::qualisys::qtm_row(),
                                                    vrpn.port(), std::chrono::seconds(2))};
  EXPECT_TRUE(has_line(describe("127.0.0.1", other), "a VRPN server"));
  EXPECT_FALSE(is_usable(other));
}

TEST(ExamineVicon, RecognisesAVrpnServer) {
  const RunningServer server(MocapProtocol::kVrpn);
  const auto ports =
      examine_vicon("127.0.0.1", {server.port()}, server.port(), std::chrono::seconds(2));
  ASSERT_EQ(ports.size(), 2u);
  EXPECT_EQ(ports[0].answer, Answer::kAccepted);
  EXPECT_EQ(ports[0].server_type, ServerType::kVrpn);
  const auto lines = describe("127.0.0.1", ports);
  EXPECT_TRUE(has_line(lines, "QUAD: ") && has_line(lines, " Hz, seen in 100 %")) << all_of(lines);
  EXPECT_TRUE(has_line(lines, "protocol: vrpn")) << all_of(lines);
}

TEST(ExamineVicon, RefusesAnUnknownHost) {
  EXPECT_THROW(static_cast<void>(examine_vicon("no.such.host.invalid", {}, 1, Duration{0})),
               StartupError);
}

}  // namespace
}  // namespace vantage::tools
