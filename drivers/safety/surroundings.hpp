#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "drivers/safety/course.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/limits.hpp"

namespace vantage::drivers {

/// Another body as it was last seen.
struct OtherBody {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();    ///< moved on to now
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();  ///< as measured
  /// What its plan is about to ask of it; as measured when nothing is known. A promise: it may make
  /// things worse, never better.
  Eigen::Vector3d planned_world_mps = Eigen::Vector3d::Zero();
  double brake_mps2 = 0.0;  ///< m/s², deceleration of a robot; 0: as ours
  double larger_m = 0.0;    ///< by so much its radius is more than ours
  double went_mps = 0.0;    ///< before it was lost, where nothing makes it stop then
  double age_s = 0.0;
  bool goes_first = true;  ///< before us, where one must yield
  int robot = -1;          ///< which of the scenario's robots it is; −1: none
};

inline constexpr double kShiftMps = 0.6;  ///< speed at which a landing moves to its spot

/// Measures the distances along the braking path to the fence, obstacles and every other body.
/// Robots brake straight at their own deceleration, from their measured and from their planned
/// velocity, whichever is worse. Every other body goes on at its velocity until we stand, and may
/// leave that straight path by other_turn_mps2 in the plane; it stands on the ground, so all that
/// is beneath its markers counts. A body not seen lately has a tube around it that widens, and what
/// is larger than we are counts as so much nearer. Allocates nothing.
Surroundings look_around(const Eigen::Vector3d& position_m, const BrakeWay& way,
                         std::span<const OtherBody> others, const SafetyLimits& limits);

/// Least distance, seen from above, from `position_m` to a body that moves, or is no robot, within
/// the next `look_s` if each goes on as it does. Robots that stand wait for their turn.
double near_soon_m(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                   double look_s);

/// Where to come down from a hover at `hover_m`: there, or the nearest of some places around from
/// where nothing is below, inside the fence and clear of obstacles, with the way there clear: clear
/// by hover_clearance_m and 0.05 m, or by less when there is no such place. Places are 0.1 m
/// farther from bodies below than is_occupied_below() asks, and they and the way there as far from
/// every robot seen from above, whatever its height, or no nearer than the hover is: whoever flies
/// above comes down, too; from any other body so where it is not below. The hover itself, brought
/// inside the fence, when there is none at all. Bodies other than robots go on as they do, for
/// landing_look_s.
Eigen::Vector3d landing_spot(const Eigen::Vector3d& hover_m, std::span<const OtherBody> others,
                             const SafetyLimits& limits);

/// True when one to give way to, or a robot that stands, is so near the straight way that going on
/// would bring it nearer than separation_hold_m; robots, and what is not below, as seen from above.
/// A body other than a robot goes on meanwhile as it does.
bool is_way_taken(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                  std::span<const OtherBody> others, const SafetyLimits& limits);

/// True when a body lies below `position_m` or beside it, or above it where it is no robot (a
/// person reaches from the markers down to the ground), nearer than landing_clearance_m and
/// `spare_m` seen from above, and is one to give way to. A body other than a robot counts where it
/// will be until the vehicle is down, for `look_s` at most, if it goes on as it does. Around a body
/// not seen lately is its tube.
bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                       const SafetyLimits& limits, double spare_m, double look_s);
/// The same below a vehicle that comes down: for sinking_look_s.
inline bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                              const SafetyLimits& limits, double spare_m = 0.0) {
  return is_occupied_below(position_m, others, limits, spare_m, limits.sinking_look_s);
}

/// True when another robot is, or comes within two seconds straight on, so near seen from above
/// that a climb from `position_m` to `goal_m` would meet it: one higher than we are, and no higher
/// than the goal and separation_hold_m.
bool is_climb_taken(const Eigen::Vector3d& position_m, double goal_m,
                    std::span<const OtherBody> others, const SafetyLimits& limits);

/// Where a vehicle that hovers too near the fence or an obstacle had better hover: the nearest of
/// some places clear of both by hover_clearance_m and 0.05 m, no nearer to other bodies than it
/// should be. Nothing when it is clear by hover_clearance_m already, or no such place is near.
std::optional<Eigen::Vector3d> clear_spot(const Eigen::Vector3d& hover_m,
                                          std::span<const OtherBody> others,
                                          const SafetyLimits& limits);

}  // namespace vantage::drivers
