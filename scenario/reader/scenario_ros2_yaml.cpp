#include "scenario/reader/scenario_ros2_yaml.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "scenario/reader/scenario_sections_yaml.hpp"
#include "scenario/reader/yaml_document.hpp"

namespace vantage::scenario {
namespace {

constexpr int kDomainMax = 232;  // larger domains would need UDP ports above 65535
constexpr std::size_t kCardNameMax = 15;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// True for "/a/b_2", a name that ROS 2 accepts as a topic.
bool is_topic(std::string_view name) {
  if (name.empty() || name.front() != '/' || name.back() == '/') {
    return false;
  }
  char before = '/';
  for (const char c : name.substr(1)) {
    const bool is_begin = before == '/';
    if (!(is_letter(c) || (is_digit(c) && !is_begin) || (c == '/' && !is_begin))) {
      return false;
    }
    before = c;
  }
  return name.size() > 1;
}

void read_topic(Mapping& from, std::string& topic) {
  from.require("topic");
  from.text("topic", topic);
  if (!topic.empty() && !is_topic(topic)) {
    from.refuse("topic", "must be a full ROS 2 topic such as /Q1/pose, is '" + topic + "'");
  }
}

void read_pose_input(Mapping& from, const Ros2Spec& ros2, Ros2PoseInput& input) {
  read_topic(from, input.topic);
  from.choice("type", input.type,
              {{"pose", Ros2PoseType::kPose},
               {"pose_with_covariance", Ros2PoseType::kPoseWithCovariance},
               {"odometry", Ros2PoseType::kOdometry},
               {"tf", Ros2PoseType::kTransforms}});
  from.text("body", input.body);
  if (input.type == Ros2PoseType::kTransforms) {
    if (!input.body.empty()) {
      from.refuse("body", "must be absent with type: tf, whose messages name the bodies");
    }
    if (input.topic == "/tf") {
      from.refuse("topic",
                  "must not be /tf, on which vantage publishes; remap the source to another topic");
    }
    return;
  }
  if (input.body.empty()) {
    from.refuse("body", "is missing; it names the body whose pose the topic contains");
  }
  const auto is_same = [&](const Ros2PoseInput& each) { return each.body == input.body; };
  if (std::any_of(ros2.poses.begin(), ros2.poses.end(), is_same)) {
    from.refuse("body", "must be unique; an earlier topic has the body " + input.body);
  }
}

void read_detection_input(Mapping& from, const Scenario& scenario, Ros2DetectionInput& input) {
  read_topic(from, input.topic);
  from.require("robot");
  from.text("robot", input.robot);
  const RobotSpec* robot = scenario.find_robot(input.robot);
  if (robot == nullptr) {
    from.refuse("robot", "must be the name of a robot, is '" + input.robot + "'");
  }
  if (robot->sensor_publisher != Publisher::kExternal) {
    from.refuse("robot", "has a sensor of vantage: set sensor.device: external for " + input.robot +
                             ", so that two processes do not publish the same channel");
  }
}

template <class Input, class Read>
void read_inputs(Mapping& from, const char* key, std::vector<Input>& inputs, const Read& read) {
  const std::optional<Value> list = from.find(key);
  if (!list) {
    return;
  }
  for (const Value& item : list->items()) {
    Input input;
    read_mapping({item}, [&](Mapping& entry) { read(entry, input); });
    inputs.push_back(std::move(input));
  }
}

bool has_input(const Ros2Spec& ros2, const std::string& topic) {
  const auto is_it = [&](const auto& input) { return input.topic == topic; };
  return std::any_of(ros2.poses.begin(), ros2.poses.end(), is_it) ||
         std::any_of(ros2.detections.begin(), ros2.detections.end(), is_it);
}

void read_trusted(Mapping& from, const SecuritySpec& security, Ros2Spec& ros2) {
  if (const std::optional<Value> list = from.find("trusted_topics")) {
    for (const Value& item : list->items()) {
      ros2.trusted_topics.push_back(item.text());
      if (!has_input(ros2, ros2.trusted_topics.back())) {
        item.refuse("must be a topic of `poses` or `detections`, is '" +
                    ros2.trusted_topics.back() + "'");
      }
    }
  }
  const auto check = [&](const auto& inputs, const char* key) {
    for (const auto& input : inputs) {
      if (std::ranges::count(ros2.trusted_topics, input.topic) == 0) {
        from.refuse(key, fmt::format("topic {} is not signed, but security.mode is require: add "
                                     "it to ros2.trusted_topics, or remove it",
                                     input.topic));
      }
    }
  };
  if (security.mode == SecurityMode::kRequire) {
    check(ros2.poses, "poses");
    check(ros2.detections, "detections");
  }
}

void read_connection(Mapping& from, Ros2Spec& ros2) {
  from.integer("domain", ros2.domain, 0, kDomainMax);
  from.text("interface", ros2.interface);
  const bool is_card = ros2.interface.size() <= kCardNameMax &&
                       std::all_of(ros2.interface.begin(), ros2.interface.end(), [](char c) {
                         return is_letter(c) || is_digit(c) || c == '-' || c == '.';
                       });
  if (!is_card) {
    from.refuse("interface", "must be the name of a network card, is '" + ros2.interface + "'");
  }
  from.text("prefix", ros2.prefix);
  if (!ros2.prefix.empty() && !is_topic(ros2.prefix)) {
    from.refuse("prefix", "must be a ROS 2 name such as /lab, is '" + ros2.prefix + "'");
  }
  from.text("world_frame", ros2.world_frame);
}

}  // namespace

void read_ros2(Mapping& from, const Scenario& scenario, Ros2Spec& ros2) {
  read_connection(from, ros2);
  read_inputs(from, "poses", ros2.poses,
              [&](Mapping& entry, Ros2PoseInput& input) { read_pose_input(entry, ros2, input); });
  read_inputs(from, "detections", ros2.detections, [&](Mapping& entry, Ros2DetectionInput& input) {
    read_detection_input(entry, scenario, input);
  });
  read_trusted(from, scenario.security, ros2);
  if (!ros2.poses.empty() && scenario.mocap.device != DeviceSource::kReal) {
    from.refuse("poses",
                "replace a real motion capture, but mocap is simulated: set mocap.device: "
                "real, so that no other process publishes VICON");
  }
  for (const RobotSpec& robot : scenario.robots) {
    if (is_digit(robot.name.front())) {
      from.refuse("prefix", "robot " + robot.name +
                                " needs another name: names in ROS 2 must not begin with a digit");
    }
  }
}

std::optional<Ros2Spec> ros2_of(const Scenario& scenario) {
  std::optional<Ros2Spec> out;
  if (scenario.source_text.empty()) {
    return out;  // the scenario was not read from a file
  }
  const Value document = parse_yaml(scenario.source_text, scenario.name);
  const Node& top = *document.node;
  const std::size_t entries = top.kind == Node::Kind::kMapping ? top.entry_count() : 0;
  for (std::size_t entry = 0; entry < entries; ++entry) {
    if (top.key(entry).text == "ros2") {
      const Value section = child_of(document, "ros2", top.key(entry), top.value(entry));
      read_mapping({section}, [&](Mapping& from) { read_ros2(from, scenario, out.emplace()); });
    }
  }
  return out;
}

}  // namespace vantage::scenario
