#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/pose.hpp"

// Vicon's representations of attitude and of the vertical axis.

namespace vantage::wire::vicon {

/// Returns the world-from-body rotation for intrinsic x-y-z angles: R = Rx(a)·Ry(b)·Rz(c), rad.
/// These angles are not roll, pitch and yaw.
/// Source: Vicon DataStream SDK, EulerXYZ.
Quaternion rotation_from_euler_xyz(const Eigen::Vector3d& euler_rad);

/// Returns the angles a, b, c with b in [−π/2, π/2] and a and c in [−π, π]. They reproduce R up to
/// rounding, even at |b| = π/2, where only a ± c is determined.
Eigen::Vector3d euler_xyz_from_rotation(const Quaternion& world_from_body);

/// Returns the rotation nearest to `R`; nullopt if an entry of RᵀR differs from the identity by
/// more than 1e-3, or if R is a reflection (det < 0).
std::optional<Quaternion> rotation_from_matrix(const Eigen::Matrix3d& R);

/// Returns the normalized quaternion; nullopt when its norm differs from 1 by more than 1e-3.
std::optional<Quaternion> rotation_from_xyzw(double x, double y, double z, double w);

/// Converts a pose with y up in world and body to z up in both: (x, y, z) becomes (x, −z, y), and R
/// becomes Rx(90°)·R·Rx(−90°).
Pose3 z_up_from_y_up(const Pose3& pose);
/// Converts a pose with z up to y up: the inverse of z_up_from_y_up().
Pose3 y_up_from_z_up(const Pose3& pose);

}  // namespace vantage::wire::vicon
