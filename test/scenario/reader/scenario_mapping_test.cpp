#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

const std::string kTeam =
    "name: x\n"
    "world: {bounds: {min_m: [0, 0], max_m: [10, 8]}}\n"
    "robots: [{name: A, start: {x_m: 2, y_m: 2}, primitives: lab, sensor: {kind: range}}]\n";
const std::string kMapper = kTeam + "planner: {objective: mapping}\n";

std::string refusal_of(const std::string& yaml) {
  try {
    static_cast<void>(parse_scenario(yaml, "x.yaml"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(MappingScenario, IsReadFromItsFile) {
  const Scenario scenario = load_scenario(std::string(VANTAGE_SOURCE_DIR) + "/config/mapping.yaml");
  EXPECT_EQ(scenario.planner.objective, PlanObjective::kMapping);
  EXPECT_TRUE(scenario.targets.empty());
  EXPECT_EQ(scenario.planner.attacks_max, 1);
  EXPECT_EQ(scenario.world.obstacles.size(), 16U);
}

TEST(MappingScenario, ReadsEveryKeyOfTheScannerAndTheMap) {
  const models::MappingSpec mapping = parse_scenario(kMapper + R"(
mapping:
  scanner: {beams: 31, fov_deg: 180, range_min_m: 0.1, range_max_m: 4, range_sigma_m: 0.03}
  planned_beams: 15
  resolution_m: 0.5
  look_probability: 0.8
  settled_probability: 0.97
  frontier_nats_per_m: 0
)",
                                                     "x.yaml")
                                          .mapping;
  EXPECT_EQ(mapping.scanner.beams, 31);
  EXPECT_DOUBLE_EQ(mapping.scanner.field_of_view_rad, kPi);
  EXPECT_EQ(mapping.scanner.range_min_m, 0.1);
  EXPECT_EQ(mapping.scanner.range_max_m, 4.0);
  EXPECT_EQ(mapping.scanner.sigma_m, 0.03);
  EXPECT_EQ(mapping.planned_beams, 15);
  EXPECT_EQ(mapping.resolution_m, 0.5);
  EXPECT_EQ(mapping.look_probability, 0.8);
  EXPECT_EQ(mapping.settled_probability, 0.97);
  EXPECT_EQ(mapping.frontier_nats_per_m, 0.0);
}

TEST(MappingScenario, HasTheStatedDefaults) {
  const models::MappingSpec mapping = parse_scenario(kMapper + "mapping: {}\n", "x.yaml").mapping;
  EXPECT_EQ(mapping.resolution_m, 0.2);
  EXPECT_EQ(mapping.look_probability, 0.95);
  EXPECT_EQ(mapping.settled_probability, 0.99);
  EXPECT_EQ(mapping.frontier_nats_per_m, 0.5);
}

TEST(MappingScenario, RequiresItsSectionButNoTargets) {
  EXPECT_EQ(refusal_of(kMapper + "mapping: {resolution_m: 0.5}\n"), "not refused");
  EXPECT_EQ(refusal_of(kMapper),
            "x.yaml:4: planner: objective: mapping needs the section `mapping`, which "
            "describes the scanners");
  EXPECT_EQ(refusal_of(kTeam + "mapping: {resolution_m: 0.5}\n"),
            "x.yaml:1: missing required key targets")
      << "required for a team that tracks";
}

TEST(MappingScenario, RefusesInvalidMap) {
  const auto with = [](const std::string& section) {
    return refusal_of(kMapper + "mapping: " + section + "\n");
  };
  EXPECT_EQ(with("{look_probability: 0.5}"),
            "x.yaml:5: mapping.look_probability: must be above 0.5 and below 1, is 0.5");
  EXPECT_EQ(with("{settled_probability: 1}"),
            "x.yaml:5: mapping.settled_probability: must be above 0.5 and below 1, is 1");
  EXPECT_EQ(with("{resolution_m: 0.01}"),
            "x.yaml:5: mapping.resolution_m: must divide world.bounds into at most 50000 cells; "
            "0.01 gives 8e+05");
  EXPECT_EQ(with("{scanner: {range_min_m: 2}}"),
            "x.yaml:5: mapping.scanner.range_min_m: must be below range_max_m (1.5), but is 2");
  EXPECT_TRUE(with("{beams: 3}").starts_with("x.yaml:5: mapping.beams: unknown key"));
  EXPECT_EQ(refusal_of(kTeam + "planner: {objective: exploring}\n"),
            "x.yaml:4: planner.objective: must be one of tracking, mapping; is 'exploring'");
}

}  // namespace
}  // namespace vantage::scenario
