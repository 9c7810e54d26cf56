#include "planner/decision/coordinate_descent.hpp"

#include <limits>
#include <numeric>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/decision/best_addition.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {
namespace {

// Returns the robot's candidate with the greatest positive gain found by the deadline; kNoCandidate
// if no gain is positive. Precondition: the robot has no candidate in `team`.
CandidateId best_given_team(const TeamOracle& oracle, TeamSet& team, int robot, bool lazy,
                            const Deadline& deadline) {
  const double before = team.value();
  double best_value = before;
  CandidateId best = kNoCandidate;
  for (const CandidateId id : oracle.by_value(robot)) {
    if ((lazy && oracle.individual_value(id) < best_value - before - kGainRounding_nats) ||
        deadline.expired(team.calls())) {
      break;
    }
    const double value = team.value_with(id);
    if (value > best_value) {
      best_value = value;
      best = id;
    }
  }
  return best;
}

}  // namespace

TeamDecision coordinate_descent(const TeamOracle& oracle, const DescentOptions& options,
                                const Deadline& deadline) {
  std::vector<int> order = options.order;
  if (order.empty()) {
    order.resize(static_cast<std::size_t>(oracle.robot_count()));
    std::iota(order.begin(), order.end(), 0);
  }
  const bool lazy = options.lazy && oracle.is_submodular();
  TeamSet team(oracle);
  TeamDecision decision;
  for (int round = 0; round < options.rounds_max && decision.finished; ++round) {
    const std::int64_t adopted_before = decision.adopted;
    for (const int robot : order) {
      require(robot >= 0 && robot < oracle.robot_count(),
              "coordinate descent: robot must be in [0, robot_count)");
      const CandidateId had = team.choice()[index(robot)];
      const double value_before = team.value();
      if (had != kNoCandidate) {
        team.drop(robot);
      }
      const CandidateId best = best_given_team(oracle, team, robot, lazy, deadline);
      if (best != kNoCandidate) {
        team.add(best);
      }
      if (had != kNoCandidate &&
          !(team.value() > value_before)) {  // the previous candidate is as good
        if (best != kNoCandidate) {
          team.drop(robot);
        }
        team.add(had);
      }
      decision.adopted += team.choice()[index(robot)] != had ? 1 : 0;
      ++decision.messages;
      decision.finished = !deadline.expired(team.calls());
      if (!decision.finished) {
        break;
      }
    }
    if (decision.adopted == adopted_before) {
      break;
    }
  }
  decision.choice = team.choice();
  decision.value = team.value();
  decision.oracle_calls = team.calls();
  return decision;
}

TeamDecision greedy(const TeamOracle& oracle) {
  TeamSet team(oracle);
  TeamDecision decision;
  std::vector<BestAddition> robots;
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    robots.emplace_back(oracle, robot, oracle.is_submodular());
  }
  for (;;) {
    Proposal best;
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      if (team.choice()[index(robot)] != kNoCandidate) {
        continue;
      }
      const Proposal own = robots[index(robot)].find(team, {});
      if (own.add != kNoCandidate && (best.is_nothing() || is_preferred(own, best))) {
        best = own;
      }
    }
    if (best.is_nothing() || !(best.value > team.value())) {
      break;
    }
    team.add(best.add);
    ++decision.adopted;
  }
  decision.choice = team.choice();
  decision.value = team.value();
  decision.oracle_calls = team.calls();
  return decision;
}

}  // namespace vantage::planner
