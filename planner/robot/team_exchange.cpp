#include "planner/robot/team_exchange.hpp"

#include <algorithm>
#include <utility>

#include "core/index.hpp"
#include "planner/robot/closing_check.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "scenario/energy_cost.hpp"

namespace vantage::planner {
namespace {

// Maximum number of leaves of the search that are examined; about 10 µs per leaf.
constexpr std::size_t kLeavesMax = 2000;

CandidateOptions options_of(const scenario::PlannerSpec& planner) {
  CandidateOptions options;
  options.epsilon = planner.epsilon_initial;
  options.delta_m = planner.delta_initial_m;
  options.yaw_weight_m_per_rad = planner.yaw_weight_m_per_rad;
  options.is_anytime = true;
  options.leaves_max = kLeavesMax;
  options.candidates_max = static_cast<std::size_t>(planner.candidates_max);
  return options;
}

}  // namespace

TeamExchange::TeamExchange(const scenario::Scenario& scenario, int robot,
                           ReducedValueIteration& search, const SearchProblem& problem,
                           const Start& start, const Deadline& deadline)
    : robots_(scenario.robots),
      planner_(scenario.planner),
      robot_(robot),
      problem_(problem),
      beliefs_{
          problem.targets, problem.horizon_steps, problem.step_s, InformationMeasure::kMutual, {}},
      jammed_(start.jammed),
      session_(setup_of(start, candidates_by(search, deadline))) {}

std::vector<Candidate> TeamExchange::candidates_by(ReducedValueIteration& search,
                                                   const Deadline& deadline) {
  std::vector<Candidate> found = candidate_trajectories(problem_, robots_[index(robot_)].energy,
                                                        search, options_of(planner_), deadline);
  nodes_ = search.result().replay_budget_nodes();
  return found;
}

SessionSetup TeamExchange::setup_of(const Start& start, std::vector<Candidate> found) const {
  const scenario::RobotSpec& spec = robots_[index(robot_)];
  SessionSetup setup;
  setup.robot = robot_;
  setup.round = start.round;
  setup.activation = problem_.start_time;
  setup.problem = beliefs_;
  setup.problem.candidates.resize(robots_.size());
  setup.committed = start.committed;
  for (const scenario::RobotSpec& each : robots_) {
    setup.robots.push_back(each.name);
  }
  const auto add = [&](models::Trajectory motion, Candidate candidate) {
    if (is_safe(problem_, motion)) {
      if (is_jammed(spec.name)) {
        candidate.measurements.clear();
        candidate.mutual_nats.reset();
      }
      setup.own.push_back({spec.name, std::move(motion), 0.0, 0.0});
      setup.problem.candidates[index(robot_)].push_back(std::move(candidate));
    }
  };
  add(start.rest, make_candidate(problem_, &spec.sensor, start.rest,
                                 spec.energy.price_nats * problem_.horizon_steps *
                                     scenario::step_cost(spec.energy, problem_.world, {0.0, 0.0},
                                                         problem_.start.position_m())));
  for (Candidate& candidate : found) {
    models::Trajectory motion = to_trajectory(problem_, candidate.controls);
    add(std::move(motion), std::move(candidate));
  }
  setup.candidate_of = [this](const models::TeamChoice& choice) { return candidate_of(choice); };
  setup.keep_apart = [this](const models::TeamChoice& a, const models::TeamChoice& b) {
    return models::keeps_separation(a.trajectory, b.trajectory, problem_.start_time,
                                    required_separation_m(problem_, a.trajectory, b.trajectory),
                                    models::kPlanPiece_s, problem_.separation_from_above);
  };
  return setup;
}

bool TeamExchange::is_jammed(const std::string& robot) const {
  return std::find(jammed_.begin(), jammed_.end(), robot) != jammed_.end();
}

Candidate TeamExchange::candidate_of(const models::TeamChoice& choice) const {
  const auto robot = std::find_if(robots_.begin(), robots_.end(),
                                  [&](const auto& each) { return each.name == choice.robot; });
  const bool sees = robot != robots_.end() && !is_jammed(choice.robot);
  Candidate candidate = make_candidate(problem_, sees ? &robot->sensor : nullptr, choice.trajectory,
                                       choice.energy_nats);
  if (sees) {
    candidate.unshared_nats =
        std::max(0.0, choice.information_nats - information_alone(beliefs_, candidate));
  }
  return candidate;
}

ReceiveOutcome TeamExchange::receive(const models::TeamProposal& proposal) {
  if (!session_.belongs_to_round(proposal)) {
    return ReceiveOutcome::kOtherRound;
  }
  const bool are_plans = std::all_of(
      proposal.choices.begin(), proposal.choices.end(), [&](const models::TeamChoice& choice) {
        return is_of_plan_length(choice.trajectory, planner_, robots_);
      });
  if (!are_plans || !session_.is_consistent(proposal)) {
    return ReceiveOutcome::kRefused;
  }
  return session_.receive(proposal) ? ReceiveOutcome::kTaken : ReceiveOutcome::kNotBetter;
}

std::optional<models::TeamProposal> TeamExchange::improve(const Deadline& deadline) {
  std::optional<models::TeamProposal> proposal = session_.improve(deadline);
  if (proposal) {
    proposal->nodes = nodes_;
  }
  return proposal;
}

}  // namespace vantage::planner
