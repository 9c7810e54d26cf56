// Files of the profile "ros2" are read by Foxglove's ROS 2 decoder, which shares no code with our
// writer.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "logs/export/mcap_export.hpp"
#include "logs/record/log_writer.hpp"
#include "models/mapping/beam.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using Json = nlohmann::json;

struct TopicContent {
  std::string type;
  std::int64_t stamp_ns = 0;
  Json content;
};

class Ros2Export : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kPeer + "/node_modules/@foxglove/rosmsg2-serialization")) {
      GTEST_SKIP() << "@foxglove/rosmsg2-serialization is not installed: tools/setup";
    }
  }

  template <class Message>
  void add(const std::string& channel, const Message& message) {
    log_->write(kLogged, channel, vantage::test::encoded(message));
  }

  /// Returns the log as the peer reads it: the last message of each topic.
  std::map<std::string, TopicContent> read() {
    log_.reset();
    const IndexedLog log(folder_.file("a.lcmlog"));
    ChannelFilter all;
    counts_ = export_ros2(log, folder_.file("a.mcap"), all);
    const std::string command =
        "node " + kPeer + "/ros2.mjs " + folder_.file("a.mcap") + " > " + folder_.file("out");
    EXPECT_EQ(std::system(command.c_str()), 0);
    const test::Bytes bytes = test::read_file(folder_.file("out"));
    std::istringstream lines(std::string(bytes.begin(), bytes.end()));
    std::map<std::string, TopicContent> topics;
    for (std::string topic; lines >> topic;) {
      TopicContent& each = topics[topic];
      lines >> each.type >> each.stamp_ns;
      std::string json;
      std::getline(lines, json);
      each.content = Json::parse(json);
    }
    return topics;
  }

  static constexpr std::int64_t kUtime = 1'700'000'000'250'000;
  const Time kLogged = from_utime(kUtime + 1'000);
  const std::string kPeer = std::string(VANTAGE_SOURCE_DIR) + "/test/logs/mcap_peer";
  test::TemporaryFolder folder_;
  std::unique_ptr<LogWriter> log_ = std::make_unique<LogWriter>(folder_.file("a.lcmlog"));
  ExportCounts counts_;
};

TEST_F(Ros2Export, WritesPosesAndPlansInTheWorldFrame) {
  models::MocapFrame frame;
  frame.stamp.time = from_utime(kUtime);
  frame.arrival = frame.stamp.time;
  frame.bodies = {{"Q1", lift({1.0, 2.0, 0.5}, 1.5), false}, {"R1", {}, true}};
  add("VICON", frame);
  models::RobotPlan plan;
  plan.stamp.time = from_utime(kUtime);
  plan.robot = "Q1";
  plan.slot_start = plan.deadline = plan.finish = plan.stamp.time;
  plan.lower_bound = -1.0;
  plan.trajectory = {plan.stamp.time, {1.0, 2.0, 0.0}, 1.5, {{{1.0, 0.0}, 1.2, 0.0}}};
  add("PLAN_Q1", plan);
  models::RobotPlan answer = plan;
  answer.trajectory.start.x_m = -7.0;
  add("EXTERNAL_PLAN_Q1", answer);
  auto topics = read();
  EXPECT_EQ(counts_.messages, 2U);
  EXPECT_TRUE(counts_.left_out.empty());

  const Json transforms = topics["/tf"].content["transforms"];
  ASSERT_EQ(transforms.size(), 1U) << "occluded bodies are omitted";
  EXPECT_EQ(transforms[0]["header"]["frame_id"], "world");
  EXPECT_EQ(transforms[0]["header"]["stamp"],
            (Json{{"sec", 1'700'000'000}, {"nanosec", 250'000'000}}));
  EXPECT_EQ(transforms[0]["child_frame_id"], "Q1");
  EXPECT_EQ(transforms[0]["transform"]["translation"], (Json{{"x", 1.0}, {"y", 2.0}, {"z", 1.5}}));
  EXPECT_NEAR(transforms[0]["transform"]["rotation"]["z"], std::sin(0.25), 1e-12);
  EXPECT_NEAR(transforms[0]["transform"]["rotation"]["w"], std::cos(0.25), 1e-12);

  EXPECT_EQ(topics["/Q1/plan"].type, "nav_msgs/msg/Path");
  EXPECT_EQ(topics["/Q1/plan"].stamp_ns, kUtime * 1'000);
  const Json poses = topics["/Q1/plan"].content["poses"];
  ASSERT_EQ(poses.size(), 4U) << "every half second and at the end";
  EXPECT_EQ(poses[0]["pose"]["position"], (Json{{"x", 1.0}, {"y", 2.0}, {"z", 1.5}}));
  EXPECT_NEAR(poses[3]["pose"]["position"]["x"], 2.2, 1e-9);
}

TEST_F(Ros2Export, WritesBeliefsWithCovariance) {
  models::RobotBelief belief;
  belief.stamp.time = from_utime(kUtime);
  belief.robot = "Q1";
  Eigen::Matrix2d covariance;
  covariance << 0.5, 0.1, 0.1, 0.25;
  const models::Gaussian known{Eigen::Vector2d(3.0, -1.0), covariance};
  belief.targets = {{4, *models::to_information(known), belief.stamp.time}};
  add("BELIEF_Q1", belief);
  const Json pose = read()["/Q1/target_4"].content["pose"];
  EXPECT_NEAR(pose["pose"]["position"]["x"], 3.0, 1e-9);
  ASSERT_EQ(pose["covariance"].size(), 36U);
  EXPECT_NEAR(pose["covariance"][0], 0.5, 1e-9);
  EXPECT_NEAR(pose["covariance"][1], 0.1, 1e-9);
  EXPECT_NEAR(pose["covariance"][7], 0.25, 1e-9);
  EXPECT_EQ(pose["covariance"][14], 1e6) << "the height is not estimated";
}

TEST_F(Ros2Export, WritesScansMapsBatteriesAndHealth) {
  models::RangeScan scan;
  scan.stamp.time = from_utime(kUtime);
  scan.robot = "Q1";
  scan.field_of_view_rad = kPi;
  scan.range_max_m = 1.5;
  scan.ranges_m = {0.5, 1.0, 1.5};
  add("SCAN_Q1", scan);
  models::RobotMap map;
  map.stamp.time = scan.stamp.time;
  map.robot = "Q1";
  map.grid = {{-4.0, -2.0}, 0.5, 3, 2};
  map.own_looks = map.team_looks = {0, 1, -1, 5, -7, 0};
  add("MAP_Q1", map);
  models::VehicleStatus status;
  status.stamp.time = scan.stamp.time;
  status.robot = "Q1";
  status.battery_share = 0.75;
  add("VEHICLE_Q1", status);
  models::ProcessHealth health;
  health.stamp.time = scan.stamp.time;
  health.process = "SIM";
  health.state = models::ProcessState::kDegraded;
  health.counters = {{"VICON.lost", 3}};
  add("HEALTH_SIM", health);
  auto topics = read();

  const Json laser = topics["/Q1/scan"].content;
  EXPECT_EQ(laser["header"]["frame_id"], "Q1");
  models::BeamSensor sensor;
  sensor.beams = 3;
  sensor.field_of_view_rad = kPi;
  for (int beam = 0; beam < 3; ++beam) {
    const double bearing_rad =
        laser["angle_min"].get<double>() + beam * laser["angle_increment"].get<double>();
    EXPECT_NEAR(bearing_rad, sensor.bearing_rad(beam), 1e-6) << beam;
  }
  EXPECT_EQ(laser["ranges"], Json({0.5, 1.0, 1.5}));
  const Json grid = topics["/Q1/map"].content;
  EXPECT_EQ(grid["info"]["width"], 3);
  EXPECT_EQ(grid["info"]["origin"]["position"]["x"], -4.0);
  EXPECT_EQ(grid["data"], Json({-1, 100, 0, 100, 0, -1}));
  EXPECT_EQ(topics["/Q1/battery"].content["percentage"], 0.75);
  const Json diagnostic = topics["/diagnostics"].content["status"][0];
  EXPECT_EQ(diagnostic["level"], 1);
  EXPECT_EQ(diagnostic["name"], "SIM");
  EXPECT_EQ(diagnostic["values"][0], (Json{{"key", "VICON.lost"}, {"value", "3"}}));
}

TEST_F(Ros2Export, WritesRandomMessagesOfKnownTypes) {
  vantage::test::Sampler sampler(11);
  for (int i = 0; i < 20; ++i) {
    add("VICON", vantage::test::sample<models::MocapFrame>(sampler));
    add("TRUTH", vantage::test::sample<models::TruthFrame>(sampler));
    add("HEALTH_SIM", vantage::test::sample<models::ProcessHealth>(sampler));
    add("ATTACK", vantage::test::sample<models::AttackNotice>(sampler));
  }
  const auto topics = read();
  EXPECT_TRUE(topics.contains("/truth/tf"));
  EXPECT_TRUE(counts_.left_out.empty());
  EXPECT_GE(counts_.messages, 60U);
}

}  // namespace
}  // namespace vantage::logs
