#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"

// The one place where axes are turned. The stack's world has z up, its bodies x forward, y left,
// z up (FLU). An autopilot's local frame is the same world turned by half a revolution about x:
// x as ours, y to the right, z down (FRD; what it calls north is our x). Bodies likewise.

namespace vantage {

/// (x, −y, −z): either way, for positions, velocities and rates, of worlds and of bodies.
inline Eigen::Vector3d turn_axes(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

/// local_from_body (both FRD) of world_from_body (both FLU), or the reverse: (w, x, −y, −z).
inline Quaternion turn_axes(const Quaternion& q) { return {q.w(), q.x(), -q.y(), -q.z()}; }

/// A yaw or yaw rate, which turns the other way seen along an axis that points down.
inline double turn_yaw(double yaw) { return -yaw; }

}  // namespace vantage
