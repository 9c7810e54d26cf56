#include "drivers/safety/landing.hpp"

#include <algorithm>

#include "drivers/safety/surroundings.hpp"

namespace vantage::drivers {
namespace {

// s; after this time a landing descends even if the vehicle is not over its spot
constexpr double kShiftPatienceS = 6.0;
// s; after this time a landing descends even if a body is below
constexpr double kAvoidPatienceS = 20.0;
// m; a landing that begins below this height does not wait and does not move aside
constexpr double kCommitM = 0.35;
constexpr double kOverSpotM = 0.25;
// m; largest distance of the set-point below the vehicle
constexpr double kSetpointBelowMaxM = 0.5;
// assumed share of the descent rate while no measurement is available
constexpr double kBlindSinkShare = 0.4;

}  // namespace

void Landing::begin(GuardCore& core, HeightState& height, Time now) {
  core.course().forget_next();
  since_ = spot_since_ = now;
  has_spot_ = false;
  is_sinking_ = false;
  // Near the ground, an immediate descent is the shortest landing.
  height.command_m = height.goal_m = std::min(height.command_m, core.inputs().height_m);
  is_committed_ = core.inputs().height_m < kCommitM;
}

void Landing::step(GuardCore& core, HeightState& height, bool is_blind, double dt_s, Time now) {
  const SafetyLimits& limits = core.limits();
  const SafetyInputs& in = core.inputs();
  const Course& course = core.course();
  const bool has_recent_pose = in.pose_age_s <= limits.pose_age_hold_s;
  const bool was_committed = is_committed_;
  is_committed_ = is_committed_ || (is_sinking_ && in.height_m < limits.safe_height_m) ||
                  to_seconds(now - since_) > kAvoidPatienceS;
  View view{core.position_m(now), course.at(now).position_world_m, core.bodies(now)};
  view.hover_m.z() = view.here_m.z();
  view.is_below_us = is_occupied_below(view.here_m, view.bodies, limits);
  view.is_free = !view.is_below_us && !is_occupied_below(view.hover_m, view.bodies, limits);
  if (is_committed_) {
    if (!was_committed && !course.is_hovering(now)) {
      core.course().stop(core.braking_path(now, 0.0), now);
    }
  } else if (has_recent_pose) {
    seek_spot(core, view, now);
  }
  const Eigen::Vector3d off_m = view.here_m - course.at(now).position_world_m;
  const bool is_there =
      course.is_hovering(now) && (has_spot_ || !has_recent_pose) &&
      (off_m.head<2>().norm() < kOverSpotM || to_seconds(now - spot_since_) > kShiftPatienceS);
  if ((is_there && view.is_free) || is_committed_ || is_blind) {
    sink(core, height, dt_s);
  } else if (is_sinking_) {
    is_sinking_ = false;
    // Stops the descent here: the commanded height may be below the vehicle.
    height.command_m = std::max(height.command_m, in.height_m);
  }
}

// Moves the hover to a free spot; stops a motion on a blocked path.
void Landing::seek_spot(GuardCore& core, const View& view, Time now) {
  Course& course = core.course();
  if (!course.is_hovering(now)) {
    const Eigen::Vector3d level_spot_m(spot_m_.x(), spot_m_.y(), view.here_m.z());
    if (has_spot_ && is_path_blocked(view.hover_m, level_spot_m, view.bodies, core.limits())) {
      course.stop(core.braking_path(now, 0.0), now);
      has_spot_ = false;
    }
  } else if (!has_spot_ || !view.is_free) {
    const Eigen::Vector3d commanded_m = course.at(now).position_world_m;
    spot_m_ =
        landing_spot(view.is_below_us ? view.here_m : view.hover_m, view.bodies, core.limits());
    spot_m_.z() = commanded_m.z();
    if ((spot_m_ - commanded_m).norm() > 1e-6) {
      course.shift(spot_m_, kShiftMps, now);
      spot_since_ = now;
    }
    has_spot_ = true;
  }
}

void Landing::sink(const GuardCore& core, HeightState& height, double dt_s) {
  const SafetyLimits& limits = core.limits();
  is_sinking_ = true;
  // goal below the floor: contact with the ground ends the descent
  height.goal_m = -limits.descent_mps;
  const bool is_low = height.command_m < limits.low_height_m;
  const double sink_m = (is_low ? limits.low_descent_mps : limits.descent_mps) * dt_s;
  height.command_m = std::max(
      {height.goal_m, height.command_m - sink_m, core.inputs().height_m - kSetpointBelowMaxM});
  height.unmeasured_m = std::max(0.0, height.unmeasured_m - kBlindSinkShare * sink_m);
}

}  // namespace vantage::drivers
