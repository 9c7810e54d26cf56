#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

// What the stack says as messages of ROS 2: docs/guide/ros2.md is the contract.

namespace vantage::logs::ros2 {

/// One message of ROS 2, serialised.
struct Message {
  std::string topic;
  std::string_view type;  ///< "nav_msgs/msg/Path"
  Time valid{};           ///< the stamp in its header
  std::string cdr;
};

/// The definition of a type that to_ros2() makes, and of all that it consists of, as `ros2msg`
/// schemas have them. Precondition: it is one of those.
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
