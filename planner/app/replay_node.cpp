#include "planner/app/replay_node.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "bus/convert/external_channels.hpp"
#include "core/deadline.hpp"
#include "planner/app/pose_fill.hpp"

namespace vantage::planner {
namespace {

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_motion(const models::Trajectory& a, const models::Trajectory& b) {
  if (a.start_time != b.start_time || a.segments.size() != b.segments.size() ||
      !same_bits(a.start.x_m, b.start.x_m) || !same_bits(a.start.y_m, b.start.y_m) ||
      !same_bits(a.start.yaw_rad, b.start.yaw_rad) || !same_bits(a.height_m, b.height_m)) {
    return false;
  }
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    const models::PlanSegment& s = a.segments[i];
    const models::PlanSegment& r = b.segments[i];
    if (!same_bits(s.control.speed_mps, r.control.speed_mps) ||
        !same_bits(s.control.yaw_rate_radps, r.control.yaw_rate_radps) ||
        !same_bits(s.duration_s, r.duration_s) || !same_bits(s.brake_mps2, r.brake_mps2)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool is_same_decision(const models::RobotPlan& a, const models::RobotPlan& b) {
  return a.robot == b.robot && a.round == b.round && a.source == b.source &&
         same_motion(a.trajectory, b.trajectory) && same_bits(a.cost, b.cost) &&
         same_bits(a.lower_bound, b.lower_bound) && same_bits(a.epsilon, b.epsilon) &&
         same_bits(a.delta_m, b.delta_m) && a.passes == b.passes;
}

bool is_same_decision(const models::TeamProposal& a, const models::TeamProposal& b) {
  return a.robot == b.robot && a.round == b.round && same_bits(a.value_nats, b.value_nats) &&
         a.history == b.history &&
         std::equal(a.choices.begin(), a.choices.end(), b.choices.begin(), b.choices.end(),
                    [](const models::TeamChoice& x, const models::TeamChoice& y) {
                      return x.robot == y.robot && same_motion(x.trajectory, y.trajectory) &&
                             same_bits(x.information_nats, y.information_nats) &&
                             same_bits(x.energy_nats, y.energy_nats);
                    });
}

PlannerReplayNode::PlannerReplayNode(bus::Bus& bus, const bus::Clock& clock,
                                     const scenario::Scenario& scenario, const std::string& robot)
    : bus_(bus),
      scenario_(scenario),
      robot_(robot),
      planner_(scenario, robot),
      schedule_(scenario.planner, planner_.robot_index(), planner_.robot_count()),
      next_(clock.now()) {
  bus_.subscribe_named<models::RobotBelief>(
      bus::belief_channel(robot),
      [this](const std::string& name, const auto& m) { beliefs_.add(name, m); });
  bus_.subscribe_named<models::BeliefMixture>(
      bus::mixture_channel(robot),
      [this](const std::string& name, const auto& m) { mixtures_.add(name, m); });
  if (scenario.planner.objective == scenario::PlanObjective::kMapping) {
    bus_.subscribe_named<models::RobotMap>(
        bus::map_channel(robot),
        [this](const std::string& name, const auto& m) { maps_.add(name, m); });
  }
  bus_.subscribe_named<models::RobotPlan>(
      bus::external_plan_channel(robot),
      [this](const std::string& name, const auto& m) { answers_.add(name, m); });
  bus_.subscribe_named<models::MocapFrame>(
      bus::kVicon, [this](const std::string& name, const auto& m) { frames_.add(name, m); });
  bus_.subscribe_named<models::AttackNotice>(
      bus::kAttack, [this](const std::string& name, const auto& m) { attacks_.add(name, m); });
  for (const scenario::RobotSpec& each : scenario.robots) {
    const bool is_own = each.name == robot;
    bus_.subscribe_named<models::RobotPlan>(bus::plan_channel(each.name),
                                            [this, is_own](const std::string& name, const auto& m) {
                                              plans_.add(name, m);
                                              if (is_own && m.robot == robot_) {
                                                logged_.add(m);
                                              }
                                            });
    bus_.subscribe_named<models::PlanProposal>(
        bus::proposal_channel(each.name),
        [this](const std::string& name, const auto& m) { proposals_.add(name, m); });
    bus_.subscribe_named<models::TeamProposal>(
        bus::team_proposal_channel(each.name),
        [this, is_own](const std::string& name, const auto& m) {
          team_proposals_.add(name, m);
          if (is_own && m.robot == robot_) {
            logged_.add(m);
          }
        });
    bus_.subscribe_named<models::PoseEstimate>(
        bus::pose_channel(each.name),
        [this](const std::string& name, const auto& m) { poses_.add(name, m); });
    bus_.subscribe_named<models::VehicleStatus>(
        bus::vehicle_channel(each.name),
        [this](const std::string& name, const auto& m) { statuses_.add(name, m); });
  }
}

bool PlannerReplayNode::gather(const RoundSchedule::Slot& slot,
                               const std::vector<models::InputRef>& names,
                               PlanInputs& inputs) const {
  inputs.slot = slot;
  for (const models::InputRef& name : names) {
    if (const auto* belief = beliefs_.find(name)) {
      inputs.belief = *belief;
    } else if (const auto* mixture = mixtures_.find(name)) {
      inputs.mixture = *mixture;
    } else if (const auto* map = maps_.find(name)) {
      inputs.map = *map;
    } else if (const auto* frame = frames_.find(name)) {
      (inputs.mocap ? inputs.mocap_before : inputs.mocap) = *frame;  // names_of() lists mocap first
    } else if (const auto* pose = poses_.find(name)) {
      inputs.poses.insert_or_assign(pose->robot, *pose);
    } else if (const auto* attack = attacks_.find(name)) {
      inputs.attack = *attack;
    } else if (const auto* proposal = proposals_.find(name)) {
      inputs.proposals.insert_or_assign(proposal->plan.robot, *proposal);
    } else if (const auto* solution = team_proposals_.find(name)) {
      inputs.solution = *solution;
    } else if (const auto* status = statuses_.find(name)) {
      inputs.team_statuses.insert_or_assign(status->robot, *status);
    } else if (const auto* answer = answers_.find(name)) {
      inputs.answer = *answer;
    } else if (const auto* plan = plans_.find(name)) {
      if (plan->robot == robot_) {
        inputs.own_plan = *plan;
      } else {
        inputs.team_plans.insert_or_assign(plan->robot, *plan);
      }
    } else {
      return false;
    }
  }
  for (const auto& [of_robot, pose] : inputs.poses) {
    if (inputs.mocap) {
      show_robot(scenario_, pose, *inputs.mocap);
    }
  }
  return true;
}

PlannerReplayNode::Outcome PlannerReplayNode::replay(const models::RobotPlan& logged) {
  PlanInputs inputs;
  const std::optional<int> slot_index = schedule_.slot_index_of(logged);
  const RoundSchedule::Slot slot =
      slot_index ? schedule_.slot(logged.round, *slot_index) : schedule_.slot(logged.round);
  if (!gather(slot, logged.inputs, inputs)) {
    return Outcome::kIncomplete;
  }
  const bool is_in_time = logged.finish <= logged.deadline;
  auto plan = logged.late && is_in_time ? planner_.plan_to_stop(inputs)
                                        : planner_.plan(inputs, Deadline::nodes(logged.nodes));
  if (logged.late && !is_in_time) {  // this plan replaced a search that ended too late
    plan = planner_.plan_without_search(inputs);
  }
  if (!plan) {
    return Outcome::kDifferent;
  }
  plan->finish = logged.finish;
  plan->late = logged.late;
  plan->inputs = logged.inputs;
  bus_.publish(bus::plan_channel(robot_), *plan);
  return is_same_decision(*plan, logged) ? Outcome::kSame : Outcome::kDifferent;
}

PlannerReplayNode::Outcome PlannerReplayNode::replay(const models::TeamProposal& logged) {
  PlanInputs inputs;
  if (!gather(schedule_.slot(logged.round), logged.inputs, inputs)) {
    return Outcome::kIncomplete;
  }
  const auto exchange = planner_.begin_exchange(inputs, Deadline::nodes(logged.nodes));
  if (!exchange ||
      (inputs.solution && exchange->receive(*inputs.solution) != ReceiveOutcome::kTaken)) {
    return Outcome::kDifferent;
  }
  auto proposal = exchange->improve(Deadline::never());
  if (!proposal) {
    return Outcome::kDifferent;
  }
  proposal->nodes = logged.nodes;
  proposal->inputs = logged.inputs;
  bus_.publish(bus::team_proposal_channel(robot_), *proposal);
  return is_same_decision(*proposal, logged) ? Outcome::kSame : Outcome::kDifferent;
}

void PlannerReplayNode::tick(Time now) {
  next_ = now + bus::kReplayTick;
  logged_.tick();
  logged_.work([this](const auto& logged, bool is_last_chance) {
    switch (std::visit([this](const auto& each) { return replay(each); }, logged)) {
      case Outcome::kSame:
        ++same_;
        return true;
      case Outcome::kDifferent:
        ++different_;
        return true;
      case Outcome::kIncomplete:
        incomplete_ += is_last_chance ? 1 : 0;
        break;
    }
    return false;
  });
}

std::vector<models::NamedCount> PlannerReplayNode::counters() const {
  return {{"replayed_same", same_},
          {"replayed_different", different_},
          {"replay_inputs_missing", incomplete_}};
}

}  // namespace vantage::planner
