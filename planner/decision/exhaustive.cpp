#include "planner/decision/exhaustive.hpp"

#include <functional>
#include <numeric>

#include "core/check.hpp"
#include "planner/decision/attack.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {
namespace {

// Calls of(team) for every choice of one candidate (or none, if `may_rest`) for robots[at] and
// later.
void for_each_choice(const TeamOracle& oracle, const std::vector<int>& robots, std::size_t at,
                     bool may_rest, TeamSet& team, const std::function<void(TeamSet&)>& of) {
  if (at == robots.size()) {
    of(team);
    return;
  }
  const int robot = robots[at];
  if (may_rest || oracle.begin(robot) == oracle.end(robot)) {
    for_each_choice(oracle, robots, at + 1, may_rest, team, of);
  }
  for (CandidateId id = oracle.begin(robot); id < oracle.end(robot); ++id) {
    team.add(id);
    for_each_choice(oracle, robots, at + 1, may_rest, team, of);
    team.drop(robot);
  }
}

}  // namespace

TeamDecision exhaustive_optimum(const TeamOracle& oracle, const std::vector<int>& robots) {
  for (const int robot : robots) {
    require(robot >= 0 && robot < oracle.robot_count(),
            "exhaustive optimum: robot must be in [0, robot_count)");
  }
  TeamDecision best;
  TeamSet team(oracle);
  for_each_choice(oracle, robots, 0, true, team, [&](TeamSet& set) {
    ++best.oracle_calls;
    if (best.choice.empty() || set.value() > best.value) {
      best.choice = set.choice();
      best.value = set.value();
    }
  });
  return best;
}

TeamDecision exhaustive_max_min(const TeamOracle& oracle, int attacks_max) {
  std::vector<int> robots(static_cast<std::size_t>(oracle.robot_count()));
  std::iota(robots.begin(), robots.end(), 0);
  TeamDecision best;
  TeamSet team(oracle);
  for_each_choice(oracle, robots, 0, false, team, [&](TeamSet& set) {
    const Attack worst = worst_attack(oracle, set.choice(), attacks_max);
    best.oracle_calls += worst.oracle_calls;
    if (best.choice.empty() || worst.value > best.value) {
      best.choice = set.choice();
      best.value = worst.value;
    }
  });
  return best;
}

}  // namespace vantage::planner
