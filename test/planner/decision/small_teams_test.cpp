#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/distributed_local_search.hpp"
#include "planner/decision/local_search.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/decision/team_bound.hpp"
#include "test/planner/decision/small_team.hpp"
#include "test/planner/decision/team_instance.hpp"

// Tests team searches on small problems for which calls, messages and changes are known in advance.
// Results for random problems are compared with plain implementations.

namespace vantage::planner {
namespace {

using test::at;
using test::changed;
using test::kMeasures;
using test::made_team;
using test::value_of;

constexpr std::uint64_t kInstances = 200;

// ---- Searches with known calls and messages ----

// One robot has a better and a worse trajectory. The central search evaluates the deletion and both
// swaps; then it evaluates the deletion of the worse trajectory and its swap with itself. In the
// distributed search, the robot first sends its candidate count and best value, and later that it
// proposes nothing. It evaluates deletion and swap, then the deletion only.
TEST(LocalSearch, CountsOracleCallsForOneRobot) {
  const TeamProblem problem = made_team(1, {{{0, 1.0}, {0, 2.0}}});
  const TeamOracle oracle(problem);
  const TeamDecision central = centralised_local_search(oracle, 1.0, Deadline::never());
  EXPECT_EQ(central.choice, (Choice{1}));
  EXPECT_EQ(central.optima, (std::vector<Choice>{{1}, {0}}));
  EXPECT_NEAR(central.value, 2.0, 1e-12);
  EXPECT_EQ(central.oracle_calls, 3 + 2);
  EXPECT_EQ(central.adopted, 0);
  EXPECT_EQ(central.messages, 0);
  for (const bool warm_start : {false, true}) {
    const TeamDecision decision =
        distributed_local_search(oracle, {1.0, false, warm_start}, Deadline::never());
    EXPECT_EQ(decision.optima, central.optima);
    EXPECT_EQ(decision.oracle_calls, 2 + 1);
    EXPECT_EQ(decision.messages, 2 + 2);
    EXPECT_EQ(decision.adopted, 0);
    EXPECT_TRUE(decision.finished);
  }
}

// Two robots with one trajectory each and separate targets. The better trajectory is the initial
// choice. The other one is added (one call, one message). Then both robots evaluate both deletions
// and report that they propose nothing. The second round has no candidates left.
TEST(LocalSearch, AddsTheSecondRobotWithOneCallAndOneMessage) {
  const TeamProblem problem = made_team(2, {{{0, 1.0}}, {{1, 2.0}}});
  const TeamOracle oracle(problem);
  const Choice both = {0, 1};
  const Choice nobody = {kNoCandidate, kNoCandidate};
  for (const bool lazy : {false, true}) {
    const TeamDecision warm =
        distributed_local_search(oracle, {1.0, lazy, true}, Deadline::never());
    EXPECT_EQ(warm.optima, (std::vector<Choice>{both, nobody}));
    EXPECT_EQ(warm.oracle_calls, 1 + 4);
    EXPECT_EQ(warm.messages, (2 + 1 + 2) + (2 + 2));
    EXPECT_EQ(warm.adopted, 1);
    EXPECT_NEAR(warm.value, 3.0, 1e-12);
    // Without the warm start, the other robot also evaluates its deletion.
    const TeamDecision cold =
        distributed_local_search(oracle, {1.0, lazy, false}, Deadline::never());
    EXPECT_EQ(cold.optima, warm.optima);
    EXPECT_EQ(cold.oracle_calls, 2 + 4);
    EXPECT_EQ(cold.messages, (2 + 1 + 2) + (2 + 2));
    EXPECT_EQ(cold.adopted, 1);
  }
  // The central search evaluates one deletion and the addition, then two deletions and the swap of
  // each candidate with itself.
  const TeamDecision central = centralised_local_search(oracle, 1.0, Deadline::never());
  EXPECT_EQ(central.optima, (std::vector<Choice>{both, nobody}));
  EXPECT_EQ(central.oracle_calls, (1 + 1) + (2 + 2));
  EXPECT_EQ(central.adopted, 1);
}

TEST(LocalSearch, BeginsWithTheFirstOfTheBestSingleCandidates) {
  const TeamProblem problem =
      made_team(3, {{{0, 1.0}, {0, 1.5}}, {{1, 2.0}, {1, 2.0}}, {{2, 2.0}}});
  const TeamOracle oracle(problem);
  const TeamDecision cut = centralised_local_search(oracle, 1.0, Deadline::nodes(0));
  EXPECT_FALSE(cut.finished);
  EXPECT_EQ(cut.optima, (std::vector<Choice>{{kNoCandidate, 2, kNoCandidate}}));
  EXPECT_EQ(cut.choice, cut.optima[0]);
  EXPECT_NEAR(cut.value, 2.0, 1e-12);
  EXPECT_EQ(cut.oracle_calls, 0);
  // The budget ends just after the first round, so only the beginning of the second is searched.
  std::int64_t budget = 0;
  TeamDecision second = cut;
  while (second.optima.size() == 1) {
    second = centralised_local_search(oracle, 1.0, Deadline::nodes(++budget));
  }
  EXPECT_FALSE(second.finished);
  EXPECT_GE(second.oracle_calls, budget);
  EXPECT_EQ(second.optima[0], (Choice{1, 2, 4}));
  EXPECT_EQ(second.optima[1], (Choice{kNoCandidate, 3, kNoCandidate}));
  EXPECT_EQ(second.choice, second.optima[0]) << "the better of both";
  EXPECT_NEAR(second.value, 5.5, 1e-12);
}

TEST(LocalSearch, FinishesWithABudgetOfOneCallMoreThanItNeeds) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 4, 1.0}, {});
    const TeamOracle oracle(problem);
    const auto expect_over = [&](const auto& search) {
      const TeamDecision whole = search(Deadline::never());
      const TeamDecision enough = search(Deadline::nodes(whole.oracle_calls + 1));
      EXPECT_TRUE(enough.finished) << "seed " << seed;
      EXPECT_EQ(enough.optima, whole.optima);
      EXPECT_EQ(enough.oracle_calls, whole.oracle_calls);
      EXPECT_EQ(enough.messages, whole.messages);
      EXPECT_EQ(enough.adopted, whole.adopted);
    };
    expect_over(
        [&](const Deadline& deadline) { return centralised_local_search(oracle, 1.0, deadline); });
    for (const bool warm_start : {false, true}) {
      expect_over([&](const Deadline& deadline) {
        return distributed_local_search(oracle, {1.0, true, warm_start}, deadline);
      });
    }
  }
}

// ---- Coordinate descent ----

// In each turn, all candidates of one robot are evaluated. The search ends after a round without a
// change.
TEST(CoordinateDescent, EndsAfterARoundWithoutChange) {
  for (const InformationMeasure measure : kMeasures) {
    for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
      const TeamProblem problem = test::random_instance(seed, {5, 5, 2.0}, measure);
      const TeamOracle oracle(problem);
      const TeamDecision whole = coordinate_descent(oracle, {{}, 100, false});
      const int robots = oracle.robot_count();
      ASSERT_EQ(whole.messages % robots, 0);
      const auto turns = static_cast<int>(whole.messages / robots);
      EXPECT_EQ(whole.oracle_calls, turns * oracle.candidate_count());
      EXPECT_TRUE(whole.finished);
      EXPECT_EQ(whole.value, value_of(oracle, whole.choice));
      std::int64_t adopted = -1;
      for (int rounds = 1; rounds <= turns; ++rounds) {
        const TeamDecision cut = coordinate_descent(oracle, {{}, rounds, false});
        EXPECT_EQ(cut.messages, rounds * robots);
        EXPECT_EQ(cut.adopted == adopted, rounds == turns && turns > 1) << "seed " << seed;
        adopted = cut.adopted;
      }
      EXPECT_EQ(adopted, whole.adopted);
      EXPECT_EQ(coordinate_descent(oracle, {{}, 0, false}).messages, 0);
    }
  }
}

TEST(CoordinateDescent, ChoosesFirstOfEqualCandidatesForGivenRobotsOnly) {
  const TeamProblem alike = made_team(2, {{{0, 1.0}}, {{1, 1.0}, {1, 1.5}, {1, 1.5}}});
  const TeamOracle oracle(alike);
  for (const bool lazy : {false, true}) {
    EXPECT_EQ(coordinate_descent(oracle, {{}, 1, lazy}).choice, (Choice{0, 2}));
    EXPECT_EQ(coordinate_descent(oracle, {{1}, 1, lazy}).choice, (Choice{kNoCandidate, 2}));
    EXPECT_EQ(coordinate_descent(oracle, {{1}, 5, lazy}).messages, 2);
  }
  EXPECT_THROW(coordinate_descent(oracle, {{2}, 1, true}), UsageError);
  EXPECT_THROW(coordinate_descent(oracle, {{-1}, 1, true}), UsageError);
  EXPECT_EQ(DescentOptions{}.rounds_max, 1);
  EXPECT_TRUE(DescentOptions{}.lazy);
  EXPECT_TRUE(DescentOptions{}.order.empty());
}

// In a second turn a robot changes its candidate only if the new one is better.
TEST(CoordinateDescent, EndsWhenNoSingleRobotCanImprove) {
  int kept = 0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 5, 1.0}, {});
    const TeamOracle oracle(problem);
    const TeamDecision decision = coordinate_descent(oracle, {{}, 100, seed % 2 == 0});
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      EXPECT_LE(value_of(oracle, changed(oracle, decision.choice, robot, kNoCandidate)),
                decision.value);
      for (CandidateId id = oracle.begin(robot); id < oracle.end(robot); ++id) {
        EXPECT_LE(value_of(oracle, changed(oracle, decision.choice, robot, id)),
                  decision.value + kGainRounding_nats)
            << "seed " << seed;
        ++kept;
      }
    }
  }
  EXPECT_GT(kept, 500);
}

// Each step adds the candidate with the largest gain among the robots without a candidate; of equal
// ones the first.
TEST(Greedy, AddsBestCandidateWhileTheValueIncreases) {
  for (const InformationMeasure measure : kMeasures) {
    std::int64_t calls = 0;
    std::int64_t calls_of_all = 0;
    for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
      const TeamProblem problem = test::random_instance(seed, {5, 4, 2.0}, measure);
      const TeamOracle oracle(problem);
      Choice choice(at(oracle.robot_count()), kNoCandidate);
      std::int64_t added = 0;
      for (;;) {
        const double here = value_of(oracle, choice);
        CandidateId best = kNoCandidate;
        double most = here;
        for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
          if (choice[at(oracle.robot_of(id))] == kNoCandidate) {
            ++calls_of_all;
            const double value = value_of(oracle, changed(oracle, choice, -1, id));
            if (value > most) {
              most = value;
              best = id;
            }
          }
        }
        if (best == kNoCandidate) {
          break;
        }
        choice = changed(oracle, choice, -1, best);
        ++added;
      }
      const TeamDecision decision = greedy(oracle);
      EXPECT_EQ(decision.choice, choice) << "seed " << seed;
      EXPECT_EQ(decision.value, value_of(oracle, choice));
      EXPECT_EQ(decision.adopted, added);
      calls += decision.oracle_calls;
    }
    if (measure == InformationMeasure::kMutual) {
      EXPECT_LT(static_cast<double>(calls), 0.8 * static_cast<double>(calls_of_all));
    } else {
      EXPECT_EQ(calls, calls_of_all);
    }
  }
}

// ---- Against attacks ----

// Bait robots use their best stand-alone candidates; the others plan together.
TEST(PlanResiliently, BaitRobotsUseTheirBestPlansAndEachRobotSendsTwoMessages) {
  // Robots 1 and 2 see one target, robots 0 and 3 another.
  const TeamProblem problem = made_team(
      3, {{{0, 1.0}, {1, 0.9}}, {{0, 0.5}, {0, 3.0}}, {{1, 2.0}, {1, 1.0}}, {{0, 1.0}, {2, 0.95}}});
  const TeamOracle oracle(problem);
  for (const SubSolver solver : {SubSolver::kExhaustive, SubSolver::kCoordinateDescent}) {
    const TeamDecision one = plan_resiliently(oracle, 1, solver);
    EXPECT_EQ(one.choice[1], 3) << "the bait";
    EXPECT_EQ(one.choice[2], 4);
    EXPECT_EQ(one.messages, 8);
    EXPECT_EQ(one.value, value_of(oracle, one.choice));
    const TeamDecision two = plan_resiliently(oracle, 2, solver);
    EXPECT_EQ(two.choice, (Choice{0, 3, 4, 7})) << "robots 0 and 3 share the information";
    const TeamDecision all = plan_resiliently(oracle, 4, solver);
    EXPECT_EQ(all.choice, (Choice{0, 3, 4, 6})) << "each robot plans for itself";
    EXPECT_EQ(all.oracle_calls, 0);
    EXPECT_EQ(all.messages, 8);
    EXPECT_THROW(plan_resiliently(oracle, -1, solver), UsageError);
  }
  const std::vector<double> alone = best_individual_values(oracle);
  ASSERT_EQ(alone.size(), 4U);
  for (const auto& [robot, nats] : {std::pair(0, 1.0), {1, 3.0}, {2, 2.0}, {3, 1.0}}) {
    EXPECT_NEAR(alone[at(robot)], nats, 1e-12);
  }
}

// ---- Bounds on the value ----

// For robots with separate targets the bound equals the optimum, from any choice. For two robots
// that see the same target it is I(S) plus the gains of both.
TEST(ValueBound, EqualsTheOptimumForIndependentRobots) {
  TeamProblem problem =
      made_team(3, {{{0, 1.0, 0.25}, {0, 2.0, 1.5}}, {{1, 1.0, 3.0}}, {{2, 0.5}}});
  problem.candidates[1][0].unshared_nats = 2.5;
  const TeamOracle oracle(problem);
  for (const Choice& choice : {Choice{kNoCandidate, kNoCandidate, kNoCandidate}, Choice{1, 2, 3},
                               Choice{0, kNoCandidate, 3}}) {
    // Robot 0: the first candidate adds 0.75; the second has less value.
    EXPECT_NEAR(value_bound(oracle, choice), 0.75 + 0.5 + 0.5, 1e-12);
  }
  const TeamProblem same = made_team(1, {{{0, 2.0}}, {{0, 2.0}}});
  const TeamOracle of_same(same);
  const double both = std::log(1.0 + 2.0 * std::expm1(2.0));
  const double all_three = std::log(1.0 + 3.0 * std::expm1(2.0));
  EXPECT_NEAR(value_bound(of_same, {kNoCandidate, kNoCandidate}), 2.0 + 2.0, 1e-12);
  // I(S) plus the gains of both candidates, including that of the robot with a choice.
  EXPECT_NEAR(value_bound(of_same, {0, kNoCandidate}), 2.0 + 2.0 * (both - 2.0), 1e-12);
  EXPECT_NEAR(value_bound(of_same, {0, 1}), both + 2.0 * (all_three - both), 1e-12);
}

}  // namespace
}  // namespace vantage::planner
