#include "drivers/safety/guard_core.hpp"

namespace vantage::drivers {

using models::OperatorAction;

bool GuardCore::on_mocap(const models::MocapFrame& frame, BodyContext context, bool is_armed,
                         Time now) {
  const MocapSource::Standing standing = source.judge(frame, now);
  if (standing == MocapSource::Standing::kRefused) {
    return false;
  }
  const NamedBody found = find_unique(frame, name);
  // A source that takes over after arming must agree with the predicted pose of the vehicle.
  const bool is_candidate = standing == MocapSource::Standing::kCandidate;
  context.in_air = context.in_air || (is_candidate && is_armed);
  PoseMonitor judged = pose;
  PoseVerdict verdict = PoseVerdict::kDuplicate;
  if (found.is_unique) {
    verdict = judged.judge(found.body, context, limits, now);
  }
  ++pose_counts[static_cast<std::size_t>(verdict)];
  pose_verdict = verdict;
  if (is_candidate) {
    if (verdict != PoseVerdict::kAccepted) {
      return false;
    }
    source.confirm(frame, now);
  }
  pose = judged;
  clocks_set += clock.on_frame(frame, now) ? 0 : 1;
  fleet.on_mocap(frame, limits, now);
  return true;
}

PlanVerdict GuardCore::on_plan(const models::RobotPlan& plan, bool may_take, double height_m,
                               Time now) {
  HeldPlan held;
  const PlanVerdict verdict = plans.judge(
      plan, {may_take, course, height_m, fleet.courses(now, limits)}, limits, now, held);
  if (verdict == PlanVerdict::kAccepted) {
    course.follow(held, now);
  }
  return verdict;
}

bool GuardCore::admits(const models::OperatorCommand& command, Time now) {
  if (authority.admit(command, now, limits.operator_age_hold_s)) {
    return true;
  }
  commands_refused += is_ours(command) && command.action != OperatorAction::kHeartbeat ? 1 : 0;
  return false;
}

std::optional<CommandVerdict> GuardCore::execute_if_stateless(
    const models::OperatorCommand& command) {
  if (!is_ours(command)) {
    return CommandVerdict::kOtherRobot;
  }
  if (command.action == OperatorAction::kEmergencyStop) {
    emergency_stop = true;
    return CommandVerdict::kObeyed;
  }
  if (command.action == OperatorAction::kHeartbeat) {
    return CommandVerdict::kObeyed;
  }
  return std::nullopt;
}

CommandVerdict GuardCore::request_action(OperatorAction action) {
  if (!request || static_cast<int>(action) > static_cast<int>(*request)) {
    request = action;
  }
  return CommandVerdict::kObeyed;
}

void GuardCore::update_common_inputs(Time now) {
  in.now = now;
  in.since_last_tick_s = has_ticked ? to_seconds(now - last_tick) : 0.0;
  in.processor_wait_s = processor_wait_s;
  in.pose_age_s = pose.age_s(now);
  in.pose_latency_s = clock.latency_s();
  in.poses_rejected = pose.rejected_in_row();
  in.poses_accepted = pose.accepted_in_row();
  course.report(now, in);
  plans.report(now, limits, in);
  in.map_differs = map_differs;
  in.other_version_age_s = other_version_at ? to_seconds(now - *other_version_at) : kNever;
  in.operator_age_s = authority.age_s(now);
  in.emergency_stop = emergency_stop;
  in.is_ending = is_ending;
  in.request = request;
}

void GuardCore::end_tick(Time now) {
  emergency_stop = false;
  request.reset();
  last_tick = now;
  has_ticked = true;
}

void GuardCore::count(std::vector<models::NamedCount>& out) const {
  plans.count(out);
  for (std::size_t i = 1; i < kPoseVerdicts; ++i) {
    out.push_back({std::string("pose.") + name_of(static_cast<PoseVerdict>(i)), pose_counts[i]});
  }
  out.push_back({"mocap.clock_set", clocks_set});
  source.count(out);
  out.push_back({"mocap.unknown_bodies", fleet.unknown_bodies()});
  out.push_back({"mocap.bodies_dropped", fleet.bodies_dropped()});
  out.push_back({"mocap.others_refused", fleet.poses_refused()});
  out.push_back({"plan.teammate_refused", fleet.plans_refused()});
  out.push_back({"command.refused", commands_refused});
  out.push_back({"planner.takeovers", plans.lease().takeovers()});
  authority.count(out);
}

}  // namespace vantage::drivers
