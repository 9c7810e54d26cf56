#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/motion/unicycle.hpp"
#include "models/motion/vehicle_limits.hpp"
#include "models/world/world.hpp"

// Timed trajectory that ends in a hover, shared by planner, vehicles, simulator and logs. Pure
// functions of the trajectory give the pose at any time; there is no other interpretation.

namespace vantage::models {

/// Trajectory segment with constant control and constant deceleration.
struct PlanSegment {
  UnicycleControl control;  ///< at the segment's start
  double duration_s = 0.0;
  /// Forward deceleration: 0 for a primitive, the vehicle's brake for the final stop. The yaw rate
  /// is 0 during the stop.
  double brake_mps2 = 0.0;
};

/// Motion from `start` at `start_time` through all segments, then a permanent hover at the end.
struct Trajectory {
  Time start_time{};
  Pose2 start;  ///< world from body
  double height_m = 0.0;
  std::vector<PlanSegment> segments;
};

/// Limits of a trajectory that a vehicle accepts: number of segments including the stop, and time
/// until the hover.
inline constexpr std::size_t kFlownSegmentsMax = 64;
inline constexpr double kFlownDurationMax_s = 60.0;

/// State at one time of a trajectory.
struct TrajectoryPoint {
  Pose2 world_from_body;
  UnicycleControl control;  ///< current control; zero in the hover
};

/// Returns the state at `time`: the start pose with zero control before the start, the hover after
/// the end.
TrajectoryPoint at(const Trajectory& trajectory, Time time);
/// Returns the time at which the hover begins.
Time end_time(const Trajectory& trajectory);
/// Returns an upper bound of the path length from the start to the hover, m.
double length_at_most_m(const Trajectory& trajectory);

/// Returns the straight stop from `speed_mps` at `brake_mps2`: one segment, or none at speed 0.
std::vector<PlanSegment> brake(double speed_mps, double brake_mps2);

/// Longest duration of the straight pieces in which arcs are checked.
inline constexpr double kPlanPiece_s = 0.1;

/// True if two trajectories, each at its own height, keep at least `separation_m` between them at
/// all times from `from` on, hovers included. The distance is in space, or horizontal if
/// `from_above`. Conservative: pieces of at most `piece_s` are treated as straight, and the sagitta
/// of each arc is subtracted.
bool keeps_separation(const Trajectory& a, const Trajectory& b, Time from, double separation_m,
                      double piece_s = kPlanPiece_s, bool from_above = false);

/// True if a disc of `radius_m` along the trajectory stays clear of every obstacle and inside the
/// bounds at all times from `from` on.
bool is_clear(const World& world, const Trajectory& trajectory, Time from, double radius_m,
              double piece_s = kPlanPiece_s);

}  // namespace vantage::models
