#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/angle.hpp"
#include "core/linear.hpp"

namespace vantage {

/// Rigid motion in the plane, SE(2): pose of frame b in frame a, named `a_from_b`.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< counter-clockwise, in (−π, π]

  [[nodiscard]] Eigen::Vector2d position_m() const { return {x_m, y_m}; }
  friend bool operator==(const Pose2&, const Pose2&) = default;
};

/// Returns a_from_c = a_from_b * b_from_c.
Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c);
/// Returns the coordinates in frame a of the point `p_b` given in frame b.
Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& p_b);
/// Returns b_from_a.
Pose2 inverse(const Pose2& a_from_b);

/// Rigid motion in space, SE(3): pose of frame b in frame a, named `a_from_b`.
struct Pose3 {
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Quaternion rotation = Quaternion::Identity();  ///< unit quaternion
};

Pose3 operator*(const Pose3& a_from_b, const Pose3& b_from_c);
Eigen::Vector3d operator*(const Pose3& a_from_b, const Eigen::Vector3d& p_b);
Pose3 inverse(const Pose3& a_from_b);

/// Returns the pose with the position and yaw of `world_from_body` at `height_m`, with zero roll
/// and pitch.
Pose3 lift(const Pose2& world_from_body, double height_m);
/// Returns the horizontal position and the heading of `world_from_body`. The heading is the
/// direction of the body's x axis; 0 if this axis is vertical.
Pose2 flatten(const Pose3& world_from_body);

}  // namespace vantage
