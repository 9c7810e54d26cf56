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

/// Returns the pose after the twist ξ = (v_x, v_y, ω) for unit time: exp of se(2). Source: Solà,
/// Deray, Atchuthan, A micro Lie theory (2018), eq. 156–158.
Pose2 exp_se2(const Eigen::Vector3d& twist);
/// Returns the twist of a pose, with |ω| ≤ π: inverse of exp_se2(). Source: the same, eq. 159–161.
Eigen::Vector3d log_se2(const Pose2& a_from_b);

/// Rigid motion in space, SE(3): pose of frame b in frame a, named `a_from_b`.
struct Pose3 {
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Quaternion rotation = Quaternion::Identity();  ///< unit quaternion
};

Pose3 operator*(const Pose3& a_from_b, const Pose3& b_from_c);
Eigen::Vector3d operator*(const Pose3& a_from_b, const Eigen::Vector3d& p_b);
Pose3 inverse(const Pose3& a_from_b);

/// Returns the pose after the twist (ρ, θ) for unit time: exp of se(3). ρ is the translational and
/// θ the rotational part. Source: Solà et al., eq. 172–174.
Pose3 exp_se3(const Eigen::Matrix<double, 6, 1>& twist);
/// Returns the twist of a pose, with ‖θ‖ ≤ π: inverse of exp_se3().
Eigen::Matrix<double, 6, 1> log_se3(const Pose3& a_from_b);

/// Returns the pose with the position and yaw of `world_from_body` at `height_m`, with zero roll
/// and pitch.
Pose3 lift(const Pose2& world_from_body, double height_m);
/// Returns the horizontal position and the heading of `world_from_body`. The heading is that of the
/// body's x axis; 0 if that axis is vertical.
Pose2 flatten(const Pose3& world_from_body);

}  // namespace vantage
