#include "tools/check/preflight.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::tools {
namespace {

scenario::Scenario lab() { return scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml"); }

// Returns the only fault of a scenario; fails the test unless there is exactly one.
std::string only_fault(const scenario::Scenario& scenario) {
  const Preflight preflight = check_preflight(scenario);
  EXPECT_EQ(preflight.faults.size(), 1U);
  return preflight.faults.empty() ? "" : preflight.faults[0];
}

TEST(CheckPreflight, AcceptsTheInstalledScenarios) {
  for (const char* path :
       {VANTAGE_SOURCE_DIR "/config/lab.yaml", VANTAGE_SOURCE_DIR "/config/field.yaml"}) {
    const Preflight preflight = check_preflight(scenario::load_scenario(path));
    EXPECT_TRUE(preflight.is_ready()) << path;
    EXPECT_GE(preflight.understood.size(), 4U);
  }
}

TEST(CheckPreflight, ReportsWhetherDetectionsHaveIds) {
  const auto understands = [](const scenario::Scenario& scenario, const std::string& words) {
    const std::vector<std::string> lines = check_preflight(scenario).understood;
    return std::any_of(lines.begin(), lines.end(),
                       [&](const auto& line) { return line.find(words) != std::string::npos; });
  };
  EXPECT_TRUE(understands(lab(), "5 targets; communication"));
  EXPECT_TRUE(understands(
      scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab-nomocap.yaml"),
      "3 robots compute their pose with 10 landmarks; odometry and sightings are simulated, motion "
      "capture is withheld; without mocap, rovers do not drive by this pose"));
  EXPECT_TRUE(understands(scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab-unlabelled.yaml"),
                          "5 targets, detected without ids; communication"));
}

TEST(CheckPreflight, RefusesAStartTooCloseToAWall) {
  scenario::Scenario scenario = lab();
  scenario.robots[0].start.x_m = scenario.world.bounds.min_m.x() + 0.3;  // m; less than 0.25 + 0.1
  EXPECT_NE(only_fault(scenario).find("robot Q1"), std::string::npos);
  scenario.robots[0].start.x_m = scenario.world.bounds.min_m.x() + 0.36;
  EXPECT_TRUE(check_preflight(scenario).is_ready());
}

TEST(CheckPreflight, IncludesHeightInTheSeparationOfStarts) {
  scenario::Scenario scenario = lab();
  scenario.robots[1].start = scenario.robots[0].start;
  scenario.robots[1].height_m = scenario.robots[0].height_m + 0.5;  // less than the 0.6 m required
  EXPECT_NE(only_fault(scenario).find("Q1 and Q2"), std::string::npos);
  scenario.robots[1].height_m = scenario.robots[0].height_m + 0.7;
  EXPECT_TRUE(check_preflight(scenario).is_ready());
}

TEST(CheckPreflight, RefusesARoundThatIsTooShortForItsSlots) {
  scenario::Scenario scenario = lab();
  scenario.planner.team_budget_s = scenario.planner.execute_steps * scenario.planner.step_s;
  EXPECT_NE(only_fault(scenario).find("round"), std::string::npos);
}

TEST(CheckPreflight, RefusesATargetThatStartsInAnObstacle) {
  scenario::Scenario scenario = lab();
  ASSERT_FALSE(scenario.world.obstacles.empty());
  const models::Rectangle& box = scenario.world.obstacles[0].footprint;
  const Eigen::Vector2d centre_m = 0.5 * (box.min_m + box.max_m);
  scenario.targets[2].start = Pose2{centre_m.x(), centre_m.y(), 0.0};
  EXPECT_NE(only_fault(scenario).find(scenario.targets[2].name), std::string::npos);
}

TEST(CheckPreflight, ReportsLineWhenTargetsCannotBePlaced) {
  scenario::Scenario scenario = lab();
  for (int id = 5; id < 500; ++id) {
    scenario.targets.push_back(scenario.targets.back());
    scenario.targets.back().id = id;
    scenario.targets.back().name = "R" + std::to_string(id + 1);
  }
  const std::string fault = only_fault(scenario);
  EXPECT_NE(
      fault.find("line " + std::to_string(scenario::line_of_key(scenario.source_text, "targets")) +
                 ": target R"),
      std::string::npos)
      << fault;
  EXPECT_NE(fault.find("of 500 targets have one"), std::string::npos) << fault;
}

TEST(CheckPreflight, RefusesANonMulticastAddressWithItsLine) {
  scenario::Scenario scenario = lab();
  scenario.network.url = "udpm://10.0.0.1:7667?ttl=0";
  const std::string fault = only_fault(scenario);
  EXPECT_NE(fault.find("line " +
                       std::to_string(scenario::line_of_key(scenario.source_text, "network.url")) +
                       ": network.url 'udpm://10.0.0.1:7667?ttl=0'"),
            std::string::npos)
      << fault;
  EXPECT_NE(fault.find("not an IPv4 multicast address"), std::string::npos) << fault;
  scenario.network.url = "memq://";
  EXPECT_TRUE(check_preflight(scenario).is_ready());
}

TEST(PlannerMemory, IsCheckedForTheHostWithMostPlanners) {
  scenario::Scenario scenario = lab();
  EXPECT_TRUE(check_planner_memory(scenario, 400'000'000).is_enough);
  const MemoryCheck little = check_planner_memory(scenario, 300'000'000);
  EXPECT_FALSE(little.is_enough);
  EXPECT_EQ(little.summary,
            "line " + std::to_string(scenario::line_of_key(scenario.source_text, "robots")) +
                ": memory: 3 planners on one host need up to 0.4 GB; 0.3 GB are free on this host");
  scenario.hosts = {{"LAB", {"Q1"}}, {"AIR", {"Q2", "Q3"}}};
  EXPECT_TRUE(check_planner_memory(scenario, 300'000'000).is_enough) << "two on one host";
  EXPECT_TRUE(check_planner_memory(scenario, std::nullopt).is_enough) << "unknown memory";
  EXPECT_GT(free_memory_bytes().value_or(0), 1'000'000U);
}

TEST(LineOfKey, IgnoresCommentsAndFlowStyle) {
  const std::string text = "name: x\n# nothing\nnetwork:\n  url: memq://\ntargets: {count: 2}\n";
  EXPECT_EQ(scenario::line_of_key(text, "network.url"), 4);
  EXPECT_EQ(scenario::line_of_key(text, "network.no_key"), 3);
  EXPECT_EQ(scenario::line_of_key(text, "targets"), 5);
  EXPECT_EQ(scenario::line_of_key(text, "robots"), 0);
}

// Returns three quadrotors with drivers: 1 m/s, 2 m/s², radius 0.25 m, separation 0.6 m, margin 0.1
// m.
scenario::Scenario lab_hil() {
  return scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab-hil.yaml");
}

std::string all_of(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) {
    out += line + "\n";
  }
  return out;
}

TEST(CheckPreflight, NotesTheStoppingDistanceOfAFailedDriver) {
  scenario::Scenario scenario = lab_hil();
  scenario.planner.separation_m = 0.6;
  scenario.planner.obstacle_margin_m = 0.1;
  scenario.planner.separation_from_above = false;
  const Preflight preflight = check_preflight(scenario);
  EXPECT_TRUE(preflight.is_ready()) << "a note, not a refusal";
  ASSERT_EQ(preflight.notes.size(), 1U);
  const std::string& note = preflight.notes[0];
  EXPECT_NE(note.find("at 1 m/s"), std::string::npos) << note;
  EXPECT_NE(note.find("0.30 m beyond"), std::string::npos) << note;
  EXPECT_NE(note.find("planner.separation_m 0.90 (is 0.6)"), std::string::npos) << note;
  EXPECT_NE(note.find("planner.separation_from_above"), std::string::npos) << note;
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.height_m = 1.0;
  }
  EXPECT_EQ(all_of(check_preflight(scenario).notes).find("from_above"), std::string::npos);
  scenario = lab_hil();
  scenario.planner.separation_m = 0.6;
  scenario.planner.obstacle_margin_m = 0.1;
  scenario.planner.separation_from_above = true;
  EXPECT_EQ(all_of(check_preflight(scenario).notes).find("from_above"), std::string::npos);
  EXPECT_NE(note.find("planner.obstacle_margin_m 0.40 (is 0.1)"), std::string::npos) << note;
  scenario.planner.separation_m = 0.9;
  EXPECT_EQ(all_of(check_preflight(scenario).notes).find("separation_m"), std::string::npos);
  scenario.planner.obstacle_margin_m = 0.4;
  EXPECT_TRUE(check_preflight(scenario).notes.empty());
  scenario = lab();
  EXPECT_TRUE(check_preflight(scenario).notes.empty()) << "simulated vehicles have no driver";
}

TEST(CheckPreflight, NotesPlansPublishedAfterVehiclesStartToTurn) {
  scenario::Scenario scenario = lab_hil();
  scenario.planner.separation_m = 0.9;
  scenario.planner.separation_from_above = true;
  scenario.planner.obstacle_margin_m = 0.4;
  scenario.planner.publish_margin_s = 0.35;  // s; set-point lead 0.1 + half window 0.25
  EXPECT_TRUE(check_preflight(scenario).notes.empty());
  scenario.planner.publish_margin_s = 0.34;
  EXPECT_NE(all_of(check_preflight(scenario).notes).find("planner.publish_margin_s to 0.35"),
            std::string::npos);
  scenario = lab();
  scenario.planner.publish_margin_s = 0.0;
  EXPECT_TRUE(check_preflight(scenario).notes.empty()) << "these vehicles turn immediately";
}

TEST(CheckPreflight, NotesWindWithoutEffect) {
  scenario::Scenario scenario = lab();
  scenario.wind = scenario::WindSpec{1.5, 0.0, 0.1};
  EXPECT_TRUE(check_preflight(scenario).notes.empty());
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.device = scenario::DeviceSource::kReal;
  }
  EXPECT_NE(all_of(check_preflight(scenario).notes).find("wind x_mps 1.5"), std::string::npos);
}

TEST(CheckPreflight, RefusesAScenarioWithoutRobots) {
  scenario::Scenario scenario = lab();
  scenario.robots.clear();
  EXPECT_NE(all_of(check_preflight(scenario).faults).find("the scenario has no robot"),
            std::string::npos);
}

TEST(CheckPreflight, NotesMovingTargetsWithStationaryModel) {
  scenario::Scenario scenario = lab();
  models::TargetModel& believed = scenario.estimator.target_model;
  believed.q = 0.0;  // the oscillator model ignores q
  EXPECT_TRUE(check_preflight(scenario).notes.empty());
  believed.kind = models::TargetKind::kRandomWalk;
  EXPECT_NE(all_of(check_preflight(scenario).notes).find("target_model: q 0"), std::string::npos);
  believed.kind = models::TargetKind::kStatic;
  EXPECT_NE(all_of(check_preflight(scenario).notes).find("kind static"), std::string::npos);
  scenario.target_truth.motion = scenario::TargetMotion::kStill;
  EXPECT_TRUE(check_preflight(scenario).notes.empty());
  scenario.target_truth.motion = scenario::TargetMotion::kRandomWaypoint;
  believed.kind = models::TargetKind::kRandomWalk;
  believed.q = 0.3;
  EXPECT_TRUE(check_preflight(scenario).notes.empty());
}

}  // namespace
}  // namespace vantage::tools
