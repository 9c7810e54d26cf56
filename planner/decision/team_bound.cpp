#include "planner/decision/team_bound.hpp"

#include <algorithm>

#include "core/check.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {

double value_bound(const TeamOracle& oracle, const Choice& choice) {
  require(oracle.is_submodular(), "value_bound: information must be submodular (kMutual)");
  TeamSet team(oracle);
  team.become(choice);
  double alone = 0.0;
  double given_team = team.information();
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    double most = 0.0;
    for (const CandidateId id : oracle.by_value(robot)) {
      if (oracle.individual_value(id) <= most) {
        break;  // later candidates cannot add more
      }
      most = std::max(most, team.information_gain(id) + oracle.candidate(id).unshared_nats -
                                oracle.candidate(id).energy_cost);
    }
    given_team += most;
    if (!oracle.by_value(robot).empty()) {
      alone += std::max(0.0, oracle.individual_value(oracle.by_value(robot).front()));
    }
  }
  return std::min(alone, given_team);
}

}  // namespace vantage::planner
