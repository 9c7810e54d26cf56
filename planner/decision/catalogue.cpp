#include "planner/decision/catalogue.hpp"

#include <algorithm>
#include <numeric>

#include "core/index.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/distributed_local_search.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/local_search.hpp"
#include "planner/decision/resilient.hpp"

namespace vantage::planner {
namespace {

std::vector<int> all_robots(const TeamOracle& oracle) {
  std::vector<int> robots(index(oracle.robot_count()));
  std::iota(robots.begin(), robots.end(), 0);
  return robots;
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

}  // namespace

bool DecisionAlgorithm::uses(std::string_view option) const {
  return std::ranges::find(options, option) != options.end();
}

double attack_count(int robots, int attacks_max) {
  double sum = 1.0;
  double of_size = 1.0;
  for (int k = 1; k <= std::min(robots, attacks_max); ++k) {
    of_size *= static_cast<double>(robots - k + 1) / k;
    sum += of_size;
  }
  return sum;
}

// Long function: it contains a table with one entry per algorithm.
const std::vector<DecisionAlgorithm>& all_decision_algorithms() {
  using Options = DecisionOptions;
  static const std::vector<DecisionAlgorithm> kAll = {
      {.name = "coordinate_descent",
       .what = "each robot in turn takes the candidate that adds most to the earlier choices",
       .options = {"order", "rounds_max", "energy"},
       .decide =
           [](const TeamOracle& oracle, const Options& options, const Deadline& deadline) {
             return coordinate_descent(oracle, {options.order, options.rounds_max, true}, deadline);
           }},
      {.name = "greedy",
       .what = "repeatedly adds the candidate, of any robot, that adds most value",
       .options = {"energy"},
       .decide = [](const TeamOracle& oracle, const Options& /*options*/,
                    const Deadline& /*deadline*/) { return greedy(oracle); }},
      {.name = "local_search",
       .what = "central: adds, removes and swaps candidates while the value improves",
       .options = {"alpha", "energy"},
       .decide =
           [](const TeamOracle& oracle, const Options& options, const Deadline& deadline) {
             return centralised_local_search(oracle, options.alpha, deadline);
           }},
      {.name = "distributed_local_search",
       .what = "local_search, distributed: the robots exchange proposals",
       .options = {"alpha", "energy"},
       .decide =
           [](const TeamOracle& oracle, const Options& options, const Deadline& deadline) {
             return distributed_local_search(oracle, {options.alpha, true, true}, deadline);
           }},
      {.name = "exhaustive",
       .what = "evaluates all choices: the optimum, for small teams",
       .options = {"energy"},
       .is_optimal = true,
       .evaluations =
           [](const TeamOracle& oracle, const Options& /*options*/) {
             return choices(oracle, all_robots(oracle), true);
           },
       .decide =
           [](const TeamOracle& oracle, const Options& /*options*/, const Deadline& /*deadline*/) {
             return exhaustive_optimum(oracle, all_robots(oracle));
           }},
      {.name = "resilient",
       .what = "robust to attacks: bait robots choose alone, the others by coordinate descent",
       .options = {"attacks_max"},
       .has_bait = true,
       .decide =
           [](const TeamOracle& oracle, const Options& options, const Deadline& /*deadline*/) {
             return plan_resiliently(oracle, options.attacks_max, SubSolver::kCoordinateDescent);
           }},
      {.name = "resilient_exhaustive",
       .what = "robust to attacks: bait robots choose alone, the others exhaustively",
       .options = {"attacks_max"},
       .has_bait = true,
       .evaluations =
           [](const TeamOracle& oracle, const Options& options) {
             return choices(
                 oracle,
                 ResilientRound(best_individual_values(oracle), options.attacks_max).non_bait(),
                 true);
           },
       .decide =
           [](const TeamOracle& oracle, const Options& options, const Deadline& /*deadline*/) {
             return plan_resiliently(oracle, options.attacks_max, SubSolver::kExhaustive);
           }},
      {.name = "max_min",
       .what = "evaluates all choices under all attacks: the robust optimum, for small teams",
       .options = {"attacks_max"},
       .evaluations =
           [](const TeamOracle& oracle, const Options& options) {
             return choices(oracle, all_robots(oracle), false) *
                    attack_count(oracle.robot_count(), options.attacks_max);
           },
       .decide =
           [](const TeamOracle& oracle, const Options& options, const Deadline& /*deadline*/) {
             return exhaustive_max_min(oracle, options.attacks_max);
           }}};
  return kAll;
}

}  // namespace vantage::planner
