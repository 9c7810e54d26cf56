#include "tools/ros2/bridge_node.hpp"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "models/belief/gaussian.hpp"
#include "test/support/bus_pair.hpp"
#include "test/tools/ros2/ros2_messages.hpp"

namespace vantage::tools::ros2 {
namespace {

/// Port without DDS: keeps what was written, and delivers what a test sends.
class FakePort : public Port {
 public:
  struct Written {
    std::string type;
    Durability durability;
    std::string cdr;
  };
  bool write(const std::string& topic, std::string_view type, Durability durability,
             std::string_view cdr) override {
    written[topic] = {std::string(type), durability, std::string(cdr)};
    return accepts;
  }
  void read(const std::string& topic, std::string_view type,
            std::function<void(std::span<const std::uint8_t>)> handler) override {
    readers[topic] = std::move(handler);
    read_types[topic] = type;
  }
  void take() override {
    for (const auto& [topic, cdr] : arrived) {
      readers.at(topic)(test::bytes_of(cdr));
    }
    arrived.clear();
  }

  bool accepts = true;
  std::map<std::string, Written> written;
  std::map<std::string, std::function<void(std::span<const std::uint8_t>)>> readers;
  std::map<std::string, std::string> read_types;
  std::vector<std::pair<std::string, std::string>> arrived;
};

class BridgeNodeTest : public testing::Test {
 protected:
  BridgeNodeTest() : clock_(from_utime(1'700'000'000'000'000)) {
    scenario_.robots.resize(1);
    scenario_.robots[0].name = "Q1";
    scenario_.targets = {{"R1", 0, {}, 0.2}};
    spec_.prefix = "/lab";
    spec_.world_frame = "map";
  }
  void open() { node_ = std::make_unique<BridgeNode>(bus_, clock_, port_, scenario_, spec_); }
  template <class Message>
  void publish(const bus::Channel<Message>& channel, Message message) {
    message.stamp.time = clock_.now();
    other_.publish(channel, std::move(message));
    bus_.handle(std::chrono::microseconds(0));
  }
  models::MocapFrame frame() const {
    models::MocapFrame out;
    out.stamp.time = clock_.now();
    out.arrival = clock_.now();
    out.bodies = {{"Q1", lift({1.0, 2.0, 0.0}, 2.0), false}};
    return out;
  }

  bus::VirtualClock clock_;
  test::BusPair buses_{1, 2};
  bus::Bus& bus_ = buses_.own;
  bus::Bus& other_ = buses_.other;
  scenario::Scenario scenario_;
  scenario::Ros2Spec spec_;
  FakePort port_;
  std::unique_ptr<BridgeNode> node_;
};

TEST_F(BridgeNodeTest, WritesEachChannelToItsTopics) {
  open();
  publish(bus::kVicon, frame());
  models::RobotBelief belief;
  belief.robot = "Q1";
  models::TargetBelief target;
  target.information =
      *models::to_information({Eigen::Vector2d(1.0, 2.0), Eigen::Matrix2d::Identity()});
  target.last_seen = clock_.now();
  belief.targets.push_back(target);
  publish(bus::belief_channel("Q1"), belief);
  models::VehicleStatus status;
  status.robot = "Q1";
  publish(bus::vehicle_channel("Q1"), status);
  models::ProcessHealth health;
  health.process = "PLANNER_Q1";
  publish(bus::health_channel("PLANNER_Q1"), health);
  std::map<std::string, std::string> types;
  for (const auto& [topic, message] : port_.written) {
    types[topic] = message.type;
    EXPECT_EQ(message.durability, Durability::kVolatile);
  }
  EXPECT_EQ(types, (std::map<std::string, std::string>{
                       {"/tf", "tf2_msgs/msg/TFMessage"},
                       {"/lab/Q1/pose", "geometry_msgs/msg/PoseStamped"},
                       {"/lab/Q1/beliefs", "visualization_msgs/msg/MarkerArray"},
                       {"/lab/Q1/target_0", "geometry_msgs/msg/PoseWithCovarianceStamped"},
                       {"/lab/Q1/battery", "sensor_msgs/msg/BatteryState"},
                       {"/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"}}));
  EXPECT_NE(port_.written["/tf"].cdr.find("map"), std::string::npos);
  EXPECT_EQ(port_.written["/tf"].cdr.find("world"), std::string::npos);
}

TEST_F(BridgeNodeTest, PublishesDetectionsAsMeasurements) {
  scenario_.robots[0].sensor_publisher = scenario::Publisher::kExternal;
  spec_.detections = {{"/Q1/detections", "Q1"}};
  open();
  EXPECT_EQ(port_.read_types["/Q1/detections"], kDetectionsType);
  std::vector<models::RobotMeasurement> received;
  other_.subscribe<models::RobotMeasurement>(
      bus::measurement_channel("Q1"),
      [&](const models::RobotMeasurement& each) { received.push_back(each); });
  publish(bus::kVicon, frame());
  port_.arrived.emplace_back(
      "/Q1/detections",
      test::detections_message(clock_.now(), "map", {{"0", "", {2.0, 2.0, 0.0}, 0.01}}));
  node_->tick(clock_.now());
  other_.handle(std::chrono::microseconds(0));
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].robot, "Q1");
  ASSERT_EQ(received[0].detections.size(), 1U);
  EXPECT_NEAR(received[0].detections[0].measurement.z(0), 1.0, 1e-9);
}

TEST_F(BridgeNodeTest, PublishesPosesAsMotionCapture) {
  spec_.poses = {{"/Q1/pose", scenario::Ros2PoseType::kPose, "Q1"}};
  open();
  std::vector<models::MocapFrame> received;
  other_.subscribe<models::MocapFrame>(
      bus::kVicon, [&](const models::MocapFrame& each) { received.push_back(each); });
  port_.arrived.emplace_back(
      "/Q1/pose", test::pose_message(clock_.now(), "map", {{1.0, 2.0, 3.0}, {1, 0, 0, 0}}));
  node_->tick(clock_.now());
  clock_.set(clock_.now() + Duration{10'000});
  port_.arrived.emplace_back(
      "/Q1/pose", test::pose_message(clock_.now(), "map", {{1.0, 2.0, 3.01}, {1, 0, 0, 0}}));
  node_->tick(clock_.now());
  other_.handle(std::chrono::microseconds(0));
  ASSERT_EQ(received.size(), 2U);
  EXPECT_EQ(received[1].bodies.at(0).world_from_body.translation_m.z(), 3.01);
  EXPECT_EQ(received[1].stamp.time, clock_.now());
}

TEST_F(BridgeNodeTest, CountsMessagesThatDdsDoesNotAccept) {
  port_.accepts = false;
  open();
  publish(bus::kVicon, frame());
  std::map<std::string, std::int64_t> counts;
  for (const models::NamedCount& each : node_->counters()) {
    counts[each.name] = each.count;
  }
  EXPECT_EQ(counts["ros2.messages_refused"], 2);  // the transforms on /tf, and the pose
}

}  // namespace
}  // namespace vantage::tools::ros2
