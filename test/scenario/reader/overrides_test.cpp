#include "scenario/reader/overrides.hpp"

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

const std::string kLab = VANTAGE_SOURCE_DIR "/config/lab.yaml";

TEST(Overrides, KeepTheTextWithoutOverrides) {
  const Scenario scenario = load_scenario_with(kLab, {});
  EXPECT_EQ(scenario.source_text, load_scenario(kLab).source_text);
  EXPECT_EQ(apply_overrides("a:   1  # one\n", {}), "a:   1  # one\n") << "blanks are unchanged";
}

TEST(Overrides, ChangeScenarioText) {
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

// Each single override makes the set non-empty and changes only its own key.
TEST(Overrides, ChangeOneKeyEach) {
  const Scenario lab = load_scenario(kLab);
  EXPECT_TRUE(Overrides{}.is_empty());
  for (int which = 0; which < 7; ++which) {
    Overrides one;
    Scenario expected = lab;
    switch (which) {
      case 0:
        expected.seed = one.seed.emplace(18'446'744'073'709'551'615U);
        break;
      case 1:
        expected.duration_s = one.duration_s.emplace(1.0 / 3.0);
        break;
      case 2:
        expected.planner.algorithm = one.planner.emplace("greedy");
        break;
      case 3:
        expected.network.communication_range_m = one.communication_range_m.emplace(0.1);
        break;
      case 4:
        expected.planner.node_budget = one.node_budget.emplace(9'000'000'000);
        break;
      case 5:
        expected.network.url = one.url.emplace("memq://");
        break;
      default:
        one.keys["planner.exploration.landmarks_max"] = "7";
        expected.planner.exploration.landmarks_max = 7;
    }
    EXPECT_FALSE(one.is_empty()) << which;
    const Scenario changed = load_scenario_with(kLab, one);
    EXPECT_NE(changed.source_text, lab.source_text) << which;
    EXPECT_EQ(changed.seed, expected.seed) << which;
    EXPECT_EQ(changed.duration_s, expected.duration_s) << "all digits are equal";
    EXPECT_EQ(changed.planner.algorithm, expected.planner.algorithm) << which;
    EXPECT_EQ(changed.network.communication_range_m, expected.network.communication_range_m);
    EXPECT_EQ(changed.planner.node_budget, expected.planner.node_budget) << which;
    EXPECT_EQ(changed.network.url, expected.network.url) << which;
    EXPECT_EQ(changed.planner.exploration.landmarks_max, expected.planner.exploration.landmarks_max)
        << which;
    EXPECT_EQ(changed.planner.horizon_steps, lab.planner.horizon_steps) << which;
    EXPECT_EQ(changed.robots.size(), lab.robots.size()) << which;
  }
}

TEST(Overrides, AreNamedInErrors) {
  Overrides overrides;
  overrides.keys["planner.horizon_steps"] = "0";
  try {
    static_cast<void>(load_scenario_with(kLab, overrides));
    ADD_FAILURE() << "accepted";
  } catch (const StartupError& error) {
    EXPECT_EQ(std::string(error.what()).find(kLab + " with options:"), 0U) << error.what();
  }
}

// Overrides by path can change keys that have no command-line option, such as the robots and the
// noise of a sweep.
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

TEST(Overrides, RefuseInvalidScenarioValues) {
  Overrides overrides;
  overrides.planner = "psychic";
  EXPECT_THROW(load_scenario_with(kLab, overrides), StartupError);
}

}  // namespace
}  // namespace vantage::scenario
