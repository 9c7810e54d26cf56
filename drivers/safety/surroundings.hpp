#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "drivers/safety/course.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/limits.hpp"

namespace vantage::drivers {

/// Another body, extrapolated from its last observation.
struct OtherBody {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();    ///< m; extrapolated to now
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();  ///< m/s; measured velocity
  /// m/s; velocity that its plan will command next, or the measured velocity if it has no plan. The
  /// prediction uses the velocity that brings the body nearer.
  Eigen::Vector3d planned_world_mps = Eigen::Vector3d::Zero();
  double brake_mps2 = 0.0;       ///< m/s²; braking deceleration of a robot; 0: as this vehicle
  double excess_radius_m = 0.0;  ///< m, ≥ 0; excess of its radius over this vehicle's radius
  /// m/s; last measured speed of a body other than a robot; 0 for robots, which stop without poses
  double last_speed_mps = 0.0;
  double age_s = 0.0;
  bool has_priority = true;  ///< the body has priority over this vehicle
  int robot = -1;            ///< index among the scenario's robots; −1: no robot
};

inline constexpr double kShiftMps = 0.6;  ///< m/s; horizontal speed towards a landing spot

/// Measures the distances along the braking path to the fence, obstacles and every other body.
/// Robots brake straight at their own deceleration, from the measured or the planned velocity,
/// whichever is worse. Every other body keeps its velocity until this vehicle stops, and may leave
/// its straight path with the horizontal acceleration other_turn_mps2. Such a body is assumed to
/// reach down to the ground: the space below its markers counts as occupied. The uncertainty radius
/// of a body grows while the body is not seen. A radius larger than this vehicle's reduces the
/// distance by the excess. Allocates no memory.
Surroundings compute_surroundings(const Eigen::Vector3d& position_m, const BrakingPath& path,
                                  std::span<const OtherBody> others, const SafetyLimits& limits);

/// Returns the minimum horizontal distance within the next `prediction_s` from `position_m` to the
/// other bodies, each at constant velocity and minus its excess radius. Stationary robots are
/// ignored: they wait for their turn to lift.
double predicted_distance_m(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                            double prediction_s);

/// Returns the landing spot for a hover at `hover_m`: the hover itself, moved inside the fence if
/// necessary, or the nearest of a set of positions around it. A spot is inside the fence, with no
/// body below and a clear path to it. If no spot is found, returns the hover, moved inside the
/// fence.
///
/// Positions around the hover that are clear of fence and obstacles by hover_clearance_m + 0.05 m
/// are preferred to closer ones. A spot is 0.1 m farther from bodies below than is_occupied_below()
/// requires. Spot and path keep this horizontal distance from every robot at any height, since a
/// robot above may land as well. The path keeps separation_hold_m from other bodies, measured
/// horizontally unless they are below. A path that begins closer to a body must not come closer.
/// Bodies other than robots are predicted at constant velocity for landing_prediction_s.
Eigen::Vector3d landing_spot(const Eigen::Vector3d& hover_m, std::span<const OtherBody> others,
                             const SafetyLimits& limits);

/// True if the vehicle's distance to a body with priority or to a stationary robot falls below
/// separation_hold_m, and below its present value, along the straight path. Distances to robots,
/// and to bodies that are not below the vehicle, are horizontal. Bodies other than robots are
/// assumed to keep their velocity.
bool is_path_blocked(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                     std::span<const OtherBody> others, const SafetyLimits& limits);

/// True if a body blocks a landing at `position_m`: its horizontal distance is less than the sum of
/// landing_clearance_m, `spare_m`, its uncertainty radius and its excess radius. A robot blocks
/// only if it is below, or if it is at the same height and has priority. Other bodies block at any
/// height, since a person occupies the space from the markers to the ground. Their motion is
/// predicted at constant velocity until touchdown, for at most `prediction_s`.
bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                       const SafetyLimits& limits, double spare_m, double prediction_s);
/// Overload for a descending vehicle; predicts for descent_prediction_s.
inline bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                              const SafetyLimits& limits, double spare_m = 0.0) {
  return is_occupied_below(position_m, others, limits, spare_m, limits.descent_prediction_s);
}

/// True if another robot blocks a climb from `position_m` to `goal_m`: the robot is too close
/// horizontally now, or comes too close within two seconds at constant velocity. Only robots above
/// `position_m` and below `goal_m` + separation_hold_m count.
bool is_climb_blocked(const Eigen::Vector3d& position_m, double goal_m,
                      std::span<const OtherBody> others, const SafetyLimits& limits);

/// Returns a better hover position for a vehicle that hovers too close to the fence or an obstacle:
/// the nearest of a set of positions clear of both by hover_clearance_m + 0.05 m and with enough
/// distance to other bodies. nullopt if the vehicle is clear by hover_clearance_m, or if there is
/// no such position nearby.
std::optional<Eigen::Vector3d> clear_spot(const Eigen::Vector3d& hover_m,
                                          std::span<const OtherBody> others,
                                          const SafetyLimits& limits);

}  // namespace vantage::drivers
