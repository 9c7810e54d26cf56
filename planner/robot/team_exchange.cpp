#include "planner/robot/team_exchange.hpp"

#include <algorithm>
#include <utility>

#include "planner/robot/trajectory_tools.hpp"
#include "scenario/energy_cost.hpp"

namespace vantage::planner {
namespace {

// Looked at, of the complete plans that the search leaves: about 10 µs each.
constexpr std::size_t kLeavesMax = 2000;

models::Trajectory motion_of(const SearchProblem& problem, const Candidate& candidate) {
  SearchResult result;
  result.controls = candidate.controls;
  return to_trajectory(problem, result);
}

}  // namespace

TeamExchange::TeamExchange(const scenario::Scenario& scenario, int robot,
                           ReducedValueIteration& search)
    : robots_(scenario.robots), planner_(scenario.planner), robot_(robot), search_(search) {}

bool TeamExchange::is_jammed(const std::string& robot) const {
  return std::find(jammed_.begin(), jammed_.end(), robot) != jammed_.end();
}

double TeamExchange::kept_m(const models::Trajectory& a, const models::Trajectory& b) const {
  SearchProblem between;  // as a search keeps a from b
  between.start_time = problem_.start_time;
  between.start = a.start;
  between.height_m = a.height_m;
  between.teammates = {b};
  between.separation_m = problem_.separation_m;
  between.separation_from_above = problem_.separation_from_above;
  return kept_separation_m(between, 0);
}

Candidate TeamExchange::effect_of(const models::TeamChoice& choice) const {
  const auto robot = std::find_if(robots_.begin(), robots_.end(),
                                  [&](const auto& each) { return each.name == choice.robot; });
  const bool sees = robot != robots_.end() && !is_jammed(choice.robot);
  Candidate effect = make_candidate(problem_, sees ? &robot->sensor : nullptr, choice.trajectory,
                                    choice.energy_nats);
  if (sees) {
    effect.unshared_nats =
        std::max(0.0, choice.information_nats - information_alone(beliefs_, effect));
  }
  return effect;
}

void TeamExchange::begin(const SearchProblem& problem, const Start& start,
                         const Deadline& deadline) {
  session_.reset();
  problem_ = problem;
  jammed_ = start.jammed;
  round_ = start.round;
  beliefs_ = {
      problem_.targets, problem_.horizon_steps, problem_.step_s, InformationMeasure::kMutual, {}};
  const scenario::RobotSpec& spec = robots_[static_cast<std::size_t>(robot_)];
  CandidateOptions options;
  options.epsilon = planner_.epsilon_initial;
  options.delta_m = planner_.delta_initial_m;
  options.yaw_weight_m_per_rad = planner_.yaw_weight_m_per_rad;
  options.is_anytime = true;
  options.leaves_max = kLeavesMax;
  options.candidates_max = static_cast<std::size_t>(planner_.candidates_max);
  std::vector<Candidate> found =
      candidate_trajectories(problem_, spec.energy, search_, options, deadline);
  nodes_ = search_.result().replay_budget_nodes();

  SessionSetup setup;
  setup.robot = robot_;
  setup.round = start.round;
  setup.activation = problem_.start_time;
  setup.problem = beliefs_;
  setup.problem.candidates.resize(robots_.size());
  for (const scenario::RobotSpec& each : robots_) {
    setup.robots.push_back(each.name);
  }
  const auto add = [&](models::Trajectory motion, Candidate candidate) {
    if (start.is_safe(motion)) {
      if (is_jammed(spec.name)) {
        candidate.looks.clear();
        candidate.mutual_nats.reset();
      }
      setup.own.push_back({spec.name, std::move(motion), 0.0, 0.0});
      setup.problem.candidates[static_cast<std::size_t>(robot_)].push_back(std::move(candidate));
    }
  };
  add(start.rest, make_candidate(problem_, &spec.sensor, start.rest,
                                 spec.energy.price_nats * problem_.horizon_steps *
                                     scenario::step_cost(spec.energy, problem_.world, {0.0, 0.0},
                                                         problem_.start.position_m())));
  for (Candidate& candidate : found) {
    models::Trajectory motion = motion_of(problem_, candidate);
    add(std::move(motion), std::move(candidate));
  }
  setup.effect_of = [this](const models::TeamChoice& choice) { return effect_of(choice); };
  setup.keep_apart = [this](const models::TeamChoice& a, const models::TeamChoice& b) {
    return models::keeps_separation(a.trajectory, b.trajectory, problem_.start_time,
                                    kept_m(a.trajectory, b.trajectory), models::kPlanPiece_s,
                                    problem_.separation_from_above);
  };
  session_.emplace(std::move(setup));
}

std::optional<models::TeamChoice> TeamExchange::best_beside(
    const std::vector<models::TeamChoice>& others) {
  std::vector<std::string> names;
  for (const scenario::RobotSpec& each : robots_) {
    names.push_back(each.name);
  }
  models::TeamProposal committed;
  committed.stamp.time = problem_.start_time;
  committed.robot = names[static_cast<std::size_t>(robot_)];
  committed.round = round_;
  committed.value_nats = 1.0;  // any: only what is added counts
  committed.choices = others;
  committed.history = {fingerprint(names, others)};
  session_->hear(committed);
  const std::optional<models::TeamProposal> found = session_->improve(Deadline::never());
  session_.reset();
  const models::TeamChoice* own = found ? found->find(committed.robot) : nullptr;
  return own == nullptr ? std::nullopt : std::optional(*own);
}

bool TeamExchange::hear(const models::TeamProposal& proposal) {
  if (!session_ || !session_->is_of_round(proposal)) {
    return false;
  }
  const bool are_plans = std::all_of(
      proposal.choices.begin(), proposal.choices.end(), [&](const models::TeamChoice& choice) {
        return is_of_plan_length(choice.trajectory, planner_, robots_);
      });
  if (!are_plans || !session_->can_be(proposal)) {
    ++refused_;
    return false;
  }
  return session_->hear(proposal);
}

std::optional<models::TeamProposal> TeamExchange::improve(const Deadline& deadline) {
  std::optional<models::TeamProposal> proposal =
      session_ ? session_->improve(deadline) : std::nullopt;
  if (proposal) {
    proposal->nodes = nodes_;
  }
  return proposal;
}

}  // namespace vantage::planner
