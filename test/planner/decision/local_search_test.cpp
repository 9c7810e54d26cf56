#include "planner/decision/local_search.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/distributed_local_search.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/team_bound.hpp"
#include "planner/decision/team_set.hpp"
#include "test/planner/decision/team_instance.hpp"

namespace vantage::planner {
namespace {

constexpr std::uint64_t kInstances = 600;
constexpr double kRounding = 1e-9;

std::vector<int> all_robots(const TeamOracle& oracle) {
  std::vector<int> robots(static_cast<std::size_t>(oracle.robot_count()));
  std::iota(robots.begin(), robots.end(), 0);
  return robots;
}

std::vector<DistributedOptions> all_variants(double alpha) {
  return {{alpha, false, false}, {alpha, true, false}, {alpha, false, true}, {alpha, true, true}};
}

// True if no deletion, addition or swap with the candidates that are not excluded improves on
// `choice`. Each value is computed from scratch.
bool is_local_optimum(const TeamOracle& oracle, const Choice& choice,
                      const std::vector<char>& excluded, const ImprovementRule& rule) {
  const auto value_of = [&](const Choice& of) {
    TeamSet fresh(oracle);
    fresh.become(of);
    return fresh.value();
  };
  const double here = value_of(choice);
  for (int dropped = -1; dropped < oracle.robot_count(); ++dropped) {
    Choice less = choice;
    if (dropped >= 0) {
      less[static_cast<std::size_t>(dropped)] = kNoCandidate;
    }
    if (rule.improves(here, value_of(less))) {
      return false;
    }
    for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
      Choice other = less;
      CandidateId& slot = other[static_cast<std::size_t>(oracle.robot_of(id))];
      if (slot != kNoCandidate || excluded[static_cast<std::size_t>(id)] != 0) {
        continue;
      }
      slot = id;
      if (rule.improves(here, value_of(other))) {
        return false;
      }
    }
  }
  return true;
}

void expect_local_optima(const TeamOracle& oracle, const TeamDecision& decision, double alpha) {
  const ImprovementRule rule(oracle, alpha);
  std::vector<char> excluded(static_cast<std::size_t>(oracle.candidate_count()), 0);
  ASSERT_EQ(decision.optima.size(), 2U);
  for (const Choice& choice : decision.optima) {
    EXPECT_TRUE(is_local_optimum(oracle, choice, excluded, rule));
    for (const CandidateId id : choice) {
      if (id != kNoCandidate) {
        EXPECT_EQ(excluded[static_cast<std::size_t>(id)], 0);
        excluded[static_cast<std::size_t>(id)] = 1;
      }
    }
  }
}

TEST(CoordinateDescent, IsAtLeastHalfOfTheOptimum) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 4, 0.0}, {});
    const TeamOracle oracle(problem);
    const double best = exhaustive_optimum(oracle, all_robots(oracle)).value;
    std::vector<int> order = all_robots(oracle);
    for (int way = 0; way < 2; ++way) {
      const TeamDecision decision = coordinate_descent(oracle, {order, 1, true});
      EXPECT_EQ(decision.adopted, std::count_if(decision.choice.begin(), decision.choice.end(),
                                                [](CandidateId id) { return id != kNoCandidate; }))
          << "one choice per robot, from an empty solution";
      EXPECT_GE(decision.value, 0.5 * best - kRounding) << "seed " << seed;
      EXPECT_LE(decision.value, best + kRounding);
      std::reverse(order.begin(), order.end());
    }
    EXPECT_GE(greedy(oracle).value, 0.5 * best - kRounding);
  }
}

TEST(CoordinateDescent, LazyEvaluationDoesNotChangeTheChoices) {
  std::int64_t lazy_calls = 0;
  std::int64_t calls = 0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {5, 6, 1.0}, {});
    const TeamOracle oracle(problem);
    const TeamDecision lazy = coordinate_descent(oracle, {{}, 3, true});
    const TeamDecision full = coordinate_descent(oracle, {{}, 3, false});
    EXPECT_EQ(lazy.choice, full.choice);
    lazy_calls += lazy.oracle_calls;
    calls += full.oracle_calls;
  }
  EXPECT_LT(lazy_calls, calls);
}

TEST(CoordinateDescent, NeverDecreasesTheValueInAnyPass) {
  int improved = 0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {5, 5, 2.0}, {});
    const TeamOracle oracle(problem);
    double last = 0.0;
    for (int rounds = 1; rounds <= 4; ++rounds) {
      const double value = coordinate_descent(oracle, {{}, rounds, true}).value;
      EXPECT_GE(value, last);
      improved += rounds > 1 && value > last ? 1 : 0;
      last = value;
    }
  }
  EXPECT_GT(improved, 0);
}

TEST(CoordinateDescent, ImprovesMonotonicallyWithTime) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {5, 5, 2.0}, {});
    const TeamOracle oracle(problem);
    const TeamDecision whole = coordinate_descent(oracle, {{}, 9, true});
    double last = 0.0;
    for (std::int64_t budget = 0; budget <= whole.oracle_calls; ++budget) {
      const TeamDecision cut = coordinate_descent(oracle, {{}, 9, true}, Deadline::nodes(budget));
      EXPECT_LE(cut.oracle_calls, budget);
      EXPECT_FALSE(cut.finished);
      EXPECT_GE(cut.value, last);
      last = cut.value;
    }
    const TeamDecision all =
        coordinate_descent(oracle, {{}, 9, true}, Deadline::nodes(whole.oracle_calls + 1));
    EXPECT_TRUE(all.finished);
    EXPECT_EQ(all.choice, whole.choice);
  }
}

TEST(ValueBound, IsAnUpperBoundFromAnyChoice) {
  double gap = 0.0;
  double gap_alone = 0.0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 4, 2.0}, {});
    const TeamOracle oracle(problem);
    const double best = exhaustive_optimum(oracle, all_robots(oracle)).value;
    const TeamDecision decision = coordinate_descent(oracle, {{}, 9, true});
    const Choice nothing(decision.choice.size(), kNoCandidate);
    for (const Choice& choice : {decision.choice, nothing, test::random_choice(oracle, seed)}) {
      EXPECT_GE(value_bound(oracle, choice), best - kRounding) << "seed " << seed;
    }
    gap += value_bound(oracle, decision.choice) - best;
    gap_alone += value_bound(oracle, nothing) - best;
    if (oracle.robot_count() == 1) {
      EXPECT_NEAR(value_bound(oracle, nothing), best, kRounding);
    }
  }
  EXPECT_LT(gap, 0.9 * gap_alone) << "a choice with information makes the bound tighter";
}

TEST(ValueBound, RefusesInformationThatIsNotSubmodular) {
  const TeamProblem problem = test::random_instance(1, {3, 3, 0.0}, InformationMeasure::kLogDet);
  const TeamOracle oracle(problem);
  const Choice nothing(static_cast<std::size_t>(oracle.robot_count()), kNoCandidate);
  EXPECT_THROW(value_bound(oracle, nothing), UsageError);
}

TEST(LocalSearch, MeetsItsGuaranteeForInformationMinusCosts) {
  for (const double alpha : {0.1, 1.0}) {
    for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
      const TeamProblem problem = test::random_instance(seed, {4, 4, 2.0}, {});
      const TeamOracle oracle(problem);
      const double best = exhaustive_optimum(oracle, all_robots(oracle)).value + oracle.offset();
      const TeamDecision central = centralised_local_search(oracle, alpha, Deadline::never());
      EXPECT_GE(central.value + oracle.offset(), best / (4.0 * (1.0 + alpha)) - kRounding);
      EXPECT_LE(central.value + oracle.offset(), best + kRounding);
      for (const DistributedOptions& variant : all_variants(alpha)) {
        const TeamDecision decision = distributed_local_search(oracle, variant, Deadline::never());
        EXPECT_GE(decision.value + oracle.offset(), best / (4.0 * (1.0 + alpha)) - kRounding)
            << "seed " << seed;
        EXPECT_LE(decision.value + oracle.offset(), best + kRounding);
      }
    }
  }
}

TEST(LocalSearch, EndsAtALocalOptimum) {
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
      const TeamProblem problem = test::random_instance(seed, {5, 5, 2.0}, measure);
      const TeamOracle oracle(problem);
      expect_local_optima(oracle, centralised_local_search(oracle, 1.0, Deadline::never()), 1.0);
      for (const DistributedOptions& variant : all_variants(1.0)) {
        const TeamDecision decision = distributed_local_search(oracle, variant, Deadline::never());
        EXPECT_TRUE(decision.finished);
        expect_local_optima(oracle, decision, 1.0);
      }
    }
  }
}

// 10 robots have 1250 candidates with nearly equal values. 1 + α/N⁴ rounds to 1, so a search that
// accepts equal values would not end.
TEST(LocalSearch, EndsWhenAlphaOverN4IsBelowRounding) {
  TeamProblem problem = test::random_instance(3, {1, 1, 0.0}, {});
  problem.horizon_steps = 3;
  problem.candidates.assign(10, {});
  std::mt19937_64 rng(5);
  std::vector<Candidate> kinds(7);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    for (std::uint16_t t = 1; t <= 3; ++t) {
      kinds[k].measurements.push_back(
          {0, t, {{1.0 + static_cast<double>(k % 3), 0.1, 2.0, 0.0, 0.0, 1.0}}});
    }
    kinds[k].energy_cost = 0.1 * static_cast<double>(k);
  }
  for (auto& of_robot : problem.candidates) {
    for (int i = 0; i < 1250; ++i) {
      of_robot.push_back(kinds[rng() % kinds.size()]);
    }
  }
  const TeamOracle oracle(problem);
  ASSERT_EQ(oracle.candidate_count(), 12'500);
  ASSERT_EQ(1.0 + 1.0 / std::pow(12'500.0, 4), 1.0);
  for (const DistributedOptions& variant : all_variants(1.0)) {
    const TeamDecision decision =
        distributed_local_search(oracle, variant, Deadline::nodes(20'000'000));
    EXPECT_TRUE(decision.finished);
    EXPECT_LT(decision.adopted, 1'000);
  }
  EXPECT_TRUE(centralised_local_search(oracle, 1.0, Deadline::nodes(20'000'000)).finished);
}

TEST(LocalSearch, RejectsChangesOfEqualValue) {
  const TeamProblem problem = test::random_instance(3, {3, 3, 1.0}, {});
  const TeamOracle oracle(problem);
  const ImprovementRule rule(oracle, 1e-30);
  EXPECT_FALSE(rule.improves(1.0, 1.0));
  EXPECT_TRUE(rule.improves(1.0, std::nextafter(1.0, 2.0)));
  EXPECT_FALSE(rule.improves(1.0, std::nextafter(1.0, 0.0)));
}

TEST(DistributedLocalSearch, StopsAtItsDeadlineWithASolution) {
  const TeamProblem problem = test::random_instance(12, {6, 8, 1.0}, {});
  const TeamOracle oracle(problem);
  for (std::int64_t calls = 1; calls < 60; calls += 7) {
    const TeamDecision decision = distributed_local_search(oracle, {}, Deadline::nodes(calls));
    EXPECT_EQ(decision.choice.size(), problem.candidates.size());
    EXPECT_LE(decision.oracle_calls, calls + oracle.candidate_count());
    EXPECT_GT(decision.value, 0.0);
  }
}

TEST(ProposalOrder, IsStrict) {
  const std::vector<Proposal> proposals = {
      {-1, 3, 1.0},           {-1, 4, 1.0},           {0, 3, 1.0}, {1, 3, 1.0},
      {0, kNoCandidate, 1.0}, {1, kNoCandidate, 1.0}, {-1, 3, 2.0}};
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    for (std::size_t j = 0; j < proposals.size(); ++j) {
      EXPECT_EQ(
          is_preferred(proposals[i], proposals[j]) || is_preferred(proposals[j], proposals[i]),
          i != j);
      EXPECT_FALSE(is_preferred(proposals[i], proposals[j]) &&
                   is_preferred(proposals[j], proposals[i]));
    }
  }
  EXPECT_TRUE(is_preferred(proposals.back(), proposals.front()));
}

}  // namespace
}  // namespace vantage::planner
