#include "planner/decision/resilient.hpp"

#include <bit>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/decision/attack.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/team_set.hpp"
#include "test/planner/decision/team_instance.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

constexpr std::uint64_t kInstances = 600;
constexpr double kRounding = 1e-9;

double value_of(const TeamOracle& oracle, const Choice& choice) {
  TeamSet team(oracle);
  team.become(choice);
  return team.value();
}

// Returns the curvature κ of J over the trajectories of `choice`. It is at most the curvature over
// all candidates.
double curvature(const TeamOracle& oracle, const Choice& choice) {
  TeamSet team(oracle);
  team.become(choice);
  double least = 1.0;
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    const CandidateId id = choice[static_cast<std::size_t>(robot)];
    if (id != kNoCandidate && oracle.individual_value(id) > kRounding) {
      least =
          std::min(least, (team.value() - team.value_without(robot)) / oracle.individual_value(id));
    }
  }
  return 1.0 - least;
}

// Returns the total curvature c over the ground set, including sets with several candidates of one
// robot.
double total_curvature(const TeamProblem& problem, const TeamOracle& oracle) {
  const auto n = static_cast<unsigned>(oracle.candidate_count());
  std::vector<double> values(std::size_t{1} << n);
  for (std::size_t set = 0; set < values.size(); ++set) {
    std::vector<const Candidate*> chosen;
    for (unsigned v = 0; v < n; ++v) {
      if ((set >> v & 1U) != 0) {
        chosen.push_back(&oracle.candidate(static_cast<CandidateId>(v)));
      }
    }
    values[set] = test::plain_value(problem, chosen);
  }
  double least = 1.0;
  for (unsigned v = 0; v < n; ++v) {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = 0.0;
    for (std::size_t set = 0; set < values.size(); ++set) {
      if ((set >> v & 1U) == 0) {
        const double gain = values[set | std::size_t{1} << v] - values[set];
        lowest = std::min(lowest, gain);
        highest = std::max(highest, gain);
      }
    }
    least = highest > kRounding ? std::min(least, lowest / highest) : least;
  }
  return 1.0 - least;
}

TEST(PlanResiliently, KeepsTheBoundsOfTheTheoremForMutualInformation) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 3, 0.0}, {});
    const TeamOracle oracle(problem);
    for (int attacks = 0; attacks <= oracle.robot_count(); ++attacks) {
      const double best = exhaustive_max_min(oracle, attacks).value;
      const auto bound_of = [&](const TeamDecision& plan) {
        return std::max(1.0 - curvature(oracle, plan.choice), 1.0 / (1.0 + attacks)) * best;
      };
      const TeamDecision exact = plan_resiliently(oracle, attacks, SubSolver::kExhaustive);
      const double left = worst_attack(oracle, exact.choice, attacks).value;
      EXPECT_GE(left, bound_of(exact) - kRounding) << "seed " << seed << " attacks " << attacks;
      EXPECT_LE(left, best + kRounding);
      if (attacks == 0) {
        EXPECT_NEAR(left, best, kRounding);
      }
      const TeamDecision descent = plan_resiliently(oracle, attacks, SubSolver::kCoordinateDescent);
      EXPECT_GE(worst_attack(oracle, descent.choice, attacks).value,
                0.5 * bound_of(descent) - kRounding);
    }
  }
}

TEST(PlanResiliently, KeepsTheBoundOfTotalCurvatureForLogDet) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const TeamProblem problem =
        test::random_instance(seed, {4, 3, 0.0, 7}, InformationMeasure::kLogDet);
    const TeamOracle oracle(problem);
    const double kept = 1.0 - total_curvature(problem, oracle);
    for (int attacks = 0; attacks <= oracle.robot_count(); ++attacks) {
      const TeamDecision exact = plan_resiliently(oracle, attacks, SubSolver::kExhaustive);
      EXPECT_GE(worst_attack(oracle, exact.choice, attacks).value,
                kept * kept * exhaustive_max_min(oracle, attacks).value - kRounding)
          << "seed " << seed << " attacks " << attacks;
    }
  }
}

TEST(PlanResiliently, IsBetterUnderAttackThanPlanningWithoutBait) {
  double resilient = 0.0;
  double plain = 0.0;
  test::for_each_instance(kInstances, {4, 4, 0.0}, {},
                          [&](std::uint64_t, const TeamProblem&, const TeamOracle& oracle) {
                            const auto left_by = [&](int planned_for) {
                              const auto plan =
                                  plan_resiliently(oracle, planned_for, SubSolver::kExhaustive);
                              return worst_attack(oracle, plan.choice, 2).value;
                            };
                            resilient += left_by(2);
                            plain += left_by(0);
                          });
  EXPECT_GT(resilient, plain);
}

TEST(AttackOnBestAlone, AttacksRobotsWithHighestStandAloneValue) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 4, 0.0}, {});
    const TeamOracle oracle(problem);
    const Choice choice = test::random_choice(oracle, seed);
    for (int attacks = 0; attacks <= oracle.robot_count(); ++attacks) {
      const Attack attack = attack_on_best_alone(oracle, choice, attacks);
      Choice left = choice;
      double least_taken = std::numeric_limits<double>::infinity();
      for (const int robot : attack.robots) {
        CandidateId& taken = left[static_cast<std::size_t>(robot)];
        ASSERT_NE(taken, kNoCandidate);
        least_taken = std::min(least_taken, oracle.individual_value(taken));
        taken = kNoCandidate;
      }
      const auto chosen_left = test::chosen_of(oracle, left);
      EXPECT_EQ(std::ssize(attack.robots),
                std::min(std::ssize(test::chosen_of(oracle, choice)), std::ptrdiff_t{attacks}));
      for (const CandidateId id : left) {
        EXPECT_TRUE(id == kNoCandidate || oracle.individual_value(id) <= least_taken);
      }
      EXPECT_NEAR(attack.value, test::plain_value(problem, chosen_left), 1e-9);
      EXPECT_EQ(attack.oracle_calls, std::ssize(attack.robots));
    }
  }
}

// Bait robots keep their best stand-alone candidates, so attack_on_best_alone() attacks these
// robots.
TEST(AttackOnBestAlone, AttacksTheBait) {
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {4, 4, 0.0}, {});
    const TeamOracle oracle(problem);
    const TeamDecision plan = plan_resiliently(oracle, 2, SubSolver::kExhaustive);
    std::vector<double> best_alone;
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      const auto candidates = oracle.by_value(robot);
      best_alone.push_back(candidates.empty() ? 0.0 : oracle.individual_value(candidates.front()));
    }
    std::ranges::sort(best_alone, std::ranges::greater{});
    std::vector<double> taken;
    for (const int robot : attack_on_best_alone(oracle, plan.choice, 2).robots) {
      taken.push_back(oracle.individual_value(plan.choice[static_cast<std::size_t>(robot)]));
    }
    std::ranges::sort(taken, std::ranges::greater{});
    for (std::size_t k = 0; k < taken.size(); ++k) {
      EXPECT_EQ(taken[k], best_alone[k]) << "seed " << seed;
    }
  }
}

TEST(AttackOnBestTogether, AttacksMostValuableRobotForOneAttack) {
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
      const TeamProblem problem = test::random_instance(seed, {5, 3, 0.0}, measure);
      const TeamOracle oracle(problem);
      const Choice choice = test::random_choice(oracle, seed);
      double most = 0.0;
      for (const Candidate* candidate : test::chosen_of(oracle, choice)) {
        most = std::max(most, test::plain_value(problem, {candidate}));
      }
      const Attack attack = attack_on_best_together(oracle, choice, 1);
      ASSERT_EQ(attack.robots.empty(), test::chosen_of(oracle, choice).empty());
      if (!attack.robots.empty()) {
        const auto taken = static_cast<std::size_t>(attack.robots[0]);
        EXPECT_NEAR(test::plain_value(problem, {&oracle.candidate(choice[taken])}), most, 1e-9);
        EXPECT_EQ(oracle.individual_value(choice[taken]),
                  oracle.individual_value(choice[static_cast<std::size_t>(
                      attack_on_best_alone(oracle, choice, 1).robots[0])]));
      }
    }
  }
}

// Each further attack adds the robot that maximises J of the attacked robots. J is computed by the
// direct recursion.
TEST(AttackOnBestTogether, AddsRobotThatMaximisesJointValue) {
  int unlike_alone = 0;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    const TeamProblem problem =
        test::random_instance(seed, {5, 3, 0.0}, InformationMeasure::kLogDet);
    const TeamOracle oracle(problem);
    const Choice choice = test::random_choice(oracle, seed);
    const auto value_of_robots = [&](const std::vector<int>& robots) {
      std::vector<const Candidate*> chosen;
      for (const int robot : robots) {
        chosen.push_back(&oracle.candidate(choice[static_cast<std::size_t>(robot)]));
      }
      return test::plain_value(problem, chosen);
    };
    std::vector<int> before;
    for (int attacks = 1; attacks <= oracle.robot_count(); ++attacks) {
      const Attack attack = attack_on_best_together(oracle, choice, attacks);
      ASSERT_TRUE(std::ranges::includes(attack.robots, before));
      if (attack.robots.size() == before.size()) {
        ASSERT_EQ(before.size(), test::chosen_of(oracle, choice).size()) << "no robot is left";
        break;
      }
      ASSERT_EQ(attack.robots.size(), before.size() + 1);
      Choice left = choice;
      for (const int robot : attack.robots) {
        left[static_cast<std::size_t>(robot)] = kNoCandidate;
      }
      EXPECT_NEAR(attack.value, test::plain_value(problem, test::chosen_of(oracle, left)), 1e-9);
      for (int robot = 0; robot < oracle.robot_count(); ++robot) {
        const bool is_taken = std::ranges::binary_search(before, robot);
        if (choice[static_cast<std::size_t>(robot)] != kNoCandidate && !is_taken) {
          std::vector<int> with = before;
          with.push_back(robot);
          EXPECT_LE(value_of_robots(with), value_of_robots(attack.robots) + 1e-9);
        }
      }
      before = attack.robots;
      unlike_alone += before == attack_on_best_alone(oracle, choice, attacks).robots ? 0 : 1;
    }
    EXPECT_EQ(attack_by(Attacker::kBestTogether, oracle, choice, 2).robots,
              attack_on_best_together(oracle, choice, 2).robots);
  }
  EXPECT_GT(unlike_alone, 10);
}

TEST(PlanResiliently, EvaluatesCandidatesInTheOrderOfTheAlgorithm) {
  using Call = std::pair<int, std::vector<int>>;
  const std::vector<double> values = {2.0, 5.0, 3.0, 4.0};
  std::vector<Call> calls;
  const auto plan = [&](int robot, const std::vector<int>& beside) {
    calls.emplace_back(robot, beside);
    return values[static_cast<std::size_t>(robot)];
  };
  EXPECT_EQ(plan_resiliently(4, 1, plan), (std::vector<int>{1}));
  EXPECT_EQ(calls, (std::vector<Call>{{0, {}}, {1, {}}, {2, {}}, {3, {}}, {2, {0}}, {3, {0, 2}}}));
  calls.clear();
  EXPECT_TRUE(plan_resiliently(3, 0, plan).empty());
  EXPECT_EQ(calls, (std::vector<Call>{{0, {}}, {1, {0}}, {2, {0, 1}}}));
  calls.clear();
  EXPECT_EQ(plan_resiliently(2, 5, plan), (std::vector<int>{0, 1}));
  EXPECT_EQ(calls.size(), 2U);
}

TEST(PlanResiliently, PlansBaitAloneThenTheRestTogether) {
  const std::vector<double> values = {2.0, 5.0, 3.0, 4.0};
  std::vector<int> alone;
  std::vector<std::vector<int>> together;
  const auto plan = [&](int attacks_max) {
    alone.clear();
    together.clear();
    return plan_resiliently(
        4, attacks_max,
        [&](int robot) {
          alone.push_back(robot);
          return values[static_cast<std::size_t>(robot)];
        },
        [&](const std::vector<int>& robots) { together.push_back(robots); });
  };
  using Robots = std::vector<int>;
  EXPECT_EQ(plan(2), (Robots{1, 3}));
  EXPECT_EQ(alone, (Robots{0, 1, 2, 3}));
  EXPECT_EQ(together, (std::vector<Robots>{{0, 2}}));
  EXPECT_EQ(plan(0), Robots());
  EXPECT_EQ(alone, Robots());
  EXPECT_EQ(together, (std::vector<Robots>{{0, 1, 2, 3}}));
  EXPECT_EQ(plan(4), (Robots{0, 1, 2, 3}));
  EXPECT_TRUE(together.empty()) << "no robot is left";
  EXPECT_THROW(plan(-1), UsageError);
}

TEST(ResilientRound, BaitPlansAloneAndOthersTogether) {
  const std::vector<double> values = {1.0, 3.0, 2.0, 3.0};
  const ResilientRound round(values, 2);
  EXPECT_EQ(round.bait(), (std::vector<int>{1, 3}));
  EXPECT_EQ(round.non_bait(), (std::vector<int>{0, 2}));
  for (const int robot : {0, 1, 2, 3}) {
    EXPECT_EQ(round.is_bait(robot), robot % 2 == 1);
    EXPECT_EQ(round.robots_without_sensing_for(robot),
              robot % 2 == 1 ? (std::vector<int>{0, 1, 2, 3}) : round.bait());
  }
  const ResilientRound calm(values, 0);
  EXPECT_EQ(calm.non_bait(), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_TRUE(calm.robots_without_sensing_for(1).empty());
}

TEST(BaitRobots, AreThoseOfHighestValueThenLowestIndex) {
  const std::vector<double> values = {1.0, 3.0, 2.0, 3.0, 2.0};
  EXPECT_EQ(bait_robots(values, 0), (std::vector<int>{}));
  EXPECT_EQ(bait_robots(values, 1), (std::vector<int>{1}));
  EXPECT_EQ(bait_robots(values, 3), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(bait_robots(values, 9), (std::vector<int>{0, 1, 2, 3, 4}));
}

// Compares the greedy attack, the worst case of the experiments, with all attacks.
TEST(GreedyAttack, NearlyAlwaysEqualsTheWorstAttack) {
  int all_apart = 0;
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    int several = 0;
    int apart = 0;
    for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
      const TeamProblem problem = test::random_instance(seed, {5, 3, 0.0}, measure);
      const TeamOracle oracle(problem);
      const Choice choice = test::random_choice(oracle, seed);
      for (int attacks = 0; attacks <= 4; ++attacks) {
        const Attack worst = worst_attack(oracle, choice, attacks);
        const Attack greedy = greedy_attack(oracle, choice, attacks);
        for (const Attack& attack : {worst, greedy}) {
          EXPECT_LE(static_cast<int>(attack.robots.size()), attacks);
          Choice left = choice;
          for (const int robot : attack.robots) {
            left[static_cast<std::size_t>(robot)] = kNoCandidate;
          }
          EXPECT_EQ(value_of(oracle, left), attack.value);
        }
        EXPECT_GE(greedy.value, worst.value);
        EXPECT_LE(worst.value, value_of(oracle, choice));
        if (attacks <= 1) {
          EXPECT_EQ(greedy.value, worst.value);
        }
        several += attacks > 1 ? 1 : 0;
        apart += greedy.value > worst.value + kRounding ? 1 : 0;
      }
    }
    EXPECT_LT(apart, several / 100);
    all_apart += apart;
  }
  EXPECT_GT(all_apart, 0);
}

TEST(RandomAttack, IsUniform) {
  std::mt19937_64 rng(11);
  std::map<std::vector<int>, int> counts;
  const int draws = 20'000;
  for (int i = 0; i < draws; ++i) {
    ++counts[random_attack(5, 2, rng)];
  }
  ASSERT_EQ(counts.size(), 10U);
  double chi2 = 0.0;
  for (const auto& [robots, count] : counts) {
    EXPECT_LT(robots[0], robots[1]);
    chi2 += (count - draws / 10.0) * (count - draws / 10.0) / (draws / 10.0);
  }
  EXPECT_LT(chi2, 27.9);  // χ² with 9 degrees of freedom, 99.9 %
  EXPECT_EQ(random_attack(3, 3, rng), (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace vantage::planner
