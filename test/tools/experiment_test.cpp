#include "tools/experiment/experiment.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "planner/team/decision/team_set.hpp"
#include "tools/experiment/energy_trial.hpp"
#include "tools/experiment/resilient_tracking.hpp"

namespace vantage::tools {
namespace {

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

// Every unit kind of every experiment is a function of its seed: run in another order, in a thread
// that has run others before.
TEST(Experiments, HaveUnitsThatAreFunctionsOfTheirSeed) {
  for (const Experiment& experiment : all_experiments()) {
    const Sweep sweep = experiment.make({0, true});
    ASSERT_EQ(sweep.plan.trials, 2) << experiment.name;
    const std::size_t last = sweep.plan.settings.size() - 1;
    const UnitRows one = sweep.run(0, 3);
    const UnitRows other = sweep.run(0, 4);
    sweep.run(last, 3);
    EXPECT_EQ(sweep.run(0, 3).tables, one.tables) << experiment.name;
    EXPECT_NE(other.tables, one.tables) << experiment.name;
    for (const auto& [table, rows] : one.tables) {
      ASSERT_TRUE(sweep.plan.tables.contains(table)) << experiment.name << " " << table;
      const std::size_t columns = cells_of(sweep.plan.tables.at(table)).size();
      for (const std::string& row : rows) {
        ASSERT_EQ(cells_of(row).size(), columns) << experiment.name << " " << table;
      }
    }
  }
}

TEST(Experiments, HaveSettingsOfTheirOwnNames) {
  for (const Experiment& experiment : all_experiments()) {
    const SweepPlan plan = experiment.make({}).plan;
    std::set<std::string> cells;
    for (const Setting& setting : plan.settings) {
      EXPECT_EQ(cells_of(setting.cells).size(), cells_of(plan.setting_columns).size());
      EXPECT_TRUE(cells.insert(setting.cells).second) << experiment.name << " " << setting.cells;
    }
    EXPECT_EQ(experiment.make({3, false}).plan.trials, 3);
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
