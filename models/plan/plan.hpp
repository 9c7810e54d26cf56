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

// The word that planner, vehicles, simulator and logs share: a timed trajectory that ends in a
// hover. Pure functions of it give the pose at any instant; there is no other interpretation.

namespace vantage::models {

/// One piece of constant control and constant deceleration.
struct PlanSegment {
  UnicycleControl control;  ///< at the segment's start
  double duration_s = 0.0;
  /// Forward deceleration; 0 for a primitive, the vehicle's brake for the stop at the end, during
  /// which the yaw rate is 0.
  double brake_mps2 = 0.0;
};

/// Motion from `start` at `start_time`, segment after segment, then hover for ever where they end.
struct Trajectory {
  Time start_time{};
  Pose2 start;  ///< world from body
  double height_m = 0.0;
  std::vector<PlanSegment> segments;
};

/// What is flown at most: so many segments, the stop among them, and so long until the hover.
inline constexpr std::size_t kFlownSegmentsMax = 64;
inline constexpr double kFlownDurationMax_s = 60.0;

/// A state along a trajectory.
struct TrajectoryPoint {
  Pose2 world_from_body;
  UnicycleControl control;  ///< being applied; zero in the hover
};

/// The state at `time`; before the start the start itself at rest, after the end the hover.
TrajectoryPoint at(const Trajectory& trajectory, Time time);
/// When the vehicle has come to rest.
Time end_time(const Trajectory& trajectory);
/// Its way from the start to the hover is no longer than this.
double length_at_most_m(const Trajectory& trajectory);

/// Straight stop from `speed_mps` at `brake_mps2`: one segment; none when already at rest.
std::vector<PlanSegment> brake(double speed_mps, double brake_mps2);

/// Arcs are checked in straight pieces no longer than this.
inline constexpr double kPlanPiece_s = 0.1;

/// True when two trajectories, each swept at its own height, keep at least `separation_m` between
/// them (in space; `from_above`: whatever their heights) at all times from `from` on, hovers
/// included. Conservative: pieces of at most `piece_s` are taken as straight and the sagitta of
/// each arc is subtracted.
bool keeps_separation(const Trajectory& a, const Trajectory& b, Time from, double separation_m,
                      double piece_s = kPlanPiece_s, bool from_above = false);

/// True when a disc of `radius_m` carried along stays clear of every obstacle and inside the
/// bounds at all times from `from` on.
bool is_clear(const World& world, const Trajectory& trajectory, Time from, double radius_m,
              double piece_s = kPlanPiece_s);

}  // namespace vantage::models
