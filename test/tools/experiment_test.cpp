#include "tools/experiment/experiment.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "planner/team/decision/team_set.hpp"
#include "tools/experiment/energy_trial.hpp"
#include "tools/experiment/resilient_tracking.hpp"
#include "tools/experiment/sample.hpp"

namespace vantage::tools {
namespace {

TEST(Sample, HasTheMeanDeviationAndIntervalOfATextbook) {
  Sample sample;
  for (const double value : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) {
    sample.add(value);
  }
  EXPECT_DOUBLE_EQ(sample.mean(), 5.0);
  EXPECT_NEAR(sample.deviation(), std::sqrt(32.0 / 7.0), 1e-12);
  EXPECT_NEAR(sample.half_interval(), 2.365 * std::sqrt(32.0 / 7.0 / 8.0), 1e-12);
  EXPECT_EQ(Sample().mean(), 0.0);
}

TEST(EnergyTrial, IsDrawnByItsSeedAlone) {
  planner::ReducedValueIteration search({100'000, 4'000'000, 16, 16, 1});
  const EnergyTrial one = draw_energy_trial(2, 5, {}, search);
  const EnergyTrial again = draw_energy_trial(2, 5, {}, search);
  const EnergyTrial other = draw_energy_trial(2, 6, {}, search);
  EXPECT_EQ(one.robots[0].start.x_m, again.robots[0].start.x_m);
  EXPECT_NE(one.robots[0].start.x_m, other.robots[0].start.x_m);
  ASSERT_EQ(one.team.candidates[1].size(), again.team.candidates[1].size());
  for (const auto& of_robot : one.team.candidates) {
    EXPECT_GT(of_robot.size(), 1U);
  }
}

TEST(BestShare, KeepsTheBestOfEachRobot) {
  planner::ReducedValueIteration search({100'000, 4'000'000, 16, 16, 1});
  const EnergyTrial trial = draw_energy_trial(2, 1, {}, search);
  const planner::TeamOracle oracle(trial.team);
  const planner::TeamProblem best = best_share(oracle, 0.1);
  const planner::TeamOracle of_best(best);
  for (int robot = 0; robot < 2; ++robot) {
    const auto all = oracle.by_value(robot);
    const auto kept = of_best.by_value(robot);
    ASSERT_EQ(kept.size(),
              static_cast<std::size_t>(std::ceil(0.1 * static_cast<double>(all.size()))));
    for (std::size_t i = 0; i < kept.size(); ++i) {
      EXPECT_EQ(of_best.alone(kept[i]), oracle.alone(all[i]));
    }
  }
}

TEST(Experiments, WriteTheSameFilesAgainButForTheTimes) {
  ExperimentOptions options;
  options.smoke = true;
  for (const Experiment& experiment : all_experiments()) {
    ExperimentResult one = experiment.run(options);
    ExperimentResult again = experiment.run(options);
    one.files.erase("times.csv");
    again.files.erase("times.csv");
    EXPECT_FALSE(one.files.empty());
    EXPECT_EQ(one.files, again.files) << experiment.name;
    EXPECT_FALSE(one.report.empty());
  }
}

TEST(TrackUnderAttack, IsTheSameForBothWhereNobodyIsAttacked) {
  TrackingSetting setting;
  setting.robots = 2;
  setting.targets = 3;
  setting.attacks = 0;
  setting.task_steps = 30;
  setting.nodes_per_plan = 2'000;
  const TrackingRun cd = track_under_attack(setting, false, 4);
  const TrackingRun rain = track_under_attack(setting, true, 4);
  EXPECT_EQ(cd.rmse_m, rain.rmse_m);
  ASSERT_EQ(cd.rmse_m.size(), 30U);
}

// Errors of each target over time, and how well they are foreseen, where nobody is attacked.
TEST(TrackUnderAttack, KeepsEveryTargetWhereNobodyIsAttacked) {
  TrackingSetting setting;
  setting.robots = 8;
  setting.targets = 4;
  setting.attacks = 0;
  setting.task_steps = 250;
  double nees = 0.0;
  constexpr std::uint64_t kSeeds = 2;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TrackingRun run = track_under_attack(setting, false, seed);
    ASSERT_EQ(run.targets.size(), 250U);
    for (std::size_t m = 0; m < 4; ++m) {
      double squared_m2 = 0.0;
      int seen = 0;
      for (const std::vector<TargetStep>& targets : run.targets) {
        squared_m2 += targets[m].error_m * targets[m].error_m;
        nees += targets[m].nees;
        seen += targets[m].is_seen ? 1 : 0;
      }
      EXPECT_LT(std::sqrt(squared_m2 / 250.0), 1.0) << "seed " << seed << ", target " << m;
      EXPECT_GT(seen, 50) << "seed " << seed << ", target " << m;
    }
  }
  EXPECT_NEAR(nees / (4.0 * 250.0 * kSeeds), 4.0, 0.8);
}

TEST(TrackUnderAttack, LearnsNothingWhereAllAreAttacked) {
  TrackingSetting setting;
  setting.robots = 2;
  setting.targets = 2;
  setting.attacks = 2;
  setting.task_steps = 50;
  setting.nodes_per_plan = 2'000;
  const TrackingRun run = track_under_attack(setting, true, 4);
  for (std::size_t t = 1; t < run.entropy_nats.size(); ++t) {
    EXPECT_GE(run.entropy_nats[t], run.entropy_nats[t - 1] - 1e-9);
  }
}

}  // namespace
}  // namespace vantage::tools
