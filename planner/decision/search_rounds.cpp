#include "planner/decision/search_rounds.hpp"

#include "core/index.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {
namespace {

// Returns the best single trajectory that is not excluded; an empty choice if there is none.
Choice best_single(const TeamOracle& oracle, std::span<const char> excluded) {
  CandidateId best = kNoCandidate;
  for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
    if (excluded[index(id)] == 0 &&
        (best == kNoCandidate || oracle.individual_value(id) > oracle.individual_value(best))) {
      best = id;
    }
  }
  Choice choice(index(oracle.robot_count()), kNoCandidate);
  if (best != kNoCandidate) {
    choice[index(oracle.robot_of(best))] = best;
  }
  return choice;
}

}  // namespace

TeamDecision search_in_two_rounds(const TeamOracle& oracle, const SearchRound& round) {
  TeamDecision decision;
  std::vector<char> excluded(index(oracle.candidate_count()), 0);
  TeamSet team(oracle);
  for (int k = 0; k < 2 && decision.finished; ++k) {
    const Choice end = round(best_single(oracle, excluded), excluded, decision);
    team.become(end);
    if (k == 0 || team.value() > decision.value) {
      decision.choice = end;
      decision.value = team.value();
    }
    for (const CandidateId id : end) {
      if (id != kNoCandidate) {
        excluded[index(id)] = 1;
      }
    }
    decision.optima.push_back(end);
  }
  return decision;
}

}  // namespace vantage::planner
