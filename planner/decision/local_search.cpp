#include "planner/decision/local_search.hpp"

#include "core/index.hpp"
#include "planner/decision/search_rounds.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {
namespace {

class OperationFinder {
 public:
  OperationFinder(const TeamOracle& oracle, const ImprovementRule& rule,
                  std::span<const char> excluded, TeamSet& team)
      : oracle_(oracle), rule_(rule), excluded_(excluded), team_(team) {}

  /// Returns the first operation that improves `team`, or no operation.
  Proposal find() {
    before_ = team_.value();
    for (int robot = 0; robot < oracle_.robot_count(); ++robot) {
      if (has(robot)) {
        const Proposal deletion{robot, kNoCandidate, team_.value_without(robot)};
        if (rule_.improves(before_, deletion.value)) {
          return deletion;
        }
      }
    }
    Proposal found = find_addition(-1);
    for (int robot = 0; found.is_nothing() && robot < oracle_.robot_count(); ++robot) {
      if (!has(robot)) {
        continue;
      }
      const CandidateId dropped = team_.choice()[index(robot)];
      team_.drop(robot);
      found = find_addition(robot);
      team_.add(dropped);
    }
    return found;
  }

 private:
  [[nodiscard]] bool has(int robot) const { return team_.choice()[index(robot)] != kNoCandidate; }
  Proposal find_addition(int dropped_robot) {
    for (CandidateId id = 0; id < oracle_.candidate_count(); ++id) {
      if (has(oracle_.robot_of(id)) || excluded_[index(id)] != 0) {
        continue;
      }
      const double value = team_.value_with(id);
      if (rule_.improves(before_, value)) {
        return {dropped_robot, id, value};
      }
    }
    return {};
  }

  const TeamOracle& oracle_;
  const ImprovementRule& rule_;
  std::span<const char> excluded_;
  TeamSet& team_;
  double before_ = 0.0;
};

}  // namespace

TeamDecision centralised_local_search(const TeamOracle& oracle, double alpha,
                                      const Deadline& deadline) {
  const ImprovementRule rule(oracle, alpha);
  return search_in_two_rounds(
      oracle, [&](const Choice& start, std::span<const char> excluded, TeamDecision& decision) {
        TeamSet team(oracle);
        team.become(start);
        OperationFinder finder(oracle, rule, excluded, team);
        const std::int64_t calls_before = decision.oracle_calls;
        for (;;) {
          if (deadline.expired(decision.oracle_calls)) {
            decision.finished = false;
            break;
          }
          const Proposal found = finder.find();
          decision.oracle_calls = calls_before + team.calls();
          if (found.is_nothing()) {
            break;
          }
          team.become(adopt(oracle, team.choice(), found));
          ++decision.adopted;
        }
        return team.choice();
      });
}

}  // namespace vantage::planner
