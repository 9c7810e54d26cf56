#include "experiments/decisions/energy_trial.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "experiments/decisions/energy_decision.hpp"

namespace vantage::experiments {
namespace {

TEST(EnergyTrial, DependsOnItsSeedOnly) {
  const EnergyTrial one = draw_energy_trial(2, 5, {}, thread_search());
  const EnergyTrial again = draw_energy_trial(2, 5, {}, thread_search());
  const EnergyTrial other = draw_energy_trial(2, 6, {}, thread_search());
  EXPECT_EQ(one.robots[0].start.x_m, again.robots[0].start.x_m);
  EXPECT_NE(one.robots[0].start.x_m, other.robots[0].start.x_m);
  ASSERT_EQ(one.team.candidates[1].size(), again.team.candidates[1].size());
  for (const auto& of_robot : one.team.candidates) {
    EXPECT_GT(of_robot.size(), 1U);
  }
}

TEST(HeterogeneousTrial, ComputesEnergyFromControlsAndTerrainOfEachRobot) {
  HeterogeneousTrialOptions options;
  options.price_nats = 0.3;
  int in_both = 0;
  for (std::uint64_t seed = 1001; seed <= 1010; ++seed) {
    const EnergyTrial trial = draw_heterogeneous_trial(seed, options, thread_search());
    ASSERT_EQ(trial.robots.size(), 3U);
    ASSERT_EQ(trial.team.targets.size(), 10U);
    for (std::size_t robot = 0; robot < 3; ++robot) {
      const bool is_flying = robot == 2;
      const planner::SearchProblem& problem = trial.robots[robot];
      const Pose2& start = problem.start;
      EXPECT_EQ(problem.sensors[0].range_max_m, is_flying ? 20.0 : 15.0);
      EXPECT_TRUE(start.x_m < 30.0 || (start.x_m < 40.0 && start.y_m < 40.0)) << "in mud or wind";
      ASSERT_GT(trial.team.candidates[robot].size(), 1U);
      for (const planner::Candidate& candidate : trial.team.candidates[robot]) {
        ASSERT_EQ(candidate.controls.size(), 20U);
        double cost = 0.0;
        for (std::size_t t = 0; t < 20; ++t) {
          const Pose2& at = t == 0 ? start : candidate.poses[t - 1];
          const auto& u = problem.controls[static_cast<std::size_t>(candidate.controls[t])];
          const bool in_mud = at.x_m >= 40.0 && at.y_m <= 60.0;
          const bool in_wind = at.x_m >= 30.0 && at.y_m >= 40.0;
          const double rest = is_flying ? 2.0 : 0.0;
          const double turn = is_flying ? 2.0 : 1.0;
          const double move = is_flying ? 4.0 : 2.0;
          cost += u.speed_mps > 0.0 ? move : u.yaw_rate_radps != 0.0 ? turn : rest;
          cost += (is_flying ? in_wind : in_mud) ? 3.0 : 0.0;
          in_both += in_mud && in_wind ? 1 : 0;
        }
        ASSERT_NEAR(candidate.energy_cost, 0.3 * cost, 1e-12) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(in_both, 0);
}

TEST(HeterogeneousTrial, PriceChangesOnlyTheEnergyCosts) {
  HeterogeneousTrialOptions options;
  const EnergyTrial free = draw_heterogeneous_trial(1001, options, thread_search());
  options.price_nats = 0.5;
  const EnergyTrial dear = draw_heterogeneous_trial(1001, options, thread_search());
  for (std::size_t robot = 0; robot < 3; ++robot) {
    ASSERT_EQ(free.team.candidates[robot].size(), dear.team.candidates[robot].size());
    for (std::size_t i = 0; i < free.team.candidates[robot].size(); ++i) {
      EXPECT_EQ(free.team.candidates[robot][i].controls, dear.team.candidates[robot][i].controls);
      EXPECT_EQ(free.team.candidates[robot][i].energy_cost, 0.0);
    }
  }
}

TEST(BestShare, KeepsTheBestCandidatesOfEachRobot) {
  const EnergyTrial trial = draw_energy_trial(2, 1, {}, thread_search());
  const planner::TeamOracle oracle(trial.team);
  const planner::TeamProblem best = best_share(oracle, 0.1);
  const planner::TeamOracle of_best(best);
  for (int robot = 0; robot < 2; ++robot) {
    const auto all = oracle.by_value(robot);
    const auto kept = of_best.by_value(robot);
    ASSERT_EQ(kept.size(),
              static_cast<std::size_t>(std::ceil(0.1 * static_cast<double>(all.size()))));
    for (std::size_t i = 0; i < kept.size(); ++i) {
      EXPECT_EQ(of_best.individual_value(kept[i]), oracle.individual_value(all[i]));
    }
  }
}

}  // namespace
}  // namespace vantage::experiments
