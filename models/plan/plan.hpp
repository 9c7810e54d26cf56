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

// The timed trajectory that planner, vehicles, simulator and logs share; it ends in a hover. Pure
// functions return the pose at any time, so that all programs interpret a trajectory in the same
// way.

namespace vantage::models {

/// One segment of constant control and constant deceleration.
struct PlanSegment {
  UnicycleControl control;  ///< speed at the segment's start
  double duration_s = 0.0;
  /// m/s²; forward deceleration: 0 for a primitive. The stop at the end has the vehicle's brake
  /// deceleration and zero yaw rate.
  double brake_mps2 = 0.0;
};

/// A motion from `start` at `start_time` along the segments, with a permanent hover at their end.
struct Trajectory {
  Time start_time{};
  Pose2 start;  ///< world from body
  double height_m = 0.0;
  std::vector<PlanSegment> segments;
};

/// Limits of a flown trajectory: number of segments including the stop, and time until the hover.
inline constexpr std::size_t kFlownSegmentsMax = 64;
inline constexpr double kFlownDurationMax_s = 60.0;

/// State at one time of a trajectory.
struct TrajectoryPoint {
  Pose2 world_from_body;
  UnicycleControl control;  ///< control applied at this time; zero in the hover
};

/// Returns the state at `time`: stationary at the start pose before the start time, hovering after
/// the end.
TrajectoryPoint at(const Trajectory& trajectory, Time time);
/// Returns the time at which the vehicle has stopped.
Time end_time(const Trajectory& trajectory);
/// Returns an upper bound of the path length from the start to the hover, m.
double length_at_most_m(const Trajectory& trajectory);

/// Returns a straight stop from `speed_mps` at `brake_mps2`: one segment; none at zero speed.
std::vector<PlanSegment> brake(double speed_mps, double brake_mps2);

/// Longest piece of an arc that is checked as a straight line, s.
inline constexpr double kPlanPiece_s = 0.1;

/// True if two trajectories, each at its own height, keep at least `separation_m` in space at all
/// times from `from` on, hovers included. If `ignore_height`, only horizontal distances count.
/// Conservative: pieces of at most `piece_s` are treated as straight, and the sagitta of each arc
/// is subtracted.
bool keeps_separation(const Trajectory& a, const Trajectory& b, Time from, double separation_m,
                      double piece_s = kPlanPiece_s, bool ignore_height = false);

/// True if a disc of `radius_m` that follows the trajectory stays clear of all obstacles and inside
/// the bounds at all times from `from` on.
bool is_clear(const World& world, const Trajectory& trajectory, Time from, double radius_m,
              double piece_s = kPlanPiece_s);

}  // namespace vantage::models
