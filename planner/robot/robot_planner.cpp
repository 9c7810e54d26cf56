#include "planner/robot/robot_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "core/check.hpp"
#include "core/infinity.hpp"
#include "models/belief/exploration.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "scenario/search_name.hpp"

namespace vantage::planner {
namespace {

// A different stream of random numbers for each robot and round, the same at every replay.
std::uint64_t draw_seed(std::uint64_t seed, int robot_index, std::int64_t round) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                         static_cast<std::uint32_t>(robot_index),
                         static_cast<std::uint32_t>(round)};
  std::uint32_t words[2];
  sequence.generate(std::begin(words), std::end(words));
  return (std::uint64_t{words[1]} << 32U) | words[0];
}

// Σ_{t=1}^{T} of the stage costs when nobody of the search looks.
double cost_without_looks(const SearchProblem& problem) {
  BeliefTable beliefs(static_cast<int>(problem.targets.size()), problem.horizon_steps);
  beliefs.reset(problem);
  double cost = 0.0;
  for (int t = 1; t <= problem.horizon_steps; ++t) {
    cost += beliefs.open_loop_cost(t);
  }
  return cost;
}

bool is_local_search(const scenario::PlannerSpec& planner) {
  return planner.team_algorithm == scenario::TeamAlgorithm::kLocalSearch;
}

// Of what a vehicle passes between two heights, that which is nearest to another's height.
double nearest_height_m(double other_m, double one_m, double two_m) {
  return std::clamp(other_m, std::min(one_m, two_m), std::max(one_m, two_m));
}

// Whether a search can work on it: what it multiplies of such numbers stays finite.
bool is_searchable(const models::Gaussian& prior) {
  constexpr double kLargest = 1e30;  // m or m/s, and their squares
  return prior.mean.cwiseAbs().maxCoeff() <= kLargest &&
         prior.covariance.cwiseAbs().maxCoeff() <= kLargest &&
         models::log_det(prior.covariance) >=
             -std::log(kLargest) * static_cast<double>(prior.mean.size());
}

// Whether its plans are chosen from candidates, by what they tell and cost.
bool chooses_candidates(const scenario::PlannerSpec& planner, const scenario::RobotSpec& robot) {
  return is_local_search(planner) || (algorithm_called(planner.algorithm).makes_candidates &&
                                      planner.attacks_max == 0 && robot.energy.price_nats > 0.0);
}

}  // namespace

RobotPlanner::RobotPlanner(const scenario::Scenario& scenario, const std::string& robot)
    : RobotPlanner(std::make_shared<Workspace>(scenario), robot) {}

RobotPlanner::RobotPlanner(std::shared_ptr<Workspace> workspace, const std::string& robot)
    : workspace_(std::move(workspace)), scenario_(workspace_->scenario()) {
  spec_ = scenario_.find_robot(robot);
  require(spec_ != nullptr, "planner: no robot '" + robot + "' in the scenario");
  robot_index_ = static_cast<int>(spec_ - scenario_.robots.data());
  if (scenario_.planner.slots > 0) {
    schedule_.emplace(scenario_.planner, robot_index_, robot_count());
  }
  if (scenario_.planner.objective == scenario::PlanObjective::kMapping) {
    mapping_.emplace(scenario_);
  } else if (scenario::is_external(scenario_.planner)) {
    return;  // it searches nothing
  } else if (chooses_candidates(scenario_.planner, *spec_)) {
    exchange_ = std::make_unique<TeamExchange>(scenario_, robot_index_, workspace_->reduced());
  } else if (const Algorithm& algorithm = algorithm_called(scenario_.planner.algorithm);
             algorithm.remembers) {
    own_search_ = workspace_->make_search(robot_index_);
    search_ = own_search_.get();
  } else {
    search_ = &workspace_->search();
  }
}

models::RobotPlan RobotPlanner::blank_plan(const PlanInputs& inputs) const {
  models::RobotPlan plan;
  plan.stamp.time = inputs.slot.activation;
  plan.robot = spec_->name;
  plan.round = inputs.slot.round;
  plan.horizon_steps = scenario_.planner.horizon_steps;
  plan.step_s = scenario_.planner.step_s;
  plan.cost = std::numeric_limits<double>::quiet_NaN();
  plan.lower_bound = -kInfinity;
  plan.epsilon = kInfinity;
  plan.delta_m = kInfinity;
  plan.slot_start = inputs.slot.begin;
  plan.deadline = inputs.slot.end;
  return plan;
}

std::optional<models::Trajectory> RobotPlanner::committed_motion(const PlanInputs& inputs) {
  const models::MocapBody* body =
      inputs.mocap ? inputs.mocap->find(spec_->name, index_of(*spec_)) : nullptr;
  const bool has_pose = body != nullptr && !body->occluded;
  if (const auto hover = hover_off_plan(inputs)) {
    ++counts_.off_plan;
    return hover_at(*hover, spec_->height_m, inputs.slot.activation);
  }
  if (inputs.own_plan) {
    const models::Trajectory& last = inputs.own_plan->trajectory;
    bool on_plan = true;
    if (has_pose && inputs.mocap->stamp.time >= last.start_time) {
      const Pose2 expected = models::at(last, inputs.mocap->stamp.time).world_from_body;
      const double off_m =
          (expected.position_m() - flatten(body->world_from_body).position_m()).norm();
      if (off_m > scenario_.planner.tracking_tolerance_m) {
        ++counts_.off_plan;
        // Far off, the vehicle has not followed at all (held by its operator, say): start anew
        // from where it is. In between, its own feedback brings it back onto the plan.
        on_plan = off_m <= 3.0 * scenario_.planner.tracking_tolerance_m;
      }
    }
    if (on_plan) {
      return rest_of(last, inputs.slot.activation);
    }
  }
  if (!has_pose) {
    counts_.no_pose += inputs.slot.is_proposal ? 0 : 1;
    return std::nullopt;
  }
  if (!inputs.own_plan && flies_unknown_plan(inputs)) {
    counts_.unknown_plan += inputs.slot.is_proposal ? 0 : 1;
    return std::nullopt;
  }
  return hover_at(flatten(body->world_from_body), spec_->height_m, inputs.slot.activation);
}

// A vehicle that holds stands where its driver stopped it, and will not come back to its plan by
// itself: the next one must begin there, or it is refused for ever.
std::optional<Pose2> RobotPlanner::hover_off_plan(const PlanInputs& inputs) const {
  constexpr double kTurnMaxRad = 0.4;
  const auto own = inputs.team_statuses.find(spec_->name);
  if (!inputs.own_plan || own == inputs.team_statuses.end() ||
      own->second.state != models::FlightState::kHold) {
    return std::nullopt;
  }
  const models::Trajectory& last = inputs.own_plan->trajectory;
  const Pose2& hover = own->second.setpoint;
  const Time when = std::max(own->second.stamp.time, last.start_time);
  const Pose2 planned = models::at(last, when).world_from_body;
  const bool is_off =
      (planned.position_m() - hover.position_m()).norm() > scenario_.planner.tracking_tolerance_m ||
      std::abs(wrap_to_pi(planned.yaw_rad - hover.yaw_rad)) > kTurnMaxRad;
  return is_off ? std::optional(hover) : std::nullopt;
}

bool RobotPlanner::flies_unknown_plan(const PlanInputs& inputs) const {
  const auto own = inputs.team_statuses.find(spec_->name);
  if (own == inputs.team_statuses.end() || own->second.state != models::FlightState::kFollow ||
      own->second.plan_round < 0) {
    return false;
  }
  const std::int64_t rounds = inputs.slot.round - own->second.plan_round;
  if (rounds < 0) {
    return false;  // of another schedule
  }
  // Seen when the slot begins, it must stand.
  const scenario::PlannerSpec& planner = scenario_.planner;
  const double since_s = static_cast<double>(rounds * planner.execute_steps) * planner.step_s -
                         to_seconds(inputs.slot.activation - inputs.slot.begin);
  return since_s < planner.horizon_steps * planner.step_s +
                       spec_->limits.speed_max_mps / spec_->limits.brake_mps2;
}

ResilientRound RobotPlanner::round_of(const PlanInputs& inputs) const {
  std::vector<double> values(scenario_.robots.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto proposal = inputs.proposals.find(scenario_.robots[i].name);
    if (proposal != inputs.proposals.end() && proposal->second.plan.round == inputs.slot.round) {
      values[i] = proposal->second.value_nats;
    }
  }
  // Of whom nothing was heard, or who has nothing to lose, is no bait.
  const auto worth_it = std::count_if(values.begin(), values.end(), [](double v) { return v > 0; });
  return {values, std::min(scenario_.planner.attacks_max, static_cast<int>(worth_it))};
}

std::vector<FixedTeammate> RobotPlanner::fixed_teammates(const PlanInputs& inputs,
                                                         const std::vector<int>& unseeing) const {
  std::vector<FixedTeammate> teammates;
  for (const scenario::RobotSpec& robot : scenario_.robots) {
    if (robot.name == spec_->name) {
      continue;
    }
    FixedTeammate teammate;
    teammate.sensor = robot.sensor;
    const auto index = static_cast<int>(index_of(robot));
    teammate.jammed =
        std::find(unseeing.begin(), unseeing.end(), index) != unseeing.end() ||
        (inputs.attack && std::find(inputs.attack->jammed.begin(), inputs.attack->jammed.end(),
                                    robot.name) != inputs.attack->jammed.end());
    const auto plan = inputs.team_plans.find(robot.name);
    if (plan != inputs.team_plans.end()) {
      teammate.trajectory = plan->second.trajectory;
    } else {
      // Never heard: it hovers where mocap sees it, or where the scenario starts it.
      const models::MocapBody* body =
          inputs.mocap ? inputs.mocap->find(robot.name, index_of(robot)) : nullptr;
      const Pose2 pose =
          body != nullptr && !body->occluded ? flatten(body->world_from_body) : robot.start;
      if (!is_near(pose)) {
        continue;
      }
      teammate.trajectory = hover_at(pose, robot.height_m, inputs.slot.activation);
    }
    teammate.robot = index_of(robot);
    teammates.push_back(std::move(teammate));
  }
  return teammates;
}

bool RobotPlanner::is_near(const Pose2& place) const {
  const double neighbourhood_m = scenario_.network.neighbourhood_m;
  return neighbourhood_m <= 0.0 ||
         (place.position_m() - problem_.start.position_m()).norm() <= neighbourhood_m;
}

std::vector<models::Trajectory> RobotPlanner::hovers_of_those_who_wait(
    const PlanInputs& inputs) const {
  std::vector<models::Trajectory> hovers;
  for (const auto& [name, status] : inputs.team_statuses) {
    if (status.state == models::FlightState::kFollow || name == spec_->name) {
      continue;
    }
    const std::optional<std::size_t> index = workspace_->index_of(name);
    const scenario::RobotSpec* robot = index ? &scenario_.robots[*index] : nullptr;
    const models::MocapBody* body =
        inputs.mocap ? inputs.mocap->find(name, index.value_or(0)) : nullptr;
    // Its plan, if it has one, counts as well: it may begin to follow it at any moment.
    if (robot != nullptr && body != nullptr && !body->occluded) {
      const double here_m = body->world_from_body.translation_m.z();
      double height_m = robot->height_m;
      if (status.state == models::FlightState::kHold) {  // it may be climbing there
        height_m = nearest_height_m(spec_->height_m, here_m, robot->height_m);
      } else if (status.state == models::FlightState::kLand) {
        height_m = nearest_height_m(spec_->height_m, 0.0, here_m);
      }
      hovers.push_back(hover_at(flatten(body->world_from_body), height_m, inputs.slot.activation));
    }
  }
  return hovers;
}

void RobotPlanner::add_targets(const models::RobotBelief& belief, Time start) {
  const models::TargetModel& model = scenario_.estimator.target_model;
  const double ahead_s = to_seconds(start - belief.stamp.time);
  const double step_s = scenario_.planner.step_s;
  for (const models::TargetBelief& target : belief.targets) {
    const auto gaussian = target.information.vector.size() == model.dim() && ahead_s >= 0.0
                              ? models::to_gaussian(target.information)
                              : std::nullopt;
    const double unseen_s = std::max(0.0, to_seconds(belief.stamp.time - target.last_seen));
    const models::Gaussian prior =
        gaussian ? models::predict_unseen(*gaussian, model, ahead_s, unseen_s, step_s)
                 : models::Gaussian{};
    if (!gaussian || !is_searchable(prior) || problem_.targets.size() >= scenario_.targets.size()) {
      ++counts_.unusable_beliefs;
      continue;
    }
    problem_.targets.push_back({model.as_planned((unseen_s + ahead_s) / step_s, step_s), prior});
  }
}

void RobotPlanner::add_landmarks(const models::RobotBelief& belief, Time start) {
  const models::ExplorationSpec& exploration = scenario_.planner.exploration;
  if (exploration.landmarks_max <= 0) {
    return;
  }
  const auto whole =
      models::GridGeometry::covering(scenario_.world.bounds, scenario_.estimator.grid_resolution_m);
  const bool is_one_grid = scenario_.network.neighbourhood_m > 0.0
                               ? whole.place_of(belief.grid).has_value()
                               : belief.grid == whole;
  if (!is_one_grid || std::ssize(belief.last_seen_utime) != belief.grid.size()) {
    ++counts_.unusable_beliefs;
    return;
  }
  models::VisibilityGrid grid(scenario_.world, belief.grid, scenario_.estimator.grid_memory_s);
  grid.set_last_seen(belief.last_seen_utime);
  const models::TargetModel still{models::TargetKind::kStatic, 2, 0.0};
  for (const models::Gaussian& landmark :
       models::exploration_landmarks(grid, exploration, problem_.start.position_m(), start)) {
    problem_.targets.push_back({still, landmark});
  }
}

void RobotPlanner::set_up_problem(const PlanInputs& inputs, const models::Trajectory& committed,
                                  const std::vector<int>& unseeing) {
  const scenario::PlannerSpec& planner = scenario_.planner;
  problem_.start_time = inputs.slot.activation;
  problem_.start = committed.start;
  problem_.start_speed_mps = models::at(committed, committed.start_time).control.speed_mps;
  problem_.height_m = spec_->height_m;
  problem_.controls = spec_->primitives;
  problem_.horizon_steps = planner.horizon_steps;
  problem_.step_s = planner.step_s;
  problem_.sensors = {spec_->sensor};
  problem_.cost = CostKind::kLogDet;
  problem_.world = &scenario_.world;
  problem_.field = &workspace_->field();
  problem_.clearance_m = spec_->limits.radius_m + planner.obstacle_margin_m;
  // Both vehicles may be off their plans by the tolerance at once.
  problem_.separation_m = planner.separation_m + 2.0 * planner.tracking_tolerance_m;
  problem_.separation_from_above = planner.separation_from_above;
  problem_.brake_mps2 = spec_->limits.brake_mps2;
  problem_.targets.clear();
  if (inputs.belief && !mapping_) {
    add_targets(*inputs.belief, inputs.slot.activation);
    add_landmarks(*inputs.belief, inputs.slot.activation);
  }
  const std::vector<FixedTeammate> teammates = fixed_teammates(inputs, unseeing);
  problem_.teammates.clear();
  teammates_.clear();
  for (const FixedTeammate& teammate : teammates) {
    problem_.teammates.push_back(teammate.trajectory);
    teammates_.push_back(teammate.robot);
  }
  for (const models::Trajectory& hover : hovers_of_those_who_wait(inputs)) {
    problem_.teammates.push_back(hover);
  }
  problem_.fixed_information = fixed_information(problem_, teammates);
  if (mapping_) {
    mapping_->set_up(problem_, inputs.map, teammates);
    counts_.unusable_maps = mapping_->unusable_maps();
  }
}

const SearchResult& RobotPlanner::search(const PlanInputs& inputs, const Deadline& deadline) {
  if (mapping_) {
    mapping_result_ = mapping_->search(problem_, deadline);
    return mapping_result_;
  }
  problem_.seed = draw_seed(scenario_.seed, robot_index_, inputs.slot.round);
  return search_->plan(problem_, deadline);
}

std::vector<SlotHolder> RobotPlanner::slots_of_neighbours(const PlanInputs& inputs) const {
  std::vector<SlotHolder> holders;
  for (const auto& [name, plan] : inputs.team_plans) {
    const std::optional<std::size_t> robot = workspace_->index_of(name);
    const std::optional<int> slot = schedule_->place_of(plan);
    if (robot && slot) {
      holders.push_back({static_cast<int>(*robot), *slot});
    }
  }
  return holders;
}

bool RobotPlanner::has_slot(const PlanInputs& inputs) const {
  const std::optional<int> last =
      inputs.own_plan ? schedule_->place_of(*inputs.own_plan) : std::nullopt;
  return last == inputs.slot.place &&
         may_search({robot_index_, inputs.slot.place}, slots_of_neighbours(inputs));
}

int RobotPlanner::next_place(const PlanInputs& inputs) const {
  const std::optional<int> last =
      inputs.own_plan ? schedule_->place_of(*inputs.own_plan) : std::nullopt;
  return next_slot({robot_index_, last.value_or(schedule_->first_place())},
                   slots_of_neighbours(inputs), schedule_->slots());
}

std::vector<int> RobotPlanner::all_robots() const {
  std::vector<int> all(scenario_.robots.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::optional<models::RobotPlan> RobotPlanner::plan(const PlanInputs& inputs,
                                                    const Deadline& deadline) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return std::nullopt;
  }
  if (schedule_ && schedule_->is_shared() && !has_slot(inputs)) {
    ++counts_.yields;
    return plan_without_search(inputs);
  }
  if (scenario::is_external(scenario_.planner)) {
    return plan_of_answer(inputs, *committed);
  }
  if (exchange_) {
    return is_local_search(scenario_.planner) ? plan_of_solution(inputs, *committed)
                                              : plan_by_worth(inputs, *committed, deadline);
  }
  const ResilientRound round = round_of(inputs);
  set_up_problem(inputs, *committed, round.unseeing_for(robot_index_));
  models::RobotPlan plan = blank_plan(inputs);
  if (round.is_bait(robot_index_)) {
    ++counts_.baits;
    if (take(inputs.proposals.at(spec_->name).plan, plan)) {
      return plan;
    }
  }
  const SearchResult& result = search(inputs, deadline);
  plan.nodes = result.replay_budget_nodes();
  const bool rests = std::all_of(committed->segments.begin(), committed->segments.end(),
                                 [](const auto& each) { return each.control.speed_mps == 0.0; });
  const std::optional<std::size_t> crowder = rests ? too_near() : std::nullopt;
  const bool stays = rests && !(result.found && result.moving_steps > 0);
  if (stays && crowder) {
    turn_away_from(*crowder, plan);
    return plan;
  }
  // A search that ended without a single child: from here, so turned, nothing can begin.
  const bool is_boxed_in =
      !mapping_ && result.nodes_generated == 0 && result.stop_reason != StopReason::kDeadline;
  if (stays && turn_to_a_way_out(is_boxed_in, plan)) {
    return plan;
  }
  if (!take(result, plan)) {
    fall_back(*committed, plan);
  }
  return plan;
}

std::optional<models::PlanProposal> RobotPlanner::propose(const PlanInputs& inputs,
                                                          const Deadline& deadline) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return std::nullopt;
  }
  set_up_problem(inputs, *committed, all_robots());
  models::PlanProposal proposal{{}, 0.0, blank_plan(inputs)};
  proposal.stamp.time = inputs.slot.activation;
  const SearchResult& result = search(inputs, deadline);
  proposal.plan.nodes = result.replay_budget_nodes();
  if (take(result, proposal.plan)) {
    proposal.value_nats = mapping_ ? mapping_->gain_nats()
                                   : std::max(0.0, cost_without_looks(problem_) - result.cost);
  } else {
    fall_back(*committed, proposal.plan);
  }
  return proposal;
}

std::optional<models::RobotPlan> RobotPlanner::plan_without_search(const PlanInputs& inputs) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return std::nullopt;
  }
  set_up_problem(inputs, *committed, round_of(inputs).unseeing_for(robot_index_));
  models::RobotPlan plan = blank_plan(inputs);
  fall_back(*committed, plan);
  return plan;
}

}  // namespace vantage::planner
