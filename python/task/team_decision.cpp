#include "python/task/team_decision.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/decision/local_search_session.hpp"
#include "planner/decision/paths_bound.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/decision/team_bound.hpp"
#include "planner/decision/team_set.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/search/catalogue.hpp"
#include "tools/plan/plan_report.hpp"
#include "tools/plan/solver.hpp"

namespace vantage::python {
namespace {

using planner::DecisionAlgorithm;
using planner::SearchProblem;
using planner::SearchResult;
using planner::TeamOracle;
using planner::TeamProblem;

// Maximum number of choices or attacks that are evaluated one by one, which takes some seconds.
constexpr double kMostSets = 1e6;

std::string names_of(const std::function<bool(const DecisionAlgorithm&)>& is_meant) {
  std::string names;
  for (const DecisionAlgorithm& each : team_algorithms()) {
    if (is_meant(each)) {
      names.append(names.empty() ? "" : ", ").append(each.name);
    }
  }
  return names;
}

const DecisionAlgorithm& called(const std::string& name) {
  const auto found = std::ranges::find(team_algorithms(), name, &DecisionAlgorithm::name);
  if (found == team_algorithms().end()) {
    throw UsageError(fmt::format("algorithm: must be one of {}, got {}",
                                 names_of([](const auto&) { return true; }), name));
  }
  return *found;
}

void require_order(const std::vector<int>& order, int robots) {
  std::vector<int> sorted = order;
  std::ranges::sort(sorted);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    require(sorted[i] >= 0 && sorted[i] < robots,
            fmt::format("order: must contain robots from 0 to {}, got {}", robots - 1, sorted[i]));
    require(i == 0 || sorted[i] != sorted[i - 1],
            fmt::format("order: must contain each robot at most once, has {} twice", sorted[i]));
  }
}

void require_sense(const TeamRequest& request, int robots) {
  const DecisionAlgorithm& algorithm = called(request.algorithm);
  const auto only = [&](std::string_view option, bool is_given) {
    require(
        !is_given || algorithm.uses(option),
        fmt::format("{}: is an option of {}, not of {}", option,
                    names_of([&](const auto& each) { return each.uses(option); }), algorithm.name));
  };
  only("attacks_max", request.options.attacks_max != 0);
  only("order", !request.options.order.empty());
  only("rounds_max", request.options.rounds_max != 1);
  only("alpha", request.options.alpha != 1.0);
  only("energy", !request.energy.empty());
  only("planner", request.search != nullptr);
  require(request.options.attacks_max >= 0 && request.options.attacks_max <= robots,
          fmt::format("attacks_max: must be ≥ 0 and ≤ the number of robots ({}), got {}", robots,
                      request.options.attacks_max));
  require_order(request.options.order, robots);
  require(request.options.rounds_max >= 1,
          fmt::format("rounds_max: must be ≥ 1, got {}", request.options.rounds_max));
  require(std::isfinite(request.options.alpha) && request.options.alpha > 0.0,
          fmt::format("alpha: must be > 0, got {}", request.options.alpha));
  require(request.nodes >= 1, fmt::format("nodes: must be ≥ 1, got {}", request.nodes));
  require(request.candidates.candidates_max >= 1,
          fmt::format("candidates_max: must be ≥ 1, got {}", request.candidates.candidates_max));
  for (const auto& [name, value] : {std::pair("epsilon", request.candidates.epsilon),
                                    std::pair("delta_m", request.candidates.delta_m)}) {
    require(std::isfinite(value) && value >= 0.0,
            fmt::format("{}: must be ≥ 0, got {}", name, value));
  }
  require(request.energy.empty() || request.energy.size() == index(robots),
          fmt::format("energy: must have one entry per robot ({}), got {}", robots,
                      request.energy.size()));
}

bool is_same(const planner::SearchTarget& a, const planner::SearchTarget& b) {
  return a.model == b.model && a.prior.mean.size() == b.prior.mean.size() &&
         a.prior.mean == b.prior.mean && a.prior.covariance == b.prior.covariance;
}

void require_team(const std::vector<SearchProblem>& problems) {
  require(!problems.empty(), "problems: must contain at least one robot");
  const SearchProblem& first = problems.front();
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const SearchProblem& own = problems[i];
    const auto equal = [&](bool holds, std::string_view what) {
      require(holds, fmt::format("problems[{}]: {}: must be equal to problems[0]", i, what));
    };
    equal(own.horizon_steps == first.horizon_steps, "T");
    equal(own.step_s == first.step_s, "tau");
    equal(std::ranges::equal(own.targets, first.targets, is_same), "targets and their beliefs");
    require(own.cost == planner::CostKind::kLogDet,
            fmt::format("problems[{}]: cost: must be logdet, the only cost for teams", i));
  }
}

void require_few(const char* argument, double sets) {
  require(sets <= kMostSets,
          fmt::format("{}: requires the evaluation of {:.3g} choices; the limit is {:.0f}",
                      argument, sets, kMostSets));
}

std::vector<int> all_robots(const TeamOracle& oracle) {
  std::vector<int> robots(index(oracle.robot_count()));
  std::iota(robots.begin(), robots.end(), 0);
  return robots;
}

std::vector<planner::Candidate> candidates_of(const SearchProblem& problem,
                                              const planner::EnergyModel& energy,
                                              const TeamRequest& request) {
  constexpr std::size_t kMemoryMost = std::size_t{512} << 20U;
  constexpr std::size_t kLeavesMax = 2'000;  // number of leaves; about 10 µs each
  planner::CandidateOptions options = request.candidates;
  options.is_anytime = true;
  options.leaves_max = std::max(kLeavesMax, options.candidates_max);
  planner::ReducedValueIteration search(
      capacity_for(planner::algorithm_called("arvi"), problem, kMemoryMost, index(request.nodes)));
  return candidate_trajectories(
      problem, energy, search, options,
      Deadline::nodes(request.nodes).with_cancellation(request.is_cancelled));
}

// Searches the robots' plans in turn, each given the plans of its teammates. The last plan of each
// robot becomes its only candidate in `team`. Returns the bait robots.
std::vector<int> search_in_turn(std::vector<SearchProblem> problems, const TeamRequest& request,
                                TeamProblem& team) {
  tools::PlanRequest by_default;
  by_default.nodes = request.nodes;
  tools::Solver solver(by_default);
  std::vector<SearchResult> plans(problems.size());
  const auto plan = [&](int robot, const std::vector<int>& teammate_ids) {
    SearchProblem& problem = problems[index(robot)];
    std::vector<planner::FixedTeammate> teammates;
    for (const int other : teammate_ids) {
      if (!team.candidates[index(other)].empty()) {
        const SearchProblem& theirs = problems[index(other)];
        teammates.push_back(
            {to_trajectory(theirs, plans[index(other)]), theirs.sensors.front(), false});
      }
    }
    problem.fixed_information.clear();
    if (!teammates.empty()) {
      problem.fixed_information = fixed_information(problem, teammates);
    }
    SearchResult& found = plans[index(robot)];
    found = request.search ? request.search(problem)
                           : solver.solve(problem, request.is_cancelled).result;
    std::vector<planner::Candidate>& own = team.candidates[index(robot)];
    own.clear();
    if (!tools::is_complete(problem, found)) {
      return 0.0;
    }
    own.push_back(make_candidate(problem, {}, found));
    return information_alone(team, own.front());
  };
  return planner::plan_resiliently(static_cast<int>(problems.size()), request.options.attacks_max,
                                   plan);
}

}  // namespace

const std::vector<DecisionAlgorithm>& team_algorithms() {
  static const std::vector<DecisionAlgorithm> kAll = [] {
    std::vector<DecisionAlgorithm> all = planner::all_decision_algorithms();
    all.push_back({.name = "rain",
                   .what =
                       "robots search in turn, each given the plans of the robots before it; "
                       "with attacks_max, the robots assumed to be attacked (bait) search alone",
                   .options = {"attacks_max", "planner"}});
    return all;
  }();
  return kAll;
}

Decision::Decision(std::vector<SearchProblem> problems, const TeamRequest& request)
    : algorithm_(request.algorithm) {
  require_team(problems);
  require_sense(request, static_cast<int>(problems.size()));
  for (SearchProblem& problem : problems) {
    problem.fixed_information.clear();
  }
  problems_ = problems;
  for (SearchProblem& problem : problems_) {
    problem.world = nullptr;
    problem.field = nullptr;
  }
  const SearchProblem& first = problems_.front();
  team_ = {first.targets, first.horizon_steps, first.step_s, request.measure, {}};
  team_.candidates.resize(problems.size());
  const DecisionAlgorithm& algorithm = called(algorithm_);
  const bool searches = algorithm.decide == nullptr;
  if (searches) {
    bait_ = search_in_turn(std::move(problems), request, team_);
  } else {
    for (std::size_t i = 0; i < problems.size(); ++i) {
      team_.candidates[i] = candidates_of(
          problems[i], request.energy.empty() ? planner::EnergyModel() : request.energy[i],
          request);
    }
  }
  oracle_ = std::make_unique<TeamOracle>(team_);
  if (searches) {
    for (const int robot : all_robots(*oracle_)) {
      const bool is_planned = !team_.candidates[index(robot)].empty();
      decided_.choice.push_back(is_planned ? oracle_->begin(robot) : planner::kNoCandidate);
    }
    // As in plan_resiliently(): each robot sends one message with its choice and, if there are
    // attacks, one with the value of its own plan.
    decided_.messages = (request.options.attacks_max > 0 ? 2 : 1) * oracle_->robot_count();
  } else {
    if (algorithm.has_bait) {
      bait_ = planner::ResilientRound(best_individual_values(*oracle_), request.options.attacks_max)
                  .bait();
    }
    if (algorithm.evaluations != nullptr) {
      require_few("candidates_max", algorithm.evaluations(*oracle_, request.options));
    }
    decided_ = algorithm.decide(*oracle_, request.options,
                                Deadline::never().with_cancellation(request.is_cancelled));
  }
  planner::TeamSet chosen(*oracle_);
  chosen.become(decided_.choice);
  value_ = chosen.value();
  if (algorithm.is_optimal) {
    bound_ = value_;
  } else if (!searches && oracle_->is_submodular()) {
    bound_ = value_bound(*oracle_, decided_.choice);
  }
}

std::vector<std::optional<std::size_t>> Decision::chosen() const {
  std::vector<std::optional<std::size_t>> chosen(decided_.choice.size());
  for (const int robot : all_robots(*oracle_)) {
    const planner::CandidateId id = decided_.choice[index(robot)];
    if (id != planner::kNoCandidate) {
      chosen[index(robot)] = index(id - oracle_->begin(robot));
    }
  }
  return chosen;
}

double Decision::paths_bound(int attacks_max, std::int64_t nodes, bool (*is_cancelled)()) const {
  require(attacks_max >= 0, fmt::format("attacks_max: must be ≥ 0, got {}", attacks_max));
  require(nodes >= 1, fmt::format("nodes: must be ≥ 1, got {}", nodes));
  planner::PathsBound bound(static_cast<int>(team_.targets.size()), team_.horizon_steps);
  return bound.under_attack(problems_, attacks_max, team_.measure, nodes, is_cancelled)
      .information_nats;
}

planner::Attack Decision::worst_attack(int attacks_max) const {
  require(attacks_max >= 0, fmt::format("attacks_max: must be ≥ 0, got {}", attacks_max));
  require_few("attacks_max", planner::attack_count(oracle_->robot_count(), attacks_max));
  return planner::worst_attack(*oracle_, decided_.choice, attacks_max);
}

}  // namespace vantage::python
