#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"

// Conversion between the axes of this stack and of autopilots; no other code converts axes. Here
// the world has z up and bodies have x forward, y left, z up (FLU). An autopilot's local frame is
// this world frame rotated by half a turn about x: x is unchanged (the autopilot's north), y points
// right, z points down (FRD). Body frames are rotated in the same way.

namespace vantage {

/// Returns (x, −y, −z): converts in both directions, for positions, velocities and rates in world
/// and body frames.
inline Eigen::Vector3d convert_axes(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

/// Returns (w, x, −y, −z): converts world_from_body (both FLU) to local_from_body (both FRD), or
/// the reverse.
inline Quaternion convert_axes(const Quaternion& q) { return {q.w(), q.x(), -q.y(), -q.z()}; }

/// Returns the negated yaw or yaw rate, because the z axes of the two conventions are opposite.
inline double convert_yaw(double yaw) { return -yaw; }

}  // namespace vantage
