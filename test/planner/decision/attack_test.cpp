#include "planner/decision/attack.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/team_set.hpp"
#include "test/planner/decision/team_instance.hpp"

// Compares each attack with all sets of robots, and checks its number of oracle calls.

namespace vantage::planner {
namespace {

constexpr std::uint64_t kInstances = 200;

std::vector<int> robots_of(const Choice& choice) {
  std::vector<int> robots;
  for (int robot = 0; robot < std::ssize(choice); ++robot) {
    if (choice[index(robot)] != kNoCandidate) {
      robots.push_back(robot);
    }
  }
  return robots;
}

double left_by(const TeamOracle& oracle, Choice choice, const std::vector<int>& attacked) {
  for (const int robot : attacked) {
    choice[index(robot)] = kNoCandidate;
  }
  TeamSet team(oracle);
  team.become(choice);
  return team.value();
}

/// Returns all sets of at most `most` of `robots`, by ascending size and then in lexicographic
/// order.
std::vector<std::vector<int>> sets_of(const std::vector<int>& robots, int most) {
  std::vector<std::vector<int>> sets;
  for (std::uint32_t bits = 0; bits < 1U << robots.size(); ++bits) {
    if (std::popcount(bits) <= most) {
      sets.emplace_back();
      for (std::size_t i = 0; i < robots.size(); ++i) {
        if ((bits >> i & 1U) != 0) {
          sets.back().push_back(robots[i]);
        }
      }
    }
  }
  std::ranges::sort(sets, {}, [](const auto& set) { return std::pair(set.size(), set); });
  return sets;
}

/// Calls look() twice for each random team: unchanged, and with equal candidates, so that ties are
/// frequent.
template <class Look>
void for_each_team(const Look& look) {
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    for (const bool are_alike : {false, true}) {
      for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
        TeamProblem problem = test::random_instance(seed, {5, 3, 0.0}, measure);
        if (are_alike) {
          for (auto& candidates : problem.candidates) {
            candidates.resize(1);
            candidates[0] = problem.candidates[0][0];
          }
        }
        SCOPED_TRACE(seed);
        const TeamOracle oracle(problem);
        look(oracle, test::random_choice(oracle, seed));
      }
    }
  }
}

TEST(WorstAttack, ReturnsTheFirstMinimumOverAllSets) {
  for_each_team([](const TeamOracle& oracle, const Choice& choice) {
    for (int attacks = -1; attacks <= oracle.robot_count() + 1; ++attacks) {
      const auto sets = sets_of(robots_of(choice), std::max(0, attacks));
      const std::vector<int>* first = nullptr;
      double least = 0.0;
      for (const std::vector<int>& set : sets) {
        const double left = left_by(oracle, choice, set);
        if (first == nullptr || left < least) {
          first = &set;
          least = left;
        }
      }
      const Attack worst = worst_attack(oracle, choice, attacks);
      EXPECT_EQ(worst.robots, *first);
      EXPECT_EQ(worst.value, least);
      EXPECT_EQ(worst.oracle_calls, std::ssize(sets) - 1) << "all sets except the empty one";
    }
  });
}

TEST(GreedyAttack, RemovesRobotThatMinimisesRemainingValue) {
  int stopped = 0;
  for_each_team([&](const TeamOracle& oracle, const Choice& choice) {
    for (int attacks = 0; attacks <= oracle.robot_count() + 1; ++attacks) {
      std::vector<int> taken;
      std::int64_t calls = 0;
      for (int k = 0; k < attacks; ++k) {
        int hardest = -1;
        double least = left_by(oracle, choice, taken);
        for (const int robot : robots_of(choice)) {
          if (std::ranges::count(taken, robot) > 0) {
            continue;
          }
          ++calls;
          std::vector<int> with = taken;
          with.push_back(robot);
          if (left_by(oracle, choice, with) < least) {
            least = left_by(oracle, choice, with);
            hardest = robot;
          }
        }
        if (hardest < 0) {
          ++stopped;
          break;
        }
        taken.push_back(hardest);
      }
      const Attack attack = attack_by(Attacker::kGreedy, oracle, choice, attacks);
      const double left = left_by(oracle, choice, taken);
      std::ranges::sort(taken);
      EXPECT_EQ(attack.robots, taken);
      EXPECT_EQ(attack.value, left);
      EXPECT_EQ(attack.oracle_calls, calls);
    }
  });
  EXPECT_GT(stopped, 100);
}

TEST(AttackOnBestAlone, PrefersLowerIndexAndAttacksNoneForZeroAttacks) {
  for_each_team([](const TeamOracle& oracle, const Choice& choice) {
    std::vector<int> ranked = robots_of(choice);
    std::ranges::sort(ranked, {}, [&](int robot) {
      return std::pair(-oracle.individual_value(choice[index(robot)]), robot);
    });
    for (int attacks = -2; attacks <= oracle.robot_count() + 1; ++attacks) {
      std::vector<int> taken = ranked;
      taken.resize(std::min(taken.size(), index(std::max(0, attacks))));
      std::ranges::sort(taken);
      const Attack attack = attack_by(Attacker::kBestAlone, oracle, choice, attacks);
      EXPECT_EQ(attack.robots, taken);
      EXPECT_EQ(attack.value, left_by(oracle, choice, taken));
      EXPECT_EQ(attack.oracle_calls, std::ssize(taken));
    }
  });
}

// Each round takes the first of the equally good best robots, even if it adds nothing, and
// evaluates all remaining robots.
TEST(AttackOnBestTogether, PrefersLowerIndexAndCountsOracleCalls) {
  for_each_team([](const TeamOracle& oracle, const Choice& choice) {
    const std::vector<int> robots = robots_of(choice);
    std::vector<int> taken;
    std::int64_t calls = 0;
    for (int attacks = 0; attacks <= std::ssize(robots) + 1; ++attacks) {
      const Attack attack = attack_by(Attacker::kBestTogether, oracle, choice, attacks);
      std::vector<int> sorted = taken;
      std::ranges::sort(sorted);
      EXPECT_EQ(attack.robots, sorted);
      EXPECT_EQ(attack.value, left_by(oracle, choice, taken));
      EXPECT_EQ(attack.oracle_calls, calls);
      int best = -1;
      double most = 0.0;
      for (const int robot : robots) {
        if (std::ranges::count(taken, robot) > 0) {
          continue;
        }
        ++calls;
        Choice with(choice.size(), kNoCandidate);
        for (const int each : taken) {
          with[index(each)] = choice[index(each)];
        }
        with[index(robot)] = choice[index(robot)];
        const double value = left_by(oracle, with, {});
        if (best < 0 || value > most) {
          best = robot;
          most = value;
        }
      }
      if (best >= 0) {
        taken.push_back(best);
      }
    }
  });
}

TEST(RandomAttack, DrawsNothingForZeroAttacks) {
  std::mt19937_64 rng(3);
  std::mt19937_64 untouched(3);
  EXPECT_TRUE(random_attack(4, 0, rng).empty());
  EXPECT_TRUE(random_attack(0, 0, rng).empty());
  EXPECT_EQ(rng(), untouched());
}

// ---- The exhaustive optima, with which the searches are compared ----

TEST(ExhaustiveOptimum, ReturnsTheFirstBestChoice) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 3, 2.0}, {});
    const TeamOracle oracle(problem);
    std::vector<int> robots;
    std::int64_t choices = 1;
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      if ((seed >> robot & 1U) != 0) {
        robots.push_back(robot);
        choices *= oracle.end(robot) - oracle.begin(robot) + 1;
      }
    }
    const TeamDecision decision = exhaustive_optimum(oracle, robots);
    EXPECT_EQ(decision.oracle_calls, choices);
    ASSERT_EQ(std::ssize(decision.choice), oracle.robot_count());
    EXPECT_EQ(decision.value, left_by(oracle, decision.choice, {}));
    bool is_met = false;
    for (std::int64_t code = 0; code < choices; ++code) {
      Choice choice(decision.choice.size(), kNoCandidate);
      std::int64_t rest = code;
      for (auto robot = robots.rbegin(); robot != robots.rend(); ++robot) {
        const int count = oracle.end(*robot) - oracle.begin(*robot) + 1;
        const auto drawn = static_cast<CandidateId>(rest % count);
        choice[index(*robot)] = drawn == 0 ? kNoCandidate : oracle.begin(*robot) + drawn - 1;
        rest /= count;
      }
      const double value = left_by(oracle, choice, {});
      EXPECT_LE(value, decision.value);
      if (value == decision.value && !is_met) {
        EXPECT_EQ(choice, decision.choice) << "the first of equal robots, seed " << seed;
        is_met = true;
      }
    }
    EXPECT_TRUE(is_met);
  }
}

TEST(ExhaustiveOptimum, RefusesUnknownRobots) {
  const TeamProblem problem = test::random_instance(3, {3, 3, 0.0}, {});
  const TeamOracle oracle(problem);
  EXPECT_NO_THROW(exhaustive_optimum(oracle, {oracle.robot_count() - 1}));
  EXPECT_THROW(exhaustive_optimum(oracle, {oracle.robot_count()}), UsageError);
  EXPECT_THROW(exhaustive_optimum(oracle, {-1}), UsageError);
}

TEST(ExhaustiveMaxMin, MaximisesValueAfterWorstAttack) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {3, 3, 0.0}, {});
    const TeamOracle oracle(problem);
    for (int attacks = 0; attacks <= 2; ++attacks) {
      const TeamDecision decision = exhaustive_max_min(oracle, attacks);
      std::int64_t choices = 1;
      std::vector<int> able;
      for (int robot = 0; robot < oracle.robot_count(); ++robot) {
        const int count = oracle.end(robot) - oracle.begin(robot);
        choices *= std::max(1, count);
        if (count > 0) {
          able.push_back(robot);
        }
      }
      EXPECT_EQ(decision.oracle_calls, choices * (std::ssize(sets_of(able, attacks)) - 1));
      EXPECT_EQ(robots_of(decision.choice), able);
      double most = -1.0;
      for (std::int64_t code = 0; code < choices; ++code) {
        Choice choice(decision.choice.size(), kNoCandidate);
        std::int64_t rest = code;
        for (const int robot : able) {
          const int count = oracle.end(robot) - oracle.begin(robot);
          choice[index(robot)] = oracle.begin(robot) + static_cast<CandidateId>(rest % count);
          rest /= count;
        }
        double least = left_by(oracle, choice, {});
        for (const std::vector<int>& set : sets_of(able, attacks)) {
          least = std::min(least, left_by(oracle, choice, set));
        }
        most = std::max(most, least);
      }
      EXPECT_EQ(decision.value, most) << "seed " << seed << " attacks " << attacks;
      EXPECT_EQ(decision.value, worst_attack(oracle, decision.choice, attacks).value);
    }
  }
}

}  // namespace
}  // namespace vantage::planner
