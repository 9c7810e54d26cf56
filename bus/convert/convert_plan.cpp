#include <cmath>

#include "bus/convert/convert_parts.hpp"

// Plans and proposals of robots: PLAN_R, PROPOSAL_R, TEAM_PROPOSAL_R.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

namespace {

// True if |value| ≤ largest; false for NaN.
bool is_within(double value, double largest) { return std::abs(value) <= largest; }

bool is_segment(const vantage_lcm::plan_segment_t& segment) {
  return is_within(segment.speed_mps, kRateMax) && is_within(segment.yaw_rate_radps, kRateMax) &&
         is_within(segment.brake_mps2, kRateMax) && is_within(segment.duration_s, kMotionMax_s) &&
         segment.duration_s >= 0.0 && segment.brake_mps2 >= 0.0;
}

/// True if the search results have possible values. Special values: cost NaN (no search), bound −∞
/// (nothing proven), epsilon +∞ (greedy pass).
bool is_quality(const vantage_lcm::plan_t& wire) {
  const bool has_cost = !std::isinf(wire.cost_nat);
  const bool has_bound = std::isfinite(wire.lower_bound_nat) ||
                         (std::isinf(wire.lower_bound_nat) && wire.lower_bound_nat < 0);
  return has_cost && has_bound && wire.epsilon >= 0.0 && wire.delta_m >= 0.0;  // false for NaN
}

/// Copies the fields that every wire type with a trajectory has. The trajectory's time is the time
/// of the message.
template <class Wire>
void trajectory_to(const models::Trajectory& trajectory, Wire& wire) {
  wire.start_x_world_m = trajectory.start.x_m;
  wire.start_y_world_m = trajectory.start.y_m;
  wire.start_yaw_world_rad = trajectory.start.yaw_rad;
  wire.height_m = trajectory.height_m;
  wire.num_segments = count_of(trajectory.segments.size());
  wire.segments.resize(trajectory.segments.size());
  for (std::size_t i = 0; i < trajectory.segments.size(); ++i) {
    const models::PlanSegment& segment = trajectory.segments[i];
    wire.segments[i].speed_mps = segment.control.speed_mps;
    wire.segments[i].yaw_rate_radps = segment.control.yaw_rate_radps;
    wire.segments[i].duration_s = segment.duration_s;
    wire.segments[i].brake_mps2 = segment.brake_mps2;
  }
}

template <class Wire>
std::optional<models::Trajectory> trajectory_from(const Wire& wire, Time start_time) {
  const auto start =
      pose2_from(wire.start_x_world_m, wire.start_y_world_m, wire.start_yaw_world_rad);
  if (!start || !is_within(start->x_m, kPositionMax_m) || !is_within(start->y_m, kPositionMax_m) ||
      !is_within(wire.height_m, kPositionMax_m) ||
      !is_count(wire.num_segments, wire.segments.size())) {
    return std::nullopt;
  }
  models::Trajectory trajectory{start_time, *start, wire.height_m, {}};
  trajectory.segments.reserve(wire.segments.size());
  double motion_s = 0.0;
  for (const vantage_lcm::plan_segment_t& segment : wire.segments) {
    motion_s += segment.duration_s;
    if (!is_segment(segment) || motion_s > kMotionMax_s) {
      return std::nullopt;
    }
    trajectory.segments.push_back(
        {{segment.speed_mps, segment.yaw_rate_radps}, segment.duration_s, segment.brake_mps2});
  }
  return trajectory;
}

/// Calls copy(field of the plan, field of the wire struct) for each numeric field that both have.
template <class Plan, class Wire, class Copy>
void each_number(Plan& plan, Wire& wire, const Copy& copy) {
  copy(plan.round, wire.round);
  copy(plan.horizon_steps, wire.horizon_steps);
  copy(plan.step_s, wire.step_s);
  copy(plan.cost, wire.cost_nat);
  copy(plan.lower_bound, wire.lower_bound_nat);
  copy(plan.epsilon, wire.epsilon);
  copy(plan.delta_m, wire.delta_m);
  copy(plan.passes, wire.passes);
  copy(plan.nodes, wire.nodes);
}

bool are_numbers_possible(const vantage_lcm::plan_t& wire) {
  return is_quality(wire) && are_finite(wire.step_s) && wire.step_s > 0.0 &&
         wire.horizon_steps >= 0 && wire.round >= -1 && wire.passes >= 0 && wire.nodes >= 0 &&
         is_utime(wire.slot_start_utime) && is_utime(wire.deadline_utime) &&
         is_utime(wire.finish_utime) && is_boolean(wire.late);
}

}  // namespace

vantage_lcm::plan_t to_wire(const models::RobotPlan& plan) {
  auto wire = stamped<vantage_lcm::plan_t>(plan.stamp);
  wire.robot = plan.robot;
  wire.source = static_cast<std::int32_t>(plan.source);
  trajectory_to(plan.trajectory, wire);
  each_number(plan, wire, [](const auto& known, auto& sent) { sent = known; });
  wire.slot_start_utime = to_utime(plan.slot_start);
  wire.deadline_utime = to_utime(plan.deadline);
  wire.finish_utime = to_utime(plan.finish);
  wire.late = plan.late ? 1 : 0;
  inputs_to(plan.inputs, wire);
  return wire;
}

std::optional<models::RobotPlan> from_wire(const vantage_lcm::plan_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto source = enumerator_from(wire.source, models::PlanSource::kBraking);
  auto inputs = inputs_from(wire);
  // In the wire struct, the message and its trajectory share one time.
  auto trajectory = stamp ? trajectory_from(wire, stamp->time) : std::nullopt;
  if (!trajectory || !source || !inputs || !is_text(wire.robot) || !are_numbers_possible(wire)) {
    return std::nullopt;
  }
  models::RobotPlan plan;
  plan.stamp = *stamp;
  plan.robot = wire.robot;
  plan.source = *source;
  plan.trajectory = std::move(*trajectory);
  each_number(plan, wire, [](auto& known, const auto& sent) { known = sent; });
  plan.slot_start = from_utime(wire.slot_start_utime);
  plan.deadline = from_utime(wire.deadline_utime);
  plan.finish = from_utime(wire.finish_utime);
  plan.late = wire.late != 0;
  plan.inputs = std::move(*inputs);
  return plan;
}

vantage_lcm::proposal_t to_wire(const models::PlanProposal& proposal) {
  auto wire = stamped<vantage_lcm::proposal_t>(proposal.stamp);
  wire.value_nat = proposal.value_nats;
  wire.plan = to_wire(proposal.plan);
  return wire;
}

std::optional<models::PlanProposal> from_wire(const vantage_lcm::proposal_t& wire) {
  const auto stamp = stamp_from(wire);
  auto plan = from_wire(wire.plan);
  if (!stamp || !plan || !are_finite(wire.value_nat) || wire.value_nat < 0.0) {
    return std::nullopt;
  }
  return models::PlanProposal{*stamp, wire.value_nat, std::move(*plan)};
}

vantage_lcm::team_proposal_t to_wire(const models::TeamProposal& proposal) {
  auto wire = stamped<vantage_lcm::team_proposal_t>(proposal.stamp);
  wire.robot = proposal.robot;
  wire.round = proposal.round;
  wire.value_nat = proposal.value_nats;
  wire.num_choices = count_of(proposal.choices.size());
  for (const models::TeamChoice& choice : proposal.choices) {
    vantage_lcm::team_choice_t& out = wire.choices.emplace_back();
    out.robot = choice.robot;
    trajectory_to(choice.trajectory, out);
    out.information_nat = choice.information_nats;
    out.energy_nat = choice.energy_nats;
  }
  wire.num_history = count_of(proposal.history.size());
  wire.history = proposal.history;
  wire.nodes = proposal.nodes;
  inputs_to(proposal.inputs, wire);
  return wire;
}

std::optional<models::TeamProposal> from_wire(const vantage_lcm::team_proposal_t& wire) {
  const auto stamp = stamp_from(wire);
  auto inputs = inputs_from(wire);
  if (!stamp || !inputs || !is_text(wire.robot) || !are_finite(wire.value_nat) || wire.nodes < 0 ||
      !is_count(wire.num_choices, wire.choices.size()) ||
      !is_count(wire.num_history, wire.history.size())) {
    return std::nullopt;
  }
  models::TeamProposal proposal{*stamp, wire.robot,   wire.round, wire.value_nat,
                                {},     wire.history, wire.nodes, std::move(*inputs)};
  for (const vantage_lcm::team_choice_t& choice : wire.choices) {
    auto trajectory = trajectory_from(choice, stamp->time);
    const bool is_new = proposal.find(choice.robot) == nullptr;
    if (!trajectory || !is_new || !is_text(choice.robot) ||
        !are_finite(choice.information_nat, choice.energy_nat) || choice.information_nat < 0.0 ||
        choice.energy_nat < 0.0) {
      return std::nullopt;
    }
    proposal.choices.push_back(
        {choice.robot, std::move(*trajectory), choice.information_nat, choice.energy_nat});
  }
  return proposal;
}

}  // namespace vantage::bus
