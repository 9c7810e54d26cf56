#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/pose.hpp"

// Vicon's ways to write an attitude and a world.

namespace vantage::wire::vicon {

/// World-from-body for intrinsic x-y-z angles: R = Rx(a)·Ry(b)·Rz(c), rad. Not roll-pitch-yaw.
/// Source: Vicon DataStream SDK, EulerXYZ.
Quaternion rotation_from_euler_xyz(const Eigen::Vector3d& euler_rad);

/// An inverse: b in [−π/2, π/2], a and c in [−π, π]. R(result) = R to rounding everywhere, also
/// where |b| = π/2 and only a ± c is determined.
Eigen::Vector3d euler_xyz_from_rotation(const Quaternion& world_from_body);

/// The rotation nearest to `R`; nullopt when R is not one to within 1e-3 an entry of RᵀR, or turns
/// hands (det < 0).
std::optional<Quaternion> rotation_from_matrix(const Eigen::Matrix3d& R);

/// `q` made unit; nullopt when its norm is not 1 to within 1e-3.
std::optional<Quaternion> rotation_from_xyzw(double x, double y, double z, double w);

/// A pose written in a world and a body with y up, in the world and body with z up:
/// (x, y, z) becomes (x, −z, y) and R becomes Rx(90°)·R·Rx(−90°).
Pose3 z_up_from_y_up(const Pose3& pose);
/// The inverse.
Pose3 y_up_from_z_up(const Pose3& pose);

}  // namespace vantage::wire::vicon
