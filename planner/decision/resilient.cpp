#include "planner/decision/resilient.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {

std::vector<int> bait_robots(std::span<const double> individual_values, int attacks_max) {
  require(attacks_max >= 0, "resilient planning: attacks_max must be ≥ 0");
  std::vector<int> robots(individual_values.size());
  std::iota(robots.begin(), robots.end(), 0);
  std::stable_sort(robots.begin(), robots.end(), [&](int a, int b) {
    return individual_values[index(a)] > individual_values[index(b)];
  });
  robots.resize(std::min(robots.size(), index(attacks_max)));
  std::sort(robots.begin(), robots.end());
  return robots;
}

ResilientRound::ResilientRound(std::span<const double> individual_values, int attacks_max)
    : bait_(bait_robots(individual_values, attacks_max)) {
  for (int robot = 0; robot < std::ssize(individual_values); ++robot) {
    if (!is_bait(robot)) {
      non_bait_.push_back(robot);
    }
  }
}

bool ResilientRound::is_bait(int robot) const {
  return std::binary_search(bait_.begin(), bait_.end(), robot);
}

std::vector<int> ResilientRound::robots_without_sensing_for(int robot) const {
  if (!is_bait(robot)) {
    return bait_;
  }
  std::vector<int> all(bait_.size() + non_bait_.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<int> plan_resiliently(int robot_count, int attacks_max, const PlanAlone& alone,
                                  const PlanTogether& together) {
  std::vector<double> individual_values(index(robot_count), 0.0);
  if (attacks_max > 0) {
    for (int robot = 0; robot < robot_count; ++robot) {
      individual_values[index(robot)] = alone(robot);
    }
  }
  const ResilientRound round(individual_values, attacks_max);
  if (!round.non_bait().empty()) {
    together(round.non_bait());
  }
  return round.bait();
}

std::vector<int> plan_resiliently(int robot_count, int attacks_max, const PlanRobot& plan) {
  const auto in_turn = [&](const std::vector<int>& robots) {
    std::vector<int> planned;
    for (const int robot : robots) {
      if (attacks_max == 0 || !planned.empty()) {  // otherwise the robot has just planned alone
        plan(robot, planned);
      }
      planned.push_back(robot);
    }
  };
  return plan_resiliently(
      robot_count, attacks_max, [&](int robot) { return plan(robot, {}); }, in_turn);
}

TeamDecision plan_resiliently(const TeamOracle& oracle, int attacks_max, SubSolver sub_solver) {
  const std::vector<double> individual_values = best_individual_values(oracle);
  TeamDecision decision;
  decision.choice.assign(individual_values.size(), kNoCandidate);
  const std::vector<int> bait = plan_resiliently(
      oracle.robot_count(), attacks_max, [&](int robot) { return individual_values[index(robot)]; },
      [&](const std::vector<int>& robots) {
        decision = sub_solver == SubSolver::kExhaustive
                       ? exhaustive_optimum(oracle, robots)
                       : coordinate_descent(oracle, {robots, 1, true});
      });
  for (const int robot : bait) {
    const auto sorted = oracle.by_value(robot);
    if (!sorted.empty()) {
      decision.choice[index(robot)] = sorted.front();
    }
  }
  TeamSet team(oracle);
  team.become(decision.choice);
  decision.value = team.value();
  decision.messages = 2 * oracle.robot_count();  // each robot sends its value and its choice
  return decision;
}

std::vector<double> best_individual_values(const TeamOracle& oracle) {
  std::vector<double> values;
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    const auto sorted = oracle.by_value(robot);
    values.push_back(sorted.empty() ? 0.0 : oracle.individual_value(sorted.front()));
  }
  return values;
}

}  // namespace vantage::planner
