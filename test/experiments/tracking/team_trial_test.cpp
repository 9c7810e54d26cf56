#include "experiments/tracking/team_trial.hpp"

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

TEST(TeamTrial, AppliesTheExperimentsChanges) {
  const TeamTrial trial{.file = "field.yaml",
                        .communication_range_m = 30.0,
                        .planning_time_s = 0.2,
                        .range_sigma_m = 0.3,
                        .bearing_sigma_deg = 10.0,
                        .robots = 10,
                        .targets = 25,
                        .duration_s = 300.0};
  const scenario::Scenario scenario = scenario_of(trial, 7);
  EXPECT_EQ(scenario.seed, 7U);
  EXPECT_EQ(scenario.duration_s, 300.0);
  EXPECT_EQ(scenario.targets.size(), 25U);
  EXPECT_EQ(scenario.network.communication_range_m, 30.0);
  EXPECT_EQ(scenario.planner.node_budget,
            static_cast<std::int64_t>(kReferenceNodesPerS * 0.2 / 10.0));
  ASSERT_EQ(scenario.robots.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(scenario.robots[i].sensor.range_sigma_m, 0.3);
    EXPECT_NEAR(scenario.robots[i].sensor.bearing_sigma_rad, radians(10.0), 1e-12);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GT(
          (scenario.robots[i].start.position_m() - scenario.robots[k].start.position_m()).norm(),
          2.0 * scenario.planner.separation_m);
    }
  }
}

}  // namespace
}  // namespace vantage::experiments
