// Tests of the sources of emulated mocap bodies, and of the emulator program.

#include "sim/vicon/app/source.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/write_file.hpp"
#include "sim/vicon/app/emulator.hpp"
#include "sim/vicon/recorded_flight.hpp"
#include "sim/vicon/socket_server.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/temporary_folder.hpp"
#include "wire/vicon/object_stream.hpp"

namespace vantage::sim::vicon {
namespace {

// Bodies move on circles of radius 0.5 m at 1 rad/s, about 1 m high. The centres are 2 m apart, ten
// per row.
TEST(CirclingBodies, CircleTheirOwnCentres) {
  CirclingBodies source(23);
  EmulatedFrame frame;
  Eigen::Vector2d least_m = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d most_m = Eigen::Vector2d::Constant(-1e9);
  double lowest_m = 1e9;
  double highest_m = -1e9;
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(source.fill(0.1 * k, frame));
    ASSERT_EQ(frame.bodies.size(), 23u);
    for (std::size_t i = 0; i < 23; ++i) {
      EXPECT_EQ(frame.bodies[i].name, "BODY" + std::to_string(i));
      EXPECT_FALSE(frame.bodies[i].is_occluded);
      const Pose2 pose = flatten(frame.bodies[i].world_from_body);
      const Eigen::Vector2d centre_m(2.0 * static_cast<double>(i % 10),
                                     2.0 * static_cast<double>(i / 10));
      const Eigen::Vector2d arm_m = pose.position_m() - centre_m;
      EXPECT_NEAR(arm_m.norm(), 0.5, 1e-9);
      EXPECT_NEAR(std::remainder(std::atan2(arm_m.y(), arm_m.x()) - pose.yaw_rad, 2.0 * kPi), 0.0,
                  1e-9);
      EXPECT_NEAR(std::remainder(pose.yaw_rad - 0.1 * k - static_cast<double>(i), 2.0 * kPi), 0.0,
                  1e-9);
      const double height_m = frame.bodies[i].world_from_body.translation_m.z();
      lowest_m = std::min(lowest_m, height_m);
      highest_m = std::max(highest_m, height_m);
      least_m = least_m.cwiseMin(arm_m);
      most_m = most_m.cwiseMax(arm_m);
    }
    frame.bodies[3].is_occluded = true;  // must be visible again in the next frame
  }
  EXPECT_NEAR(lowest_m, 0.9, 1e-3);
  EXPECT_NEAR(highest_m, 1.1, 1e-3);
  EXPECT_LT(least_m.maxCoeff(), -0.49);
  EXPECT_GT(most_m.minCoeff(), 0.49);
}

/// Writes a flight file with `rows` poses along x, one per `period_s`.
std::string flight_in(const vantage::test::TemporaryFolder& folder, const std::string& name,
                      int rows, double period_s) {
  std::string text = "t,x,y,z,qw,qx,qy,qz\n";
  for (int k = 0; k < rows; ++k) {
    text +=
        std::to_string(3.0 + k * period_s) + "," + std::to_string(k) + ",2,3,0.5,0.5,-0.5,0.5\r\n";
  }
  write_file(folder.file(name), text);
  return folder.file(name);
}

TEST(ReadFlight, ReadsNamesPeriodsAndPoses) {
  const vantage::test::TemporaryFolder folder;
  const RecordedFlight flight = read_flight(flight_in(folder, "LARK.one.csv", 5, 0.02));
  EXPECT_EQ(flight.name, "LARK.one");
  EXPECT_NEAR(flight.period_s, 0.02, 1e-9);
  ASSERT_EQ(flight.world_from_body.size(), 5u);
  EXPECT_EQ(flight.world_from_body[4].translation_m, Eigen::Vector3d(4.0, 2.0, 3.0));
  EXPECT_LT(flight.world_from_body[4].rotation.angularDistance(Quaternion(0.5, 0.5, -0.5, 0.5)),
            1e-7);
  const auto why = [&](const std::string& text) {
    write_file(folder.file("f.csv"), text);
    try {
      read_flight(folder.file("f.csv"));
    } catch (const StartupError& error) {
      return std::string(error.what()).substr(folder.file("f.csv").size());
    }
    return std::string();
  };
  const std::string good = "1,0,0,1,1,0,0,0\n";
  EXPECT_EQ(why(""), ": cannot be read");
  EXPECT_EQ(why("t\n"), ": contains no flight");
  EXPECT_EQ(why("t\n1,0,0,1,1,0,0,x\n"),
            ":2: expected eight numbers: time, position, quaternion w x y z");
  EXPECT_EQ(why("t\n" + good + "1.01;0;0;1;1;0;0;0\n"),
            ":3: expected eight numbers: time, position, quaternion w x y z");
  EXPECT_EQ(why("t\n1,0,nan,1,1,0,0,0\n"),
            ":2: expected eight numbers: time, position, quaternion w x y z");
  EXPECT_EQ(why("t\n1,0,0,1,1,0,0,0,9\n"),
            ":2: expected eight numbers: time, position, quaternion w x y z");
  EXPECT_EQ(why("t\n1,0,0,1,1,0.1,0,0\n"), ":2: the quaternion must have length 1");
  EXPECT_EQ(why("t\n" + good + good), ": contains no flight") << "no time has passed";
  EXPECT_EQ(why("t\n" + good + "0.99,0,0,1,1,0,0,0\n"), ": contains no flight") << "time decreases";
  EXPECT_EQ(why("t\n" + good), "") << "one pose, at 100 Hz";
  EXPECT_EQ(why("t\n" + good + "1.01,0,0,1,1,0,0,0\n1.0200999,0,0,1,1,0,0,0\n"), "");
  EXPECT_EQ(why("t\n" + good + "1.01,0,0,1,1,0,0,0\n1.0201001,0,0,1,1,0,0,0\n"),
            ":4: times must be evenly spaced");
}

// Each body has the pose of the newest row of its file. When the shortest flight
// ends, all flights end or start again.
TEST(Flights, EndTogetherWithTheShortest) {
  const vantage::test::TemporaryFolder folder;
  // Durations: B 12 rows × 0.1 s = 1.2 s, A 20 × 0.05 s = 1 s, C 7 × 0.15 s = 1.05 s.
  const std::vector<std::string> paths{flight_in(folder, "B.csv", 12, 0.1),
                                       flight_in(folder, "A.csv", 20, 0.05),
                                       flight_in(folder, "C.csv", 7, 0.15)};
  Flights once(paths, false);
  Flights endless(paths, true);
  EmulatedFrame frame;
  struct Row {
    double time_s;
    int a, b, c;
  };
  for (const Row& row : {Row{0.0, 0, 0, 0}, Row{0.049, 0, 0, 0}, Row{0.05, 1, 0, 0},
                         Row{0.3, 6, 3, 2}, Row{0.949, 18, 9, 6}, Row{0.999, 19, 9, 6}}) {
    for (const double later_s : {0.0, 1.0, 3.0}) {
      ASSERT_EQ(once.fill(row.time_s + later_s, frame), later_s == 0.0);
      ASSERT_TRUE(endless.fill(row.time_s + later_s, frame));
      ASSERT_EQ(frame.bodies.size(), 3u);
      EXPECT_EQ(frame.bodies[0].name, "B");
      EXPECT_EQ(frame.bodies[0].world_from_body.translation_m.x(), row.b) << row.time_s;
      EXPECT_EQ(frame.bodies[1].world_from_body.translation_m.x(), row.a) << row.time_s;
      EXPECT_EQ(frame.bodies[2].world_from_body.translation_m.x(), row.c) << row.time_s;
    }
  }
  EXPECT_THROW(Flights({}, true), StartupError);
}

TEST(ScenarioWorld, EqualsTheScenariosWorld) {
  const scenario::Scenario scenario = test::lab_scenario();
  const Time start = from_utime(1'700'000'000'000'000);
  ScenarioWorld source(scenario, start);
  WorldSimulation world(scenario, scenario.seed, start);
  EmulatedFrame frame;
  for (const double time_s : {0.5, 1.0, 3.0}) {
    ASSERT_TRUE(source.fill(time_s, frame));
    world.advance_to(start + from_seconds(time_s));
    const models::MocapFrame seen = world.capture();
    ASSERT_EQ(frame.bodies.size(), seen.bodies.size());
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      EXPECT_EQ(frame.bodies[i].name, seen.bodies[i].name);
      EXPECT_EQ(frame.bodies[i].world_from_body.translation_m,
                seen.bodies[i].world_from_body.translation_m);
    }
  }
}

// --- emulator program

int run(std::vector<std::string> words) {
  words.insert(words.begin(), "vantage-vicon-emulator");
  std::vector<char*> argv;
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  return run_emulator(static_cast<int>(argv.size()), argv.data());
}

/// True if the program accepts these options: only then it reports that the recording is missing.
bool is_understood(std::vector<std::string> words) {
  words.insert(words.end(), {"--flight", "/nowhere/flight.csv"});
  try {
    EXPECT_EQ(run(words), 2);
  } catch (const StartupError&) {
    return true;
  }
  return false;
}

TEST(RunEmulator, RefusesOptionsBeyondTheirLimits) {
  struct Row {
    std::string option;
    std::vector<std::string> good, bad;
  };
  for (const Row& row :
       {Row{"--rate", {"1", "1000"}, {"0.9", "1001", "-1"}},
        Row{"--block-bytes", {"256", "512", "1024"}, {"128", "255", "2048"}},
        Row{"--up", {"z", "y"}, {"x"}}, Row{"--latency-s", {"0", "1"}, {"-0.1", "1.1"}},
        Row{"--occlusion", {"absent", "zero", "repeated"}, {"some"}},
        Row{"--occluded-s", {"0", "10"}, {"-0.1", "10.1"}},
        Row{"--protocol", {"datastream", "object_stream", "vrpn", "natnet", "qtm"}, {"mavlink"}},
        Row{"--natnet-version", {"3.0", "4.1"}, {"2.9", "5.0"}}, Row{"--bodies", {}, {"3"}},
        Row{"--scenario", {}, {"lab.yaml"}}}) {
    for (const std::string& value : row.good) {
      EXPECT_TRUE(is_understood({row.option, value})) << row.option << ' ' << value;
    }
    for (const std::string& value : row.bad) {
      EXPECT_FALSE(is_understood({row.option, value})) << row.option << ' ' << value;
    }
  }
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_EQ(run({"--bodies", "513", "--duration-s", "0.001"}), 2);
  EXPECT_EQ(run({"--bodies", "-1", "--duration-s", "0.001"}), 2);
  EXPECT_THROW(run({"--scenario", "/nowhere/lab.yaml"}), StartupError);
}

/// Returns the names of the bodies in each frame that the program sends as an object stream.
std::vector<std::vector<std::string>> frames_of(const std::vector<std::string>& words) {
  const int receiver = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = address_of(INADDR_LOOPBACK, 0);
  socklen_t size = sizeof address;
  EXPECT_EQ(bind(receiver, as_sockaddr(address), size), 0);
  EXPECT_EQ(getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &size), 0);
  std::vector<std::string> all{"--protocol", "object_stream", "--port",
                               std::to_string(ntohs(address.sin_port))};
  all.insert(all.end(), words.begin(), words.end());
  EXPECT_EQ(run(all), 0);
  std::vector<std::vector<std::string>> out;
  std::vector<std::uint8_t> buffer(2048);
  ssize_t got = 0;
  while ((got = recv(receiver, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0) {
    wire::vicon::ObjectBlock block;
    EXPECT_TRUE(wire::vicon::decode_object_block(
        wire::vicon::Bytes(buffer).first(static_cast<std::size_t>(got)), block));
    out.resize(std::max<std::size_t>(out.size(), block.frame_number + 1));
    for (const wire::vicon::TrackerObject& object : block.objects) {
      out[block.frame_number].emplace_back(object.name());
    }
  }
  close(receiver);
  return out;
}

TEST(RunEmulator, SendsAtItsRateForItsDuration) {
  const auto frames = frames_of({"--bodies", "4", "--rate", "200", "--duration-s", "0.03"});
  ASSERT_EQ(frames.size(), 6u) << "at 0, 5, … 25 ms";
  for (const auto& names : frames) {
    EXPECT_EQ(names, (std::vector<std::string>{"BODY0", "BODY1", "BODY2", "BODY3"}));
  }
  EXPECT_EQ(frames_of({"--rate", "500", "--duration-s", "0.004"}).at(0).size(), 3u);
}

// When the program ends for any reason, it reports the number of frames sent.
TEST(RunEmulator, ReportsFrameCount) {
  const vantage::test::TemporaryFolder folder;
  const std::string path = flight_in(folder, "LARK.csv", 4, 0.01);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--bodies", "1", "--rate", "500", "--duration-s", "0.006"},
        std::vector<std::string>{"--flight", path, "--rate", "500"}}) {
    testing::internal::CaptureStderr();
    const std::size_t sent = frames_of(words).size();
    const std::string output = testing::internal::GetCapturedStderr();
    EXPECT_NE(output.find(": " + std::to_string(sent) + " frames, 0 skipped"), std::string::npos)
        << sent << " of: " << output;
  }
}

TEST(RunEmulator, EndsAfterItsRecording) {
  const vantage::test::TemporaryFolder folder;
  const std::string path = flight_in(folder, "LARK.csv", 4, 0.01);
  EXPECT_EQ(frames_of({"--flight", path, "--rate", "200"}).size(), 8u);
  EXPECT_EQ(
      frames_of({"--flight", path, "--rate", "200", "--endless", "--duration-s", "0.05"}).size(),
      10u);
}

// Bodies are occluded in turn, each for the given time in every 10 s. Two bodies with 5 s each
// alternate; a single body is hidden first.
TEST(RunEmulator, OccludesBodiesInTurn) {
  using Names = std::vector<std::string>;
  const auto expect = [](const std::string& bodies, const std::string& hidden_s, const Names& seen,
                         const std::string& style) {
    const auto frames = frames_of({"--bodies", bodies, "--rate", "500", "--duration-s", "0.01",
                                   "--occluded-s", hidden_s, "--occlusion", style});
    EXPECT_EQ(frames.size(), 5u);
    for (const Names& names : frames) {
      EXPECT_EQ(names, seen) << bodies << " for " << hidden_s;
    }
  };
  expect("2", "5", {"BODY0"}, "absent");
  expect("1", "5", {}, "absent");
  expect("4", "2.4", {"BODY0", "BODY1", "BODY2"}, "absent");
  expect("4", "2.6", {"BODY1", "BODY2"}, "absent");
  expect("4", "2.6", {"BODY0", "BODY1", "BODY2", "BODY3"}, "zero");
}

TEST(SocketServer, ReportsListenAndSendErrors) {
  ServerSettings settings;
  SocketServer taken(settings, "127.0.0.1", 0);
  const auto why = [&](const std::string& host, int port) {
    try {
      const SocketServer server(settings, host, port);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string port = std::to_string(taken.port());
  EXPECT_EQ(why("127.0.0.1", taken.port()),
            "cannot listen at 127.0.0.1:" + port + ": Address already in use");
  EXPECT_EQ(why("localhost", 0), "'localhost' is not an IPv4 address");
  settings.protocol = scenario::MocapProtocol::kVrpn;
  SocketServer vrpn(settings, "127.0.0.1", 0);
  EXPECT_GT(vrpn.port(), 0);
  EXPECT_EQ(vrpn.clients(), 0u);
  settings.protocol = scenario::MocapProtocol::kObjectStream;
  EXPECT_EQ(SocketServer(settings, "127.0.0.1", 5'000).port(), 5'000);
}

TEST(SocketServer, ServesSixtyFourClients) {
  SocketServer server(ServerSettings{}, "127.0.0.1", 0);
  const sockaddr_in address = address_of(INADDR_LOOPBACK, server.port());
  std::vector<int> clients;
  for (int k = 0; k < 66; ++k) {
    clients.push_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    ASSERT_EQ(connect(clients.back(), as_sockaddr(address), sizeof address), 0);
    server.wait(std::chrono::nanoseconds(0));
  }
  EXPECT_EQ(server.clients(), 64u);
  std::uint8_t byte = 0;
  EXPECT_EQ(recv(clients[65], &byte, 1, 0), 0) << "disconnected";
  EXPECT_EQ(recv(clients[0], &byte, 1, 0), 1) << "receives the greeting";
  for (std::size_t k = 0; k < clients.size(); ++k) {
    if (k % 2 == 0) {
      close(clients[k]);
    }
  }
  server.wait(std::chrono::nanoseconds(0));
  server.wait(std::chrono::nanoseconds(0));
  EXPECT_EQ(server.clients(), 32u);
  const std::string foreign = "GET / HTTP/1.1\r\n\r\n";
  ASSERT_EQ(send(clients[1], foreign.data(), foreign.size(), 0),
            static_cast<ssize_t>(foreign.size()));
  server.wait(std::chrono::nanoseconds(0));
  EXPECT_EQ(server.clients(), 31u) << "clients with another protocol do not count";
  for (std::size_t k = 1; k < clients.size(); k += 2) {
    close(clients[k]);
  }
}

}  // namespace
}  // namespace vantage::sim::vicon
