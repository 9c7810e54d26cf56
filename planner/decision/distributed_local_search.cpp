#include "planner/decision/distributed_local_search.hpp"

#include "core/index.hpp"
#include "planner/decision/best_addition.hpp"
#include "planner/decision/proposal_search.hpp"
#include "planner/decision/search_rounds.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {
namespace {

// One round: all robots search around one shared solution.
class TeamRound {
 public:
  TeamRound(const TeamOracle& oracle, const ImprovementRule& rule,
            const DistributedOptions& options, const Deadline& deadline, TeamDecision& decision)
      : oracle_(oracle),
        rule_(rule),
        lazy_(options.lazy && oracle.is_submodular()),
        deadline_(deadline),
        decision_(decision),
        team_(oracle),
        calls_before_(decision.oracle_calls) {
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      searches_.emplace_back(oracle, rule, robot, lazy_);
    }
  }

  Choice run(const Choice& start, std::span<const char> excluded, bool warm_start) {
    team_.become(start);
    decision_.messages += oracle_.robot_count();  // one message per robot: |Mᵢ|, best candidate
    if (warm_start) {
      add_greedily(excluded);
    }
    while (decision_.finished) {
      const Proposal found = propose(excluded);
      if (found.is_nothing()) {
        break;
      }
      adopt_by_all(found);
    }
    return team_.choice();
  }

 private:
  void count_calls() {
    decision_.oracle_calls = calls_before_ + team_.calls();
    for (const ProposalSearch& search : searches_) {
      decision_.oracle_calls += search.calls();
    }
    decision_.finished = !deadline_.expired(decision_.oracle_calls);
  }

  void adopt_by_all(const Proposal& proposal) {
    team_.become(adopt(oracle_, team_.choice(), proposal));
    ++decision_.adopted;
  }

  // Robots without a trajectory propose their best additions one after another; a robot that has
  // received a better proposal sends none. The best one is adopted.
  void add_greedily(std::span<const char> excluded) {
    std::vector<BestAddition> additions;
    for (int robot = 0; robot < oracle_.robot_count(); ++robot) {
      additions.emplace_back(oracle_, robot, lazy_);
    }
    while (decision_.finished) {
      Proposal best;
      for (int robot = 0; robot < oracle_.robot_count(); ++robot) {
        if (team_.choice()[index(robot)] != kNoCandidate) {
          continue;
        }
        const Proposal own = additions[index(robot)].find(team_, excluded);
        if (!own.is_nothing() && rule_.improves(team_.value(), own.value) &&
            (best.is_nothing() || is_preferred(own, best))) {
          best = own;
          ++decision_.messages;
        }
      }
      count_calls();
      if (best.is_nothing()) {
        return;
      }
      adopt_by_all(best);
    }
  }

  // Runs ticks of one oracle call per searching robot, until a robot proposes.
  Proposal propose(std::span<const char> excluded) {
    std::vector<ProposalSearch*> searching;
    for (ProposalSearch& search : searches_) {
      search.begin(team_.choice(), team_.value(), excluded);
      searching.push_back(&search);
    }
    Proposal best;
    while (best.is_nothing() && !searching.empty() && decision_.finished) {
      std::erase_if(searching, [&](ProposalSearch* search) {
        const ProposalSearch::State state = search->advance();
        if (state == ProposalSearch::State::kSearching) {
          return false;
        }
        ++decision_.messages;
        if (state == ProposalSearch::State::kProposes &&
            (best.is_nothing() || is_preferred(search->proposal(), best))) {
          best = search->proposal();
        }
        return true;
      });
      count_calls();
    }
    return best;
  }

  const TeamOracle& oracle_;
  const ImprovementRule& rule_;
  bool lazy_;
  const Deadline& deadline_;
  TeamDecision& decision_;
  TeamSet team_;
  std::int64_t calls_before_;
  std::vector<ProposalSearch> searches_;
};

}  // namespace

TeamDecision distributed_local_search(const TeamOracle& oracle, const DistributedOptions& options,
                                      const Deadline& deadline) {
  const ImprovementRule rule(oracle, options.alpha);
  return search_in_two_rounds(
      oracle, [&](const Choice& start, std::span<const char> excluded, TeamDecision& decision) {
        return TeamRound(oracle, rule, options, deadline, decision)
            .run(start, excluded, options.warm_start);
      });
}

}  // namespace vantage::planner
