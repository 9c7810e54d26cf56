#include "drivers/safety/plan_gate.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"

namespace vantage::drivers {

PlanVerdict PlanGate::judge(const models::RobotPlan& plan, const PlanSituation& situation,
                            const SafetyLimits& limits, Time now, HeldPlan& out) {
  const PlanVerdict verdict = check(plan, situation, limits, now, out);
  ++counts_[static_cast<std::size_t>(verdict)];
  if (verdict == PlanVerdict::kAccepted) {
    has_accepted_ = true;
    accepted_at_ = now;
    newest_start_ = out.start_time;
    run_ = plan.stamp.run_id;
    sequence_ = plan.stamp.sequence;
    round_ = plan.round;
  }
  const bool is_from_our_planner = lease_.is_holder(plan.stamp.run_id) && plan.robot == robot_;
  if (is_from_our_planner && verdict != PlanVerdict::kNotFollowing) {
    refused_ = verdict == PlanVerdict::kAccepted ? 0 : refused_ + 1;
  }
  return verdict;
}

PlanVerdict PlanGate::check(const models::RobotPlan& plan, const PlanSituation& situation,
                            const SafetyLimits& limits, Time now, HeldPlan& out) {
  if (plan.robot != robot_) {
    return PlanVerdict::kWrongVehicle;
  }
  const models::Trajectory& trajectory = plan.trajectory;
  const bool is_repeated = plan.stamp.run_id == run_ && plan.stamp.sequence <= sequence_;
  if (is_repeated || (has_accepted_ && trajectory.start_time < newest_start_) ||
      trajectory.start_time < now - from_seconds(limits.plan_past_max_s)) {
    return PlanVerdict::kStale;
  }
  if (trajectory.start_time > now + from_seconds(limits.plan_future_max_s)) {
    return PlanVerdict::kTooFarAhead;
  }
  if (!hold_plan(trajectory, out)) {
    return PlanVerdict::kNotFinite;
  }
  if (const PlanVerdict shape = check_shape(out, limits); shape != PlanVerdict::kAccepted) {
    return shape;
  }
  // Only a feasible plan takes, renews or contests the lease.
  if (!lease_.admit(plan.stamp.run_id, now, limits.planner_lease_s)) {
    return PlanVerdict::kNoLease;
  }
  late_ = plan.late ? late_ + 1 : 0;
  if (!situation.may_take) {
    return PlanVerdict::kNotFollowing;
  }
  // This plan begins at the end of the pending plan, so it must not replace the pending plan.
  if (situation.course.has_next() && newest_start_ > now && out.start_time > newest_start_) {
    return PlanVerdict::kTooFarAhead;
  }
  const Time when = std::max(now, out.start_time);
  const Setpoint planned = point_at(out, to_seconds(when - out.start_time));
  const Setpoint expected = situation.course.planned_at(when);
  Eigen::Vector3d gap_m = planned.position_world_m - expected.position_world_m;
  gap_m.z() = planned.position_world_m.z() - situation.height_m;
  const double turn_rad = std::abs(wrap_to_pi(planned.yaw_rad - expected.yaw_rad));
  if (!(gap_m.norm() <= limits.plan_start_tolerance_m) ||
      !(turn_rad <= limits.plan_start_turn_rad)) {
    return PlanVerdict::kDiscontinuous;
  }
  return check_path(out, when, limits, situation.others);
}

void PlanGate::report(Time now, const SafetyLimits& limits, SafetyInputs& inputs) const {
  inputs.plan_age_s = has_accepted_ ? to_seconds(now - accepted_at_) : kNever;
  inputs.planner_age_s = lease_.age_s(now);
  inputs.plans_late = late_;
  inputs.plans_refused = refused_;
  inputs.second_planner = lease_.is_contested(now, limits.planner_lease_s);
}

void PlanGate::count(std::vector<models::NamedCount>& out) const {
  for (std::size_t i = 1; i < kPlanVerdicts; ++i) {
    out.push_back({std::string("plan.") + name_of(static_cast<PlanVerdict>(i)), counts_[i]});
  }
}

}  // namespace vantage::drivers
