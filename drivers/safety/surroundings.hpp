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
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();    ///< extrapolated to now
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();  ///< as measured
  /// Velocity that its plan will command next; the measured one when no plan is known. It can only
  /// make the prediction worse, never better.
  Eigen::Vector3d planned_world_mps = Eigen::Vector3d::Zero();
  double brake_mps2 = 0.0;       ///< m/s²; deceleration of a robot; 0: as ours
  double excess_radius_m = 0.0;  ///< m; excess of its radius over ours, ≥ 0
  /// m/s; speed when last seen of a body that does not stop when lost; 0 for robots
  double last_speed_mps = 0.0;
  double age_s = 0.0;
  bool has_priority = true;  ///< over this vehicle
  int robot = -1;            ///< index among the scenario's robots; −1: no robot
};

inline constexpr double kShiftMps = 0.6;  ///< m/s; speed of a landing towards its spot

/// Measures the distances along the braking path to the fence, obstacles and every other body.
/// Robots brake straight at their own deceleration, from the measured or the planned velocity,
/// whichever is worse. Every other body keeps its velocity until this vehicle stops, and may leave
/// its straight path by other_turn_mps2 horizontally. It is assumed to stand on the ground: the
/// space below its markers counts as occupied. The uncertainty radius of a body grows while it is
/// not seen. A larger radius than ours reduces the distance by the excess. Allocates nothing.
Surroundings compute_surroundings(const Eigen::Vector3d& position_m, const BrakingPath& path,
                                  std::span<const OtherBody> others, const SafetyLimits& limits);

/// Returns the least horizontal distance within the next `prediction_s` from `position_m` to the
/// other bodies, each at constant velocity and less its excess radius. Standing robots are ignored:
/// they wait for their turn.
double predicted_distance_m(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                            double prediction_s);

/// Returns the landing spot for a hover at `hover_m`: the hover itself, moved inside the fence if
/// necessary, or the nearest of a set of positions around it. A spot is inside the fence, has
/// nothing below and has a clear path. If there is none, returns the hover, moved inside the fence.
///
/// Positions around the hover that are clear of fence and obstacles by hover_clearance_m + 0.05 m
/// are preferred to closer ones. A spot is 0.1 m farther from bodies below than is_occupied_below()
/// requires. Spot and path keep this distance horizontally from every robot at any height, since a
/// robot above may land as well. From other bodies the path keeps separation_hold_m, horizontally
/// unless they are below. The path may begin closer to a body, but must not come closer still.
/// Bodies other than robots are predicted at constant velocity for landing_prediction_s.
Eigen::Vector3d landing_spot(const Eigen::Vector3d& hover_m, std::span<const OtherBody> others,
                             const SafetyLimits& limits);

/// True if the straight path leads closer than separation_hold_m to a body that has priority or to
/// a standing robot, and closer than now. Robots, and bodies that are not below, are compared
/// horizontally. Bodies other than robots keep their velocity meanwhile.
bool is_path_blocked(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                     std::span<const OtherBody> others, const SafetyLimits& limits);

/// True if a body that blocks the landing is horizontally closer to `position_m` than
/// landing_clearance_m + `spare_m` and its uncertainty. Robots block when they are below, or at the
/// same height with priority. Other bodies block at any height, since a person reaches from the
/// markers down to the ground. They are predicted at constant velocity until touchdown, for at most
/// `prediction_s`.
bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                       const SafetyLimits& limits, double spare_m, double prediction_s);
/// The same below a descending vehicle, with descent_prediction_s.
inline bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                              const SafetyLimits& limits, double spare_m = 0.0) {
  return is_occupied_below(position_m, others, limits, spare_m, limits.descent_prediction_s);
}

/// True if another robot would meet a climb from `position_m` to `goal_m`: it is too close
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
