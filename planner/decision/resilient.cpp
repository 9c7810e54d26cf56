#include "planner/decision/resilient.hpp"

#include <algorithm>
#include <numeric>

#include "core/check.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {

std::vector<int> bait_robots(std::span<const double> values_alone, int attacks_max) {
  require(attacks_max >= 0, "resilient planning: attacks_max must be ≥ 0");
  std::vector<int> robots(values_alone.size());
  std::iota(robots.begin(), robots.end(), 0);
  std::stable_sort(robots.begin(), robots.end(), [&](int a, int b) {
    return values_alone[static_cast<std::size_t>(a)] > values_alone[static_cast<std::size_t>(b)];
  });
  robots.resize(std::min(robots.size(), static_cast<std::size_t>(attacks_max)));
  std::sort(robots.begin(), robots.end());
  return robots;
}

TeamDecision plan_resiliently(const TeamOracle& oracle, int attacks_max, SubSolver sub_solver) {
  std::vector<double> values_alone;
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    const auto sorted = oracle.by_value(robot);
    values_alone.push_back(sorted.empty() ? 0.0 : oracle.alone(sorted.front()));
  }
  const std::vector<int> bait = bait_robots(values_alone, attacks_max);
  std::vector<int> rest;
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    if (!std::binary_search(bait.begin(), bait.end(), robot)) {
      rest.push_back(robot);
    }
  }
  TeamDecision decision;
  if (rest.empty()) {
    decision.choice.assign(static_cast<std::size_t>(oracle.robot_count()), kNoCandidate);
  } else if (sub_solver == SubSolver::kExhaustive) {
    decision = exhaustive_optimum(oracle, rest);
  } else {
    DescentOptions options;
    options.order = rest;
    decision = coordinate_descent(oracle, options);
  }
  for (const int robot : bait) {
    const auto sorted = oracle.by_value(robot);
    if (!sorted.empty()) {
      decision.choice[static_cast<std::size_t>(robot)] = sorted.front();
    }
  }
  TeamSet team(oracle);
  team.become(decision.choice);
  decision.value = team.value();
  decision.messages = 2 * oracle.robot_count();  // the value alone, then the choice
  return decision;
}

std::vector<int> plan_round_resiliently(int robot_count, int attacks_max, const PlanRobot& plan) {
  std::vector<int> bait;
  if (attacks_max > 0) {
    std::vector<double> values_alone;
    for (int robot = 0; robot < robot_count; ++robot) {
      values_alone.push_back(plan(robot, {}));
    }
    bait = bait_robots(values_alone, attacks_max);
  }
  std::vector<int> planned;
  for (int robot = 0; robot < robot_count; ++robot) {
    if (std::binary_search(bait.begin(), bait.end(), robot)) {
      continue;
    }
    if (attacks_max == 0 || !planned.empty()) {  // else it has just planned alone
      plan(robot, planned);
    }
    planned.push_back(robot);
  }
  return bait;
}

}  // namespace vantage::planner
