#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "scenario/ros2_spec.hpp"

// Conversion of received ROS 2 messages (bytes) to values. A message that is damaged, or that
// contains impossible numbers, gives nullopt.

namespace vantage::tools::ros2 {

using Bytes = std::span<const std::uint8_t>;

/// Pose of one body in a ROS 2 frame.
struct StampedPose {
  Time stamp{};
  std::string frame;
  std::string child;  ///< frame of the body; empty in messages without it
  Pose3 frame_from_body;
  bool is_possible = true;  ///< false: the numbers are no pose, for example those of a lost body
};

/// Returns the ROS 2 name of a type, such as "geometry_msgs/msg/PoseStamped".
std::string_view type_of(scenario::Ros2PoseType type);

/// Returns the poses of a message: one, or all of kTransforms, where impossible poses are marked.
/// nullopt if the message cannot be read or its only pose is impossible.
std::optional<std::vector<StampedPose>> read_poses(scenario::Ros2PoseType type, Bytes cdr);

/// One object of a Detection3DArray, with the hypothesis of the highest score.
struct SeenObject {
  std::string id;        ///< identity over time; may be empty
  std::string class_id;  ///< class of the detected object; may be empty
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  /// covariance of the position; zero: the sender states none
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

/// Objects that a detector saw at one time, in one frame.
struct SeenObjects {
  Time stamp{};
  std::string frame;
  std::vector<SeenObject> objects;
};

inline constexpr std::string_view kDetectionsType = "vision_msgs/msg/Detection3DArray";

/// Reads a Detection3DArray. The position of an object is that of its best hypothesis; without a
/// hypothesis, the centre of its box.
std::optional<SeenObjects> read_detections(Bytes cdr);

}  // namespace vantage::tools::ros2
