#pragma once

#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/plan/plan.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Next position of a rover, and the speed of the motion towards it.
struct Waypoint {
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  double speed_mps = 0.3;
};

/// Returns the motion from `start` through the way points, with a stop at each. The rover turns in
/// place towards the next one at half the vehicle's yaw rate, then drives straight and brakes at
/// the vehicle's deceleration. The speed is limited so that the rover can brake within half the
/// distance. Way points closer than 1 cm are skipped, and speeds are limited to the vehicle's. The
/// result has two or three segments per way point.
models::Trajectory waypoint_trajectory(std::span<const Waypoint> waypoints, const Pose2& start,
                                       double height_m, Time start_time,
                                       const models::VehicleLimits& limits);

}  // namespace vantage::drivers
