#include "drivers/safety/take_off.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/angle.hpp"
#include "drivers/safety/surroundings.hpp"

namespace vantage::drivers {
namespace {

constexpr double kClimbedM = 0.15;    // m; the climb ends at this distance from its goal
constexpr double kClimbSlackS = 5.0;  // s; a climb ends this long after twice its expected time

}  // namespace

void TakeOff::begin(GuardCore& core, HeightState& height, Time now) {
  lift_.begin(core.pose().world_from_body(), core.bodies(now), core.limits(), now);
  queue_.begin_own();
  height.command_m = climb_from_m_ = lift_.rest_m();
  height.goal_m = lift_.height_m();
  is_climbing_ = true;
  climb_since_ = now;
}

void TakeOff::end() {
  lift_.end();
  is_climbing_ = false;
}

void TakeOff::step(GuardCore& core, HeightState& height, Time now) {
  const SafetyLimits& limits = core.limits();
  const SafetyInputs& in = core.inputs();
  if (is_lifting() && in.pose_age_s <= limits.pose_age_warn_s) {
    const Pose3& body = core.pose().world_from_body();
    if (lift_.step(body.translation_m, flatten(body).yaw_rad, core.course(), limits, now)) {
      has_flown_ = true;
      height.goal_m = limits.take_off_height_m;
      climb_since_ = now;
    }
  } else if (is_climbing_ && !is_lifting()) {
    const double climb_s = (height.goal_m - climb_from_m_) / limits.climb_mps;
    is_climbing_ = std::abs(in.height_m - height.goal_m) > kClimbedM &&
                   to_seconds(now - climb_since_) < kClimbSlackS + 2.0 * climb_s;
  }
}

bool TakeOff::is_waiting(GuardCore& core, const HeightState& height, Time now) {
  const bool climbs_on = is_climbing_ && !is_lifting() && height.command_m < height.goal_m;
  if (!climbs_on ||
      !is_climb_blocked(core.position_m(now), height.goal_m, core.bodies(now), core.limits())) {
    return false;
  }
  climb_since_ = now;  // the time limit of the climb starts again
  return true;
}

double TakeOff::height_error_m(double at_m, double goal_m) const {
  return std::max({0.0, climb_from_m_ - at_m, at_m - goal_m});
}

void TakeOff::update_inputs(GuardCore& core, const AutopilotReport& report,
                            std::span<const OtherBody> bodies, Time now) {
  SafetyInputs& in = core.inputs();
  const SafetyLimits& limits = core.limits();
  const Eigen::Vector3d here_m = core.position_m(now);
  if (core.pose().has_pose()) {
    in.near_m = predicted_distance_m(here_m, bodies, limits.take_off_prediction_s);
    if (std::exchange(had_motors_, in.autopilot_armed) != in.autopilot_armed) {
      queue_.begin_turn(now);  // another vehicle's motors may have started or stopped, too
    }
    queue_.update(bodies, limits, now);
  }
  compare_start(core);
  const bool is_armed_on_ground =
      core.state() == models::FlightState::kIdle && core.ladder().wants_armed && in.autopilot_armed;
  unarmed_height_m_ = is_armed_on_ground ? unarmed_height_m_ : in.height_m;
  const bool has_recent_pose = in.pose_age_s <= limits.pose_age_hold_s;
  in.unordered_rise_m =
      is_armed_on_ground && has_recent_pose ? in.height_m - unarmed_height_m_ : 0.0;
  in.is_lift_blocked = queue_.is_blocked();
  in.no_rise_s = lift_.no_rise_s(here_m, limits, now);
  in.proof_pending_s = lift_.proof_pending_s(now);
  in.other_risen_m = in.no_rise_s > 0.0 ? queue_.other_risen_m() : 0.0;
  compare_lift(core, report, now);
}

// On-board sensors cannot detect a rotated mocap frame, so the start pose is compared with the
// scenario.
void TakeOff::compare_start(GuardCore& core) const {
  SafetyInputs& in = core.inputs();
  const std::optional<Pose2>& start = core.limits().start;
  in.start_off_m = in.start_turn_rad = 0.0;
  if (start && core.pose().has_pose() && !has_flown_) {
    const Pose2 here = flatten(core.pose().world_from_body());
    in.start_off_m = (here.position_m() - start->position_m()).norm();
    in.start_turn_rad = std::abs(wrap_to_pi(here.yaw_rad - start->yaw_rad));
  }
}

// Compares the lift with its path, and the rates by mocap with those of the autopilot.
void TakeOff::compare_lift(GuardCore& core, const AutopilotReport& report, Time now) const {
  SafetyInputs& in = core.inputs();
  const SafetyLimits& limits = core.limits();
  const PoseMonitor& pose = core.pose();
  const bool has_recent_pose = in.pose_age_s <= limits.pose_age_hold_s;
  const Eigen::Vector3d here_m = core.position_m(now);
  const Eigen::Vector3d soon_m = here_m + limits.reaction_s * pose.velocity_world_mps();
  in.lift_deviation_m =
      has_recent_pose ? std::max(lift_.deviation_m(here_m), lift_.deviation_m(soon_m)) : 0.0;
  in.lift_climb_error_mps = in.lift_turn_error_radps = 0.0;
  if (is_lifting() && has_recent_pose && report.has_position &&
      in.telemetry_age_s <= limits.telemetry_age_hold_s) {
    in.lift_climb_error_mps =
        std::abs(report.velocity_world_mps.z() - pose.velocity_world_mps().z());
    in.lift_turn_error_radps = std::abs(report.yaw_rate_radps - pose.turn_radps());
  }
}

}  // namespace vantage::drivers
