#include "tools/check/purpose_notes.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/lab_text.hpp"

namespace vantage::tools {
namespace {

/// A valid scenario that cannot fulfil its purpose: config/lab.yaml with `edits`. A note must
/// contain `words`.
struct Row {
  const char* name;
  std::vector<test::TextEdit> edits;
  const char* words;
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

const Row kRows[] = {
    {"RangeOnly",
     {{"kind: range_bearing", "kind: range"},
      {"kind: damped_oscillator", "kind: random_walk"},
      {"position_dim: 2", "position_dim: 3"}},
     "no target can be found: target_model.position_dim is 3"},
    {"BearingOnly",
     {{"kind: range_bearing", "kind: bearing"},
      {"kind: damped_oscillator", "kind: random_walk"},
      {"position_dim: 2", "position_dim: 3"}},
     "give at least one robot a sensor of kind position, range_bearing, camera"},
    {"SeesOnlyItself",
     {{"range_max_m: 1 ", "range_max_m: 0.11 "}},
     "sensor.range_max_m 0.11: not more than the robot's radius_m 0.25"},
    {"FliesHigherThanItsSensorRange",
     {{"kind: damped_oscillator", "kind: random_walk"}, {"position_dim: 2", "position_dim: 3"}},
     "robot Q2: sensor.range_max_m 1: not more than height_m 1.5"},
    {"ThinRing", {{"range_min_m: 0.1", "range_min_m: 0.95"}}, "seen in a thin ring only"},
    {"NarrowView",
     {{"fov_deg: 360", "fov_deg: 2"}},
     "sensor.fov_deg 2: targets are rarely in view; fov_deg is the full angle"},
    {"RangeWithoutInformation",
     {{"range_sigma_m: 0.3", "range_sigma_m: 30"}},
     "sensor.range_sigma_m 30: not less than range_max_m 1"},
    {"BearingWithoutInformation",
     {{"bearing_sigma_deg: 5", "bearing_sigma_deg: 120"}},
     "sensor.bearing_sigma_deg 120: a bearing gives no information"},
    {"PositionWithoutInformation",
     {{"kind: range_bearing", "kind: position"}, {"position_sigma_m: 0.1", "position_sigma_m: 50"}},
     "a position gives no information in this world"},
    {"MissesEveryTarget",
     {{"detection_probability: 1 ", "detection_probability: 0.01 "},
      {"detection_probability: 0.8", "detection_probability: 0"}},
     "almost every target in view is missed"},
    {"MoreFalseAlarmsThanTargets",
     {{"detects_ids: true", "detects_ids: false"},
      {"clutter_per_look: 0 ", "clutter_per_look: 15 "}},
     "most detections are false alarms"},
    {"AssumesMoreDetections",
     {{"detection_probability: 1 ", "detection_probability: 0.2 "}},
     "robot Q1: sensor.detection_probability 0.2, but estimator.detection_probability 0.8"},
    {"TargetsTooFast",
     {{"speed_max_mps: 1.4", "speed_max_mps: 14"}},
     "target_truth.speed_max_mps 14: targets are more than twice as fast as the fastest robot, 1 "
     "m/s"},
    {"TargetsPauseForTheWholeTrial",
     {{"pause_max_s: 2 ", "pause_max_s: 3000 "}},
     "most pauses are longer than the trial"},
    {"UnusedNoise", {{"q: 0.3", "q: 3000"}}, "q 3000: kind damped_oscillator does not use it"},
    {"NoiseBeyondTheWorld",
     {{"kind: damped_oscillator", "kind: random_walk"}, {"q: 0.3", "q: 3000"}},
     "uncertain by 173 m, more than the world's diagonal"},
    {"SamplesWithoutVelocity",
     {{"kind: damped_oscillator", "kind: random_walk"}, {"samples: false", "samples: true"}},
     "estimator.samples true: kind random_walk has no velocity"},
    {"RejectsItsDetections",
     {{"gate_sigma: 4", "gate_sigma: 0.5"}},
     "gate_sigma 0.5: most correct detections are rejected"},
    {"ForgetsWithinARound",
     {{"grid_memory_s: 30", "grid_memory_s: 0.5"}},
     "grid_memory_s 0.5: less than a planning round, 1 s"},
    {"CannotMove",
     {{"primitives: lab", "primitives: [{speed_mps: 0, yaw_rate_radps: 1}]"}},
     "primitives: none has a speed above 0"},
    {"CannotTurn",
     {{"primitives: lab", "primitives: [{speed_mps: 1, yaw_rate_radps: 0}]"}},
     "primitives: none has a yaw rate"},
    {"NoTimeToPlan",
     {{"team_budget_s: 0.5", "team_budget_s: 0.001"}},
     "planner.team_budget_s 0.001: each of 3 robots has 0.33 ms per round"},
    {"TooFewNodes",
     {{"node_budget: 0", "node_budget: 7"}},
     "planner.node_budget 7: fewer nodes than one path needs (5 primitives · 12 steps)"},
    {"PlansShorterThanAStop",
     {{"step_s: 0.5", "step_s: 0.03"},
      {"team_budget_s: 0.5", "team_budget_s: 0.02"},
      {"publish_margin_s: 0.05", "publish_margin_s: 0.01"},
      {"node_budget: 0", "node_budget: 100"}},
     "a plan lasts 0.36 s, less than robot Q1 needs to stop, 0.5 s"},
    {"EndsBeforeTheSecondRound",
     {{"duration_s: 300", "duration_s: 1.5"}},
     "duration_s 1.5: the trial ends before the second planning round; a round lasts 1 s"},
    {"ToleranceAboveSeparation",
     {{"tracking_tolerance_m: 0.2", "tracking_tolerance_m: 0.5"}},
     "tracking_tolerance_m 0.5: more than half of separation_m 0.6"},
    {"NeverInRange",
     {{"communication_range_m: 3 ", "communication_range_m: 0.5 "}},
     "network.communication_range_m 0.5: not more than planner.separation_m 0.6"},
    {"AttackAfterTheEnd",
     {{"planner:\n", "attacks: [{from_s: 400, to_s: 500, robots: [Q1]}]\nplanner:\n"}},
     "attacks[0].from_s 400: not before the end of the trial"},
    {"SlowMocap", {{"rate_hz: 50", "rate_hz: 1"}}, "mocap.rate_hz 1: poses are up to 1 s old"},
    {"LateMocap",
     {{"latency_s: 0.005", "latency_s: 0.8"}},
     "mocap.latency_s 0.8: poses arrive too late"},
    {"SpeedGateBelowTheSpeed",
     {{"latency_s: 0.005", "latency_s: 0.005\n  gate_speed_mps: 0.5"}},
     "mocap.gate_speed_mps 0.5: not more than the speed of robot Q1, 1 m/s"},
    {"TurnGateBelowTheYawRate",
     {{"latency_s: 0.005", "latency_s: 0.005\n  gate_turn_radps: 1"}},
     "mocap.gate_turn_radps 1: not more than the yaw rate of robot Q1, 3 rad/s"},
    {"NoisyMocap",
     {{"position_sigma_m: 0.0005", "position_sigma_m: 0.5"}},
     "mocap.position_sigma_m 0.5: more than planner.tracking_tolerance_m 0.2"},
};

class ScenarioWithoutPurpose : public ::testing::TestWithParam<Row> {};

TEST_P(ScenarioWithoutPurpose, IsAcceptedWithANote) {
  const std::string text = test::lab_with(GetParam().edits);
  const std::vector<std::string> notes = purpose_notes(scenario::parse_scenario(text, "lab.yaml"));
  ASSERT_FALSE(notes.empty());
  bool is_noted = false;
  for (const std::string& note : notes) {
    is_noted = is_noted || note.find(GetParam().words) != std::string::npos;
  }
  EXPECT_TRUE(is_noted) << notes.front();
}

INSTANTIATE_TEST_SUITE_P(Rows, ScenarioWithoutPurpose, ::testing::ValuesIn(kRows),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(PurposeNotes, AreEmptyForTheInstalledScenarios) {
  for (const char* name :
       {"field", "lab", "lab-ardupilot", "lab-attack", "lab-energy", "field-odometry", "lab-ground",
        "lab-hil", "lab-nomocap", "lab-px4", "lab-unlabelled", "mapping"}) {
    const std::string path = std::string(VANTAGE_SOURCE_DIR "/config/") + name + ".yaml";
    const std::vector<std::string> notes = purpose_notes(scenario::load_scenario(path));
    EXPECT_TRUE(notes.empty()) << name << ": " << notes.front();
  }
}

TEST(PurposeNotes, StateThatThereIsNothingToTrack) {
  scenario::Scenario lab = scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml");
  lab.targets.clear();
  const std::vector<std::string> notes = purpose_notes(lab);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].find("targets: the scenario has none"), 0U);
}

TEST(DiscoveryObstacle, IsAbsentIfASensorDeterminesThePosition) {
  scenario::Scenario lab = scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml");
  EXPECT_FALSE(discovery_obstacle(lab));
  for (scenario::RobotSpec& robot : lab.robots) {
    robot.sensor.kind = models::SensorKind::kRange;
  }
  EXPECT_FALSE(discovery_obstacle(lab)) << "several ranges locate a target on the ground";
  lab.estimator.target_model.position_dim = 3;
  EXPECT_TRUE(discovery_obstacle(lab));
  lab.robots[1].sensor.kind = models::SensorKind::kCamera;
  EXPECT_FALSE(discovery_obstacle(lab));
}

}  // namespace
}  // namespace vantage::tools
