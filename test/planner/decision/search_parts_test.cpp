#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/decision/best_addition.hpp"
#include "planner/decision/proposal_search.hpp"
#include "test/planner/decision/small_team.hpp"
#include "test/planner/decision/team_instance.hpp"
#include "test/planner/problem/random_problem.hpp"

// Compares the parts of team searches with plain implementations of their documented order.

namespace vantage::planner {
namespace {

using test::at;
using test::changed;
using test::kMeasures;
using test::made_team;
using test::value_of;

constexpr std::uint64_t kInstances = 200;

std::vector<char> drawn_exclusion(const TeamOracle& oracle, std::uint64_t seed) {
  std::mt19937_64 rng(seed + 99);
  std::vector<char> excluded(at(oracle.candidate_count()));
  for (char& each : excluded) {
    each = test::pick(rng, 0, 3) == 0 ? 1 : 0;
  }
  return excluded;
}

// ---- The improvement rule and ties ----

// A change improves if J increases and g' ≥ (1 + α/N⁴) g, where g = J + O and O is the sum of the
// highest cost of each robot.
TEST(ImprovementRule, RequiresAShareOfTheValuePlusHighestCosts) {
  const TeamProblem one = made_team(1, {{{0, 1.0, 3.0}}});
  const TeamOracle of_one(one);
  ASSERT_EQ(of_one.offset(), 3.0);
  const ImprovementRule rule(of_one, 0.5);
  EXPECT_FALSE(rule.improves(1.0, 2.999));
  EXPECT_TRUE(rule.improves(1.0, 3.001)) << "1.5 times 1 and 3";
  EXPECT_DOUBLE_EQ(rule.least(1.0), 3.0);
  const TeamProblem two = made_team(1, {{{0, 1.0, 3.0}}, {{0, 1.0, 1.0}}});
  const TeamOracle of_two(two);
  ASSERT_EQ(of_two.offset(), 4.0);
  const ImprovementRule finer(of_two, 0.5);
  EXPECT_FALSE(finer.improves(4.0, 4.249));
  EXPECT_TRUE(finer.improves(4.0, 4.251)) << "a sixteenth of a half, times 4, plus 4";
  EXPECT_DOUBLE_EQ(finer.least(4.0), 4.25);
  const ImprovementRule with_rise(of_two, 1e-9, 0.5);
  EXPECT_FALSE(with_rise.improves(4.0, 4.499));
  EXPECT_TRUE(with_rise.improves(4.0, 4.5));
  EXPECT_DOUBLE_EQ(with_rise.least(4.0), 4.5);
  // If no robot has candidates, N is 0. An unchanged value is still no improvement.
  const TeamProblem none = made_team(1, std::vector<std::vector<test::Made>>(1));
  const TeamOracle of_none(none);
  EXPECT_FALSE(ImprovementRule(of_none, 1.0).improves(0.0, 0.0));
  EXPECT_FALSE(ImprovementRule(of_none, 1.0).improves(1.0, 1.9));
  EXPECT_TRUE(ImprovementRule(of_none, 1.0).improves(1.0, 2.1));
}

TEST(ImprovementRule, RefusesInvalidShares) {
  const TeamProblem one = made_team(1, {{{0, 1.0, 3.0}}});
  const TeamOracle oracle(one);
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double alpha : {0.0, -1.0, inf, nan}) {
    EXPECT_THROW(ImprovementRule(oracle, alpha), UsageError) << alpha;
  }
  for (const double rise : {-1e-9, inf, nan}) {
    EXPECT_THROW(ImprovementRule(oracle, 1.0, rise), UsageError) << rise;
  }
  EXPECT_NO_THROW(ImprovementRule(oracle, 1e-30, 0.0));
}

TEST(ProposalOrder, PrefersValueThenLowNumbersThenDeletions) {
  const std::vector<Proposal> ranked = {{1, 9, 2.0},
                                        {0, 3, 1.0},
                                        {1, 3, 1.0},
                                        {-1, 3, 1.0},
                                        {0, 4, 1.0},
                                        {0, kNoCandidate, 1.0},
                                        {1, kNoCandidate, 1.0},
                                        {0, 3, 0.5}};
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    for (std::size_t j = 0; j < ranked.size(); ++j) {
      EXPECT_EQ(is_preferred(ranked[i], ranked[j]), i < j) << i << " " << j;
    }
  }
  EXPECT_TRUE(Proposal{}.is_nothing());
  EXPECT_FALSE((Proposal{0, kNoCandidate, 0.0}).is_nothing());
  EXPECT_FALSE((Proposal{-1, 0, 0.0}).is_nothing());
}

// ---- Additions ----

// The best addition of a robot may add nothing; of equal candidates it has the lowest id. Lazy
// evaluation with bounds has the same result with fewer calls.
TEST(BestAddition, IsTheFirstBestCandidateForAnySolution) {
  std::int64_t calls = 0;
  std::int64_t lazy_calls = 0;
  for (std::uint64_t seed = 0; seed < 2 * kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {5, 6, 3.0}, {});
    const TeamOracle oracle(problem);
    const std::vector<char> excluded =
        seed % 2 == 0 ? drawn_exclusion(oracle, seed) : std::vector<char>{};
    const int robot = static_cast<int>(seed % at(oracle.robot_count()));
    const Choice others = test::random_choice(oracle, seed);
    TeamSet team(oracle);
    TeamSet lazy_team(oracle);
    BestAddition all(oracle, robot, false);
    BestAddition lazy(oracle, robot, true);
    for (int mate = -1; mate < oracle.robot_count(); ++mate) {
      if (mate == robot || (mate >= 0 && others[at(mate)] == kNoCandidate)) {
        continue;
      }
      if (mate >= 0) {
        team.add(others[at(mate)]);
        lazy_team.add(others[at(mate)]);
      }
      Proposal best;
      for (CandidateId id = oracle.begin(robot); id < oracle.end(robot); ++id) {
        if (excluded.empty() || excluded[at(id)] == 0) {
          const double value = value_of(oracle, changed(oracle, team.choice(), -1, id));
          if (best.is_nothing() || value > best.value) {
            best = {-1, id, value};
          }
        }
      }
      for (const Proposal& found : {all.find(team, excluded), lazy.find(lazy_team, excluded)}) {
        EXPECT_EQ(found.add, best.add) << "seed " << seed;
        EXPECT_EQ(found.value, best.value);
        EXPECT_EQ(found.drop_robot, -1);
      }
    }
    calls += team.calls();
    lazy_calls += lazy_team.calls();
    EXPECT_LE(lazy_team.calls(), team.calls());
  }
  EXPECT_LT(static_cast<double>(lazy_calls), 0.7 * static_cast<double>(calls));
}

// ---- Proposals ----

struct Asked {
  Proposal proposal;
  std::int64_t calls = 0;
};

// Evaluates the additions, then the deletion and the swaps of the robot's own and of each
// teammate's trajectory.
Asked first_by_the_order(const TeamOracle& oracle, const ImprovementRule& rule, int robot,
                         const Choice& choice, const std::vector<char>& excluded,
                         const std::vector<CandidateId>& candidates) {
  const double here = value_of(oracle, choice);
  const CandidateId own = choice[at(robot)];
  Asked asked;
  const auto ask = [&](int dropped, CandidateId id) {
    const Proposal proposal{dropped, id, value_of(oracle, changed(oracle, choice, dropped, id))};
    ++asked.calls;
    if (rule.improves(here, proposal.value)) {
      asked.proposal = proposal;
    }
    return !asked.proposal.is_nothing();
  };
  const auto ask_all = [&](int dropped) {
    return std::any_of(candidates.begin(), candidates.end(), [&](CandidateId id) {
      return excluded[at(id)] == 0 && id != own && ask(dropped, id);
    });
  };
  if (own == kNoCandidate && ask_all(-1)) {
    return asked;
  }
  std::vector<int> order = {robot};
  for (int mate = 0; mate < oracle.robot_count(); ++mate) {
    if (mate != robot) {
      order.push_back(mate);
    }
  }
  for (const int dropped : order) {
    if (choice[at(dropped)] != kNoCandidate &&
        (ask(dropped, kNoCandidate) ||
         ((dropped == robot || own == kNoCandidate) && ask_all(dropped)))) {
      return asked;
    }
  }
  return asked;
}

std::optional<Proposal> finish(ProposalSearch& search) {
  for (;;) {
    const std::int64_t before = search.calls();
    const ProposalSearch::State state = search.advance();
    EXPECT_LE(search.calls(), before + 1);
    if (state != ProposalSearch::State::kSearching) {
      return state == ProposalSearch::State::kProposes ? std::optional(search.proposal())
                                                       : std::nullopt;
    }
  }
}

TEST(ProposalSearch, ProposesFirstImprovementInOrder) {
  int proposed = 0;
  int nothing = 0;
  for (const InformationMeasure measure : kMeasures) {
    for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
      SCOPED_TRACE(seed);
      const TeamProblem problem = test::random_instance(seed, {4, 5, 1.5}, measure);
      const TeamOracle oracle(problem);
      const ImprovementRule rule(oracle, 0.1);
      for (int robot = 0; robot < oracle.robot_count(); ++robot) {
        ProposalSearch search(oracle, rule, robot, false);
        std::vector<CandidateId> numbers;
        for (CandidateId id = oracle.begin(robot); id < oracle.end(robot); ++id) {
          numbers.push_back(id);
        }
        for (std::uint64_t again = 0; again < 3; ++again) {
          const Choice choice = test::random_choice(oracle, 10 * seed + again);
          const std::vector<char> excluded = drawn_exclusion(oracle, seed + again);
          const Asked first = first_by_the_order(oracle, rule, robot, choice, excluded, numbers);
          // A search from another choice is interrupted, as by a teammate's proposal.
          const std::vector<char> no_exclusion(excluded.size(), 0);
          const Choice other = test::random_choice(oracle, 10 * seed + again + 5);
          search.begin(other, value_of(oracle, other), no_exclusion);
          for (std::uint64_t k = 0; k < (seed + again) % 5; ++k) {
            if (search.advance() != ProposalSearch::State::kSearching) {
              break;
            }
          }
          const std::int64_t before = search.calls();
          search.begin(choice, value_of(oracle, choice), excluded);
          const auto found = finish(search);
          EXPECT_EQ(search.calls() - before, first.calls);
          ASSERT_EQ(found.has_value(), !first.proposal.is_nothing());
          if (found) {
            EXPECT_EQ(found->drop_robot, first.proposal.drop_robot);
            EXPECT_EQ(found->add, first.proposal.add);
            EXPECT_EQ(found->value, first.proposal.value);
          }
          (found ? proposed : nothing) += 1;
        }
      }
    }
  }
  EXPECT_GT(proposed, 500);
  EXPECT_GT(nothing, 100);
}

// The search evaluates candidates in descending order of stand-alone value. It stops when no other
// candidate can gain enough, so it misses no improvement.
TEST(ProposalSearch, StopsEarlyOnlyWithoutImprovement) {
  std::int64_t calls = 0;
  std::int64_t all_calls = 0;
  for (std::uint64_t seed = 0; seed < 2 * kInstances; ++seed) {
    SCOPED_TRACE(seed);
    const TeamProblem problem = test::random_instance(seed, {4, 6, 1.5}, {});
    const TeamOracle oracle(problem);
    const ImprovementRule rule(oracle, 0.1);
    const Choice choice = test::random_choice(oracle, seed);
    const std::vector<char> excluded = drawn_exclusion(oracle, seed);
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      const auto sorted = oracle.by_value(robot);
      const Asked first =
          first_by_the_order(oracle, rule, robot, choice, excluded, {sorted.begin(), sorted.end()});
      ProposalSearch search(oracle, rule, robot, true);
      search.begin(choice, value_of(oracle, choice), excluded);
      const auto found = finish(search);
      ASSERT_EQ(found.has_value(), !first.proposal.is_nothing());
      if (found) {
        EXPECT_EQ(found->drop_robot, first.proposal.drop_robot);
        EXPECT_EQ(found->add, first.proposal.add);
        EXPECT_EQ(found->value, first.proposal.value);
      }
      EXPECT_LE(search.calls(), first.calls);
      calls += search.calls();
      all_calls += first.calls;
    }
  }
  EXPECT_LT(static_cast<double>(calls), 0.8 * static_cast<double>(all_calls));
}

}  // namespace
}  // namespace vantage::planner
