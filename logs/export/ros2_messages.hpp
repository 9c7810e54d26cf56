#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

// Conversion of vantage messages to ROS 2 messages, specified in docs/guide/ros2.md.

namespace vantage::logs::ros2 {

/// One serialised ROS 2 message.
struct Message {
  std::string topic;
  std::string_view type;  ///< "nav_msgs/msg/Path"
  Time valid{};           ///< time for the stamp in the header
  std::string cdr;
};

/// Returns the definition of a type and of all types that it contains, in the format of `ros2msg`
/// schemas. Precondition: to_ros2() produces this type.
std::string definition_of(std::string_view type);

std::vector<Message> to_ros2(const models::MocapFrame& frame);
std::vector<Message> to_ros2(const models::TruthFrame& truth);
std::vector<Message> to_ros2(const models::RobotBelief& belief);
std::vector<Message> to_ros2(const models::RangeScan& scan);
std::vector<Message> to_ros2(const models::RobotMap& map);
std::vector<Message> to_ros2(const models::RobotPlan& plan);
std::vector<Message> to_ros2(const models::VehicleStatus& status);
std::vector<Message> to_ros2(const models::ProcessHealth& health);

}  // namespace vantage::logs::ros2
