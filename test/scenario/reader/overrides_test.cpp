#include "scenario/reader/overrides.hpp"

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

const std::string kLab = VANTAGE_SOURCE_DIR "/config/lab.yaml";

TEST(Overrides, LeaveTheTextAloneWhenThereAreNone) {
  const Scenario scenario = load_scenario_with(kLab, {});
  EXPECT_EQ(scenario.source_text, load_scenario(kLab).source_text);
}

TEST(Overrides, AreWhatTheTextThenSays) {
  Overrides overrides;
  overrides.seed = 42;
  overrides.duration_s = 12.5;
  overrides.planner = "lawn_mower";
  overrides.communication_range_m = 7.0;
  overrides.node_budget = 321;
  overrides.url = "memq://";
  const Scenario scenario = load_scenario_with(kLab, overrides);
  const Scenario again = parse_scenario(scenario.source_text, "again");
  for (const Scenario& each : {scenario, again}) {
    EXPECT_EQ(each.seed, 42U);
    EXPECT_EQ(each.duration_s, 12.5);
    EXPECT_EQ(each.planner.algorithm, "lawn_mower");
    EXPECT_EQ(each.network.communication_range_m, 7.0);
    EXPECT_EQ(each.planner.node_budget, 321);
    EXPECT_EQ(each.network.url, "memq://");
    EXPECT_EQ(each.robots.size(), load_scenario(kLab).robots.size());
    EXPECT_EQ(each.robots[0].primitives, load_scenario(kLab).robots[0].primitives);
  }
}

// A sweep's robots and noise: keys that no option of a command names.
TEST(Overrides, WriteAnyKeyByItsPath) {
  Overrides overrides;
  overrides.keys["robot_defaults.sensor.range_sigma_m"] = "0.75";
  overrides.keys["targets.count"] = "3";
  overrides.keys["robots"] =
      "[{name: Q1, start: {x_m: -3.0, y_m: 0.25, yaw_deg: 90.0}, height_m: 1.0}, ]";
  EXPECT_FALSE(overrides.is_empty());
  const Scenario changed = load_scenario_with(kLab, overrides);
  ASSERT_EQ(changed.robots.size(), 1U);
  EXPECT_EQ(changed.robots[0].start.y_m, 0.25);
  EXPECT_EQ(changed.robots[0].sensor.range_sigma_m, 0.75);
  EXPECT_EQ(changed.targets.size(), 3U);
  EXPECT_EQ(parse_scenario(changed.source_text, "again").robots[0].start.x_m, -3.0);
  overrides.keys["robot_defaults.sensor.ranje_sigma_m"] = "0.75";
  EXPECT_THROW(load_scenario_with(kLab, overrides), StartupError);
}

TEST(Overrides, CannotSayWhatAScenarioCannot) {
  Overrides overrides;
  overrides.planner = "psychic";
  EXPECT_THROW(load_scenario_with(kLab, overrides), StartupError);
}

}  // namespace
}  // namespace vantage::scenario
