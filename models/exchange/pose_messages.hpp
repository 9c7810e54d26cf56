#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"

// Messages about the robots' own motion and poses, as values.

namespace vantage::models {

enum class OdometryKind {
  kIncrement,  ///< displacement in an interval
  kCommand,    ///< commanded velocity until the next message
};

/// Motion of one robot as measured by its odometer, or as commanded (ODOMETRY_R).
struct OdometryReport {
  Stamp stamp;
  std::string robot;
  OdometryKind kind = OdometryKind::kIncrement;
  Duration interval{};  ///< duration of the increment, which ends at stamp.time; 0 for a command
  /// Forward, left and turn in the body frame. An increment [m, m, rad] uses the frame at the start
  /// of the interval; a command is a velocity [m/s, m/s, rad/s].
  Eigen::Vector3d motion_body = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< covariance of motion_body
};

enum class PoseSource { kNone, kMotionCapture, kLocalizer };

/// Range and bearing of one identified landmark or teammate.
struct Sighting {
  Time time{};  ///< time of the measurement; in PoseEstimate corrected for the camera's latency
  int id = 0;   ///< id of the landmark or teammate in the scenario's section localizer
  double range_m = 0.0;
  double bearing_rad = 0.0;
};

/// Landmarks and teammates that one robot's sensor identified in one frame (SIGHTINGS_R). The times
/// are those of the sensor's stamps.
struct SightingReport {
  Stamp stamp;
  std::string robot;
  std::vector<Sighting> sightings;  ///< ascending in time
};

/// Pose of one robot (POSE_R), with the newest motion and sightings for its teammates.
struct PoseEstimate {
  Stamp stamp;
  std::string robot;
  PoseSource source = PoseSource::kNone;  ///< kNone: the pose is unknown and meaningless
  Pose2 world_from_body;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< covariance of x, y and yaw
  double age_s = 0.0;  ///< s; time since the newest observation of a landmark, a teammate or mocap
  Time increments_from{};
  Duration increment{};  ///< duration of each increment
  /// Forward [m], left [m] and turn [rad], in the body frame at the start of each increment.
  std::vector<Eigen::Vector3d> increments;
  std::vector<Sighting> sightings;  ///< ascending in time
  std::int64_t step = 0;            ///< number of earlier poses since the localizer's start
  std::vector<InputRef> inputs;     ///< inputs of this step in the order of use
};

}  // namespace vantage::models
