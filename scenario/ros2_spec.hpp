#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// Type of the messages with poses of bodies.
enum class Ros2PoseType {
  kPose,                ///< geometry_msgs/msg/PoseStamped
  kPoseWithCovariance,  ///< geometry_msgs/msg/PoseWithCovarianceStamped
  kOdometry,            ///< nav_msgs/msg/Odometry
  kTransforms,          ///< tf2_msgs/msg/TFMessage
};

/// ROS 2 topic with poses that replace motion capture.
struct Ros2PoseInput {
  std::string topic;
  Ros2PoseType type = Ros2PoseType::kPose;
  std::string body;  ///< name of the body in VICON; empty for kTransforms, which name the bodies
};

/// ROS 2 topic with the detections of a robot (vision_msgs/msg/Detection3DArray).
struct Ros2DetectionInput {
  std::string topic;
  std::string robot;
};

/// Connection of `vantage ros2` to ROS 2 (docs/guide/ros2.md).
struct Ros2Spec {
  int domain = 0;                     ///< ROS_DOMAIN_ID
  std::string interface = "lo";       ///< network card; lo: this host only
  std::string prefix;                 ///< prefix of the robots' topics; empty or "/name"
  std::string world_frame = "world";  ///< name of the world frame in messages
  std::vector<Ros2PoseInput> poses;
  std::vector<Ros2DetectionInput> detections;
  /// Inputs that are accepted although ROS 2 does not sign messages; only required with
  /// SecurityMode::kRequire.
  std::vector<std::string> trusted_topics;
};

}  // namespace vantage::scenario
