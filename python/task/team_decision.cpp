#include "python/task/team_decision.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/distributed_local_search.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/local_search.hpp"
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

using planner::SearchProblem;
using planner::SearchResult;
using planner::TeamDecision;
using planner::TeamOracle;
using planner::TeamProblem;

constexpr std::string_view kRain = "rain";
constexpr std::string_view kExhaustive = "exhaustive";
// Maximum number of sets that are evaluated one by one; evaluating that number takes some seconds.
constexpr double kMostSets = 1e6;

bool has(const TeamAlgorithm& algorithm, std::string_view option) {
  return std::ranges::find(algorithm.options, option) != algorithm.options.end();
}

std::string names_of(const std::function<bool(const TeamAlgorithm&)>& is_meant) {
  std::string names;
  for (const TeamAlgorithm& each : team_algorithms()) {
    if (is_meant(each)) {
      names.append(names.empty() ? "" : ", ").append(each.name);
    }
  }
  return names;
}

const TeamAlgorithm& called(const std::string& name) {
  const auto found = std::ranges::find(team_algorithms(), name, &TeamAlgorithm::name);
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
  const TeamAlgorithm& algorithm = called(request.algorithm);
  const auto only = [&](std::string_view option, bool is_given) {
    require(
        !is_given || has(algorithm, option),
        fmt::format("{}: is an option of {}, not of {}", option,
                    names_of([&](const auto& each) { return has(each, option); }), algorithm.name));
  };
  only("attacks_max", request.attacks_max != 0);
  only("order", !request.order.empty());
  only("rounds_max", request.rounds_max != 1);
  only("alpha", request.alpha != 1.0);
  only("energy", !request.energy.empty());
  only("planner", request.search != nullptr);
  require(request.attacks_max >= 0 && request.attacks_max <= robots,
          fmt::format("attacks_max: must be ≥ 0 and ≤ {}, the number of robots, got {}", robots,
                      request.attacks_max));
  require_order(request.order, robots);
  require(request.rounds_max >= 1,
          fmt::format("rounds_max: must be ≥ 1, got {}", request.rounds_max));
  require(std::isfinite(request.alpha) && request.alpha > 0.0,
          fmt::format("alpha: must be > 0, got {}", request.alpha));
  require(request.nodes >= 1, fmt::format("nodes: must be ≥ 1, got {}", request.nodes));
  require(request.candidates.candidates_max >= 1,
          fmt::format("candidates_max: must be ≥ 1, got {}", request.candidates.candidates_max));
  for (const auto& [name, value] : {std::pair("epsilon", request.candidates.epsilon),
                                    std::pair("delta_m", request.candidates.delta_m)}) {
    require(std::isfinite(value) && value >= 0.0,
            fmt::format("{}: must be ≥ 0, got {}", name, value));
  }
  require(request.energy.empty() || request.energy.size() == index(robots),
          fmt::format("energy: must have one entry per robot, {}, got {}", robots,
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
          fmt::format("{}: leaves {:.3g} choices to evaluate one by one; the limit is {:.0f}",
                      argument, sets, kMostSets));
}

// Returns the number of ways to choose one candidate per robot; if `may_rest`, a robot may also
// have none.
double choices(const TeamOracle& oracle, const std::vector<int>& robots, bool may_rest) {
  double product = 1.0;
  for (const int robot : robots) {
    const int candidates = oracle.end(robot) - oracle.begin(robot);
    product *= may_rest ? candidates + 1 : std::max(1, candidates);
  }
  return product;
}

// Returns Σ_{k ≤ k_max} C(n, k).
double subsets(int n, int k_max) {
  double sum = 1.0;
  double of_size = 1.0;
  for (int k = 1; k <= std::min(n, k_max); ++k) {
    of_size *= static_cast<double>(n - k + 1) / k;
    sum += of_size;
  }
  return sum;
}

std::vector<int> all_robots(const TeamOracle& oracle) {
  std::vector<int> robots(index(oracle.robot_count()));
  std::iota(robots.begin(), robots.end(), 0);
  return robots;
}

TeamDecision choose_resiliently(const TeamOracle& oracle, const TeamRequest& request,
                                const std::vector<int>& rest) {
  if (request.algorithm == "resilient") {
    return plan_resiliently(oracle, request.attacks_max, planner::SubSolver::kCoordinateDescent);
  }
  if (request.algorithm == "max_min") {
    require_few("candidates_max", choices(oracle, all_robots(oracle), false) *
                                      subsets(oracle.robot_count(), request.attacks_max));
    return exhaustive_max_min(oracle, request.attacks_max);
  }
  require_few("candidates_max", choices(oracle, rest, true));
  return plan_resiliently(oracle, request.attacks_max, planner::SubSolver::kExhaustive);
}

TeamDecision choose(const TeamOracle& oracle, const TeamRequest& request) {
  const Deadline deadline = Deadline::never().unless(request.is_cancelled);
  if (request.algorithm == "coordinate_descent") {
    return coordinate_descent(oracle, {request.order, request.rounds_max, true}, deadline);
  }
  if (request.algorithm == "greedy") {
    return greedy(oracle);
  }
  if (request.algorithm == "local_search") {
    return centralised_local_search(oracle, request.alpha, deadline);
  }
  if (request.algorithm == "distributed_local_search") {
    return distributed_local_search(oracle, {request.alpha, true, true}, deadline);
  }
  require_few("candidates_max", choices(oracle, all_robots(oracle), true));
  return exhaustive_optimum(oracle, all_robots(oracle));
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
  return candidate_trajectories(problem, energy, search, options,
                                Deadline::nodes(request.nodes).unless(request.is_cancelled));
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
  return planner::plan_resiliently(static_cast<int>(problems.size()), request.attacks_max, plan);
}

}  // namespace

const std::vector<TeamAlgorithm>& team_algorithms() {
  static const std::vector<TeamAlgorithm> kAll = {
      {"coordinate_descent",
       "each robot in turn takes the candidate that adds most to the earlier choices",
       {"order", "rounds_max", "energy"}},
      {"greedy", "repeatedly adds the candidate, of any robot, that adds most value", {"energy"}},
      {"local_search",
       "central: adds, removes and swaps candidates while the value improves",
       {"alpha", "energy"}},
      {"distributed_local_search",
       "local_search, distributed: the robots exchange proposals",
       {"alpha", "energy"}},
      {kExhaustive, "evaluates all choices: the optimum, for small teams", {"energy"}},
      {"resilient",
       "robust to attacks: bait robots choose alone, the others by coordinate descent",
       {"attacks_max"}},
      {"resilient_exhaustive",
       "robust to attacks: bait robots choose alone, the others exhaustively",
       {"attacks_max"}},
      {"max_min",
       "evaluates all choices under all attacks: the robust optimum, for small teams",
       {"attacks_max"}},
      {kRain,
       "robots search in turn, given the earlier plans; with attacks_max, bait robots search alone",
       {"attacks_max", "planner"}}};
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
  const bool searches = algorithm_ == kRain;
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
    decided_.messages = (request.attacks_max > 0 ? 2 : 1) * oracle_->robot_count();
  } else if (has(called(algorithm_), "attacks_max")) {
    const planner::ResilientRound round(best_alone(*oracle_), request.attacks_max);
    bait_ = algorithm_ == "max_min" ? std::vector<int>() : round.bait();
    decided_ = choose_resiliently(*oracle_, request, round.rest());
  } else {
    decided_ = choose(*oracle_, request);
  }
  planner::TeamSet chosen(*oracle_);
  chosen.become(decided_.choice);
  value_ = chosen.value();
  if (algorithm_ == kExhaustive) {
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
  require_few("attacks_max", subsets(oracle_->robot_count(), attacks_max));
  return planner::worst_attack(*oracle_, decided_.choice, attacks_max);
}

}  // namespace vantage::python
