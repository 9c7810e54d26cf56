#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

// Conversion of vantage messages to ROS 2 messages, specified in docs/guide/ros2.md.

namespace vantage::logs::ros2 {

/// Name of the world frame in messages.
inline constexpr std::string_view kWorldFrame = "world";

/// One serialised ROS 2 message.
struct Message {
  std::string topic;
  std::string_view type;  ///< "nav_msgs/msg/Path"
  Time valid{};           ///< time for the stamp in the header
  std::string cdr;
};

/// Returns the definition of a type and of all types that it contains, in the format of `ros2msg`
/// schemas. Precondition: kDefinitions contains the type.
std::string definition_of(std::string_view type);

std::vector<Message> to_ros2(const models::MocapFrame& frame, std::string_view world = kWorldFrame);
std::vector<Message> to_ros2(const models::TruthFrame& truth, std::string_view world = kWorldFrame);
std::vector<Message> to_ros2(const models::RobotBelief& belief,
                             std::string_view world = kWorldFrame);
std::vector<Message> to_ros2(const models::RangeScan& scan, std::string_view world = kWorldFrame);
std::vector<Message> to_ros2(const models::RobotMap& map, std::string_view world = kWorldFrame);
std::vector<Message> to_ros2(const models::RobotPlan& plan, std::string_view world = kWorldFrame);
std::vector<Message> to_ros2(const models::VehicleStatus& status,
                             std::string_view world = kWorldFrame);
std::vector<Message> to_ros2(const models::ProcessHealth& health,
                             std::string_view world = kWorldFrame);

/// Returns the belief of each target as an ellipsoid with semi-axes of 2σ on /R/beliefs. The first
/// marker deletes the previous ones.
Message markers_of(const models::RobotBelief& belief, std::string_view world = kWorldFrame);
/// Returns the pose of each visible body of `robots` on /R/pose.
std::vector<Message> poses_of(const models::MocapFrame& frame,
                              const std::vector<std::string>& robots,
                              std::string_view world = kWorldFrame);

}  // namespace vantage::logs::ros2
