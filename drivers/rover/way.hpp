#pragma once

#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/plan/plan.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Where a rover shall go next, and how fast.
struct Waypoint {
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  double speed_mps = 0.3;
};

/// The motion from `start` through the way points, standing at each: turns on the spot towards the
/// next at half the vehicle's yaw rate, then drives straight and brakes at the vehicle's brake (no
/// faster than half the way allows to brake from). Way points nearer than 1 cm are passed over.
/// Speeds beyond the vehicle's are cut. Two or three segments a way point.
models::Trajectory way_through(std::span<const Waypoint> waypoints, const Pose2& start,
                               double height_m, Time start_time,
                               const models::VehicleLimits& limits);

}  // namespace vantage::drivers
