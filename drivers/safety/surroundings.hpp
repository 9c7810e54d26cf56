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
  double larger_m = 0.0;  ///< by so much its radius is more than ours
  double went_mps = 0.0;  ///< before it was lost, where nothing makes it stop then
  double age_s = 0.0;
  bool goes_first = true;  ///< before us, where one must yield
  int robot = -1;          ///< which of the scenario's robots it is; −1: none
};

/// Looks along the braking way and at every other body, each braking straight as hard as we do,
/// from what it does and from what it plans to do, whichever is worse; a body not seen lately has
/// a tube around it that widens, and what is larger than we are counts as so much nearer. Allocates
/// nothing.
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
/// inside the fence, when there is none at all.
Eigen::Vector3d landing_spot(const Eigen::Vector3d& hover_m, std::span<const OtherBody> others,
                             const SafetyLimits& limits);

/// True when one to give way to, or a robot that stands, is so near the straight way that going on
/// would bring it nearer than separation_hold_m; robots, and what is not below, as seen from above.
bool is_way_taken(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                  std::span<const OtherBody> others, const SafetyLimits& limits);

/// True when a body lies below `position_m` or beside it, or above it where it is no robot (who
/// walks is as high as he is, down to the ground), nearer than landing_clearance_m and
/// `spare_m` seen from above, and is one to give way to. Around one not seen lately is its tube.
bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                       const SafetyLimits& limits, double spare_m = 0.0);

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
