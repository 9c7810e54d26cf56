#include "drivers/safety/guard_core.hpp"

#include <cmath>

#include "drivers/safety/latches.hpp"
#include "drivers/safety/surroundings.hpp"

namespace vantage::drivers {

using models::FlightState;
using models::OperatorAction;

namespace {

// m/s; maximum velocity error in normal motion; above it an external push is assumed
constexpr double kVelocityErrorMaxMps = 0.6;
constexpr double kSameSpeedMps = 0.1;  // m/s; speeds that differ by less count as equal

}  // namespace

bool GuardCore::on_mocap(const models::MocapFrame& frame, BodyContext context, bool is_armed,
                         Time now, double pose_sigma_m) {
  const MocapSource::Standing standing = source_.judge(frame, now);
  if (standing == MocapSource::Standing::kRefused) {
    return false;
  }
  NamedBody found = find_unique(frame, name_);
  if (pose_sigma_m > 0.0) {
    ++(limits_.moves_by_estimate ? estimates_used_ : estimates_refused_);
    found.body = limits_.moves_by_estimate ? found.body : nullptr;
  }
  // A source that takes over after arming must agree with the predicted pose of the vehicle.
  const bool is_candidate = standing == MocapSource::Standing::kCandidate;
  context.in_air = context.in_air || (is_candidate && is_armed);
  PoseMonitor judged = pose_;
  PoseVerdict verdict = PoseVerdict::kDuplicate;
  if (found.is_unique) {
    verdict = judged.judge(found.body, context, limits_, now);
  }
  ++pose_counts_[static_cast<std::size_t>(verdict)];
  pose_verdict_ = verdict;
  if (is_candidate) {
    if (verdict != PoseVerdict::kAccepted) {
      return false;
    }
    source_.confirm(frame, now);
  }
  pose_ = judged;
  if (verdict == PoseVerdict::kAccepted) {
    pose_sigma_m_ = pose_sigma_m;
  }
  clocks_set_ += clock_.on_frame(frame, now) ? 0 : 1;
  fleet_.on_mocap(frame, limits_, now);
  return true;
}

PlanVerdict GuardCore::on_plan(const models::RobotPlan& plan, bool may_take, double height_m,
                               Time now) {
  HeldPlan held;
  const PlanVerdict verdict = plans_.judge(
      plan, {may_take, course_, height_m, fleet_.courses(now, limits_)}, limits_, now, held);
  if (verdict == PlanVerdict::kAccepted) {
    course_.follow(held, now);
  }
  return verdict;
}

bool GuardCore::admits(const models::OperatorCommand& command, Time now) {
  if (authority_.admit(command, now, limits_.operator_age_hold_s)) {
    return true;
  }
  commands_refused_ += is_ours(command) && command.action != OperatorAction::kHeartbeat ? 1 : 0;
  return false;
}

std::optional<CommandVerdict> GuardCore::execute_if_stateless(
    const models::OperatorCommand& command) {
  if (!is_ours(command)) {
    return CommandVerdict::kOtherRobot;
  }
  if (command.action == OperatorAction::kEmergencyStop) {
    emergency_stop_ = true;
    return CommandVerdict::kObeyed;
  }
  if (command.action == OperatorAction::kHeartbeat) {
    return CommandVerdict::kObeyed;
  }
  return std::nullopt;
}

CommandVerdict GuardCore::request_action(OperatorAction action) {
  if (!request_ || static_cast<int>(action) > static_cast<int>(*request_)) {
    request_ = action;
  }
  return CommandVerdict::kObeyed;
}

void GuardCore::update_common_inputs(Time now) {
  in_.now = now;
  in_.since_last_tick_s = has_ticked_ ? to_seconds(now - last_tick_) : 0.0;
  in_.processor_wait_s = processor_wait_s_;
  in_.pose_age_s = pose_.age_s(now);
  in_.pose_latency_s = clock_.latency_s();
  in_.pose_sigma_m = pose_sigma_m_;
  in_.poses_rejected = pose_.rejected_in_row();
  in_.poses_accepted = pose_.accepted_in_row();
  course_.report(now, in_);
  plans_.report(now, limits_, in_);
  in_.map_differs = map_differs_;
  in_.other_version_age_s = time_since_s(other_version_at_, now);
  in_.operator_age_s = authority_.age_s(now);
  in_.emergency_stop = emergency_stop_;
  in_.is_ending = is_ending_;
  in_.request = request_;
}

void GuardCore::update_surroundings(std::span<const OtherBody> bodies, Time now) {
  if (pose_.has_pose()) {
    static_cast<Surroundings&>(in_) = compute_surroundings(
        position_m(now), braking_path(now, limits_.reaction_s), bodies, limits_);
    const double margin_m = limits_.pose_sigma_margin * pose_sigma_m_;
    for (double* const distance_m :
         {&in_.fence_now_m, &in_.fence_centre_m, &in_.fence_stop_m, &in_.obstacle_stop_m,
          &in_.separation_now_m, &in_.separation_stop_m}) {
      *distance_m -= margin_m;
    }
  }
}

Reasons GuardCore::acting_conditions() const {
  return ladder_.state == FlightState::kIdle ? arming_blocks(traits_.conditions, in_, limits_)
                                             : ladder_.latched;
}

bool GuardCore::end_tick(const Reasons& reasons, Time now) {
  const bool has_changed = reasons != reasons_;
  reasons_ = reasons;
  emergency_stop_ = false;
  request_.reset();
  last_tick_ = now;
  has_ticked_ = true;
  return has_changed;
}

bool GuardCore::may_take_plans() const {
  if (ladder_.state == FlightState::kFollow) {
    return true;
  }
  return ladder_.state == FlightState::kHold && ladder_.wants_follow &&
         !waits_for_more_than_a_plan(traits_.conditions, ladder_.latched);
}

bool GuardCore::keeps_to_course(Time now) const {
  const Setpoint commanded = course_.at(now);
  const double age_s = pose_.age_s(now);
  const bool has_pose =
      traits_.flies ? age_s < limits_.pose_age_land_s : age_s <= limits_.pose_age_hold_s;
  const Eigen::Vector3d off_m = position_m(now) - commanded.position_world_m;
  return course_.is_on_plan() && has_pose &&
         (pose_.velocity_world_mps() - commanded.velocity_world_mps).norm() <=
             kVelocityErrorMaxMps &&
         (traits_.flies ? off_m.norm() : off_m.head<2>().norm()) <= limits_.tracking_hold_m;
}

// A stop follows the plan's curve only if the plan has constant speed there and the vehicle has
// reached this speed. Otherwise the set-points differ from the plan, because their speed changes
// gradually.
bool GuardCore::has_planned_speed(Time now) const {
  const double commanded_mps = course_.at(now).velocity_world_mps.norm();
  if (commanded_mps > 2.0 * pose_.velocity_world_mps().norm() + kSameSpeedMps) {
    return false;  // the vehicle has not begun this motion: a stop must not continue it
  }
  const double half_brake_s = 0.5 * commanded_mps / limits_.vehicle.brake_mps2;
  const auto differs = [&](const Setpoint& planned) {
    return std::abs(planned.velocity_world_mps.norm() - commanded_mps) > kSameSpeedMps;
  };
  return !differs(course_.planned_at(now)) &&
         !differs(course_.planned_at(now + from_seconds(half_brake_s)));
}

BrakingPath GuardCore::braking_path(Time now, double reaction_s) const {
  const Eigen::Vector3d here_m = position_m(now);
  if (keeps_to_course(now) && (reaction_s > 0.0 || has_planned_speed(now))) {
    return BrakingPath::along(course_.plan(), std::max(0.0, course_.elapsed_s(now)),
                              limits_.vehicle.brake_mps2, reaction_s,
                              here_m - course_.planned_at(now).position_world_m);
  }
  return BrakingPath::straight(here_m, pose_.velocity_world_mps(), course_.at(now).yaw_rad,
                               limits_.vehicle.brake_mps2, reaction_s);
}

models::VehicleStatus GuardCore::status(Time now, const std::vector<std::string>& details) const {
  models::VehicleStatus out;
  out.stamp.time = now;
  out.robot = name_;
  out.state = ladder_.state;
  out.battery_share = in_.battery_share;
  const Setpoint commanded = course_.at(now);
  out.setpoint = {commanded.position_world_m.x(), commanded.position_world_m.y(),
                  commanded.yaw_rad};
  out.plan_round = ladder_.state == FlightState::kFollow ? plans_.round() : -1;
  out.reasons = names_of(traits_.conditions, reasons_);
  out.reasons.insert(out.reasons.end(), details.begin(), details.end());
  if (const char* const refusal_message = source_.refusal_message(now)) {
    out.reasons.emplace_back(refusal_message);
  }
  return out;
}

void GuardCore::count(std::vector<models::NamedCount>& out) const {
  plans_.count(out);
  for (std::size_t i = 1; i < kPoseVerdicts; ++i) {
    out.push_back({std::string("pose.") + name_of(static_cast<PoseVerdict>(i)), pose_counts_[i]});
  }
  out.push_back({"mocap.clock_set", clocks_set_});
  if (estimates_used_ + estimates_refused_ > 0) {
    out.push_back({"pose.estimates_used", estimates_used_});
    out.push_back({"pose.estimates_refused", estimates_refused_});
  }
  source_.count(out);
  out.push_back({"mocap.unknown_bodies", fleet_.unknown_bodies()});
  out.push_back({"mocap.bodies_dropped", fleet_.bodies_dropped()});
  out.push_back({"mocap.others_refused", fleet_.poses_refused()});
  out.push_back({"plan.teammate_refused", fleet_.plans_refused()});
  out.push_back({"command.refused", commands_refused_});
  out.push_back({"planner.takeovers", plans_.lease().takeovers()});
  authority_.count(out);
}

}  // namespace vantage::drivers
