#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/angle.hpp"
#include "core/linear.hpp"

namespace vantage {

/// A rigid motion of the plane, SE(2): the pose of frame b in frame a, written `a_from_b`.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< counter-clockwise, in (−π, π]

  [[nodiscard]] Eigen::Vector2d position_m() const { return {x_m, y_m}; }
  friend bool operator==(const Pose2&, const Pose2&) = default;
};

/// a_from_c = a_from_b * b_from_c.
Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c);
/// The point `p_b` of frame b, seen from frame a.
Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& p_b);
/// b_from_a.
Pose2 inverse(const Pose2& a_from_b);

/// The pose reached by holding the twist ξ = (v_x, v_y, ω) for unit time; exp of se(2).
/// Source: Solà, Deray, Atchuthan, A micro Lie theory (2018), eq. 156–158.
Pose2 exp_se2(const Eigen::Vector3d& twist);
/// The inverse of exp_se2, with |ω| ≤ π. Source: the same, eq. 159–161.
Eigen::Vector3d log_se2(const Pose2& a_from_b);

/// A rigid motion of space, SE(3).
struct Pose3 {
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Quaternion rotation = Quaternion::Identity();  ///< unit
};

Pose3 operator*(const Pose3& a_from_b, const Pose3& b_from_c);
Eigen::Vector3d operator*(const Pose3& a_from_b, const Eigen::Vector3d& p_b);
Pose3 inverse(const Pose3& a_from_b);

/// exp of se(3) for the twist (ρ, θ), translation first. Source: Solà et al., eq. 172–174.
Pose3 exp_se3(const Eigen::Matrix<double, 6, 1>& twist);
/// The inverse of exp_se3, with ‖θ‖ ≤ π.
Eigen::Matrix<double, 6, 1> log_se3(const Pose3& a_from_b);

/// A level pose at `height_m`: yaw about the vertical, no roll, no pitch.
Pose3 lift(const Pose2& world_from_body, double height_m);
/// Position and heading of `world_from_body` seen from above. The heading is that of the body's
/// x axis; when that axis is vertical it is 0.
Pose2 flatten(const Pose3& world_from_body);

}  // namespace vantage
