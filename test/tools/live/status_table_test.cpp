#include "tools/live/status_table.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "scenario/reader/scenario_yaml.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

scenario::Scenario lab() {
  return scenario::load_scenario(std::string(VANTAGE_SOURCE_DIR) + "/config/lab.yaml");
}

std::string row_of(const std::vector<std::string>& lines, const std::string& name) {
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.starts_with(name + " ");
  });
  return found == lines.end() ? "" : *found;
}

// Returns a belief of Q1 about targets `ids`, each position with σ = 0.1 m.
models::RobotBelief belief(std::int64_t step, std::vector<int> ids) {
  models::RobotBelief out;
  out.robot = "Q1";
  out.step = step;
  out.stamp.time = from_utime(1'000'000 + 500'000 * step);
  for (const int id : ids) {
    models::TargetBelief target;
    target.target_id = id;
    target.information.vector = Eigen::Vector4d(100.0, 100.0, 0.0, 0.0);
    target.information.matrix = 100.0 * Eigen::Matrix4d::Identity();
    out.targets.push_back(target);
  }
  return out;
}

TEST(StatusTable, DistinguishesEstimatedFoundAndUnknownTargets) {
  logs::TrialMetrics metrics(lab(), from_utime(1'000'000));
  metrics.on_belief(belief(0, {0}));
  metrics.on_belief(belief(1, {0}));
  for (int step = 2; step < 8; ++step) {
    metrics.on_belief(belief(step, {1}));
  }
  const std::vector<std::string> lines = status_table(lab(), metrics, 2.0);
  EXPECT_NE(row_of(lines, "R1").find("none at present"), std::string::npos) << row_of(lines, "R1");
  EXPECT_NE(row_of(lines, "R2").find("Q1"), std::string::npos) << row_of(lines, "R2");
  EXPECT_NE(row_of(lines, "R3").find("not found yet"), std::string::npos) << row_of(lines, "R3");
}

TEST(StatusTable, HasTheSameTextInColour) {
  const scenario::Scenario scenario = lab();
  logs::TrialMetrics metrics(scenario, from_utime(1'000'000));
  const std::vector<std::string> plain = status_table(scenario, metrics, 2.0);
  const std::vector<std::string> coloured = status_table(scenario, metrics, 2.0, true);
  ASSERT_EQ(plain.size(), coloured.size());
  EXPECT_NE(plain, coloured);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    std::string bare;
    for (std::size_t at = 0; at < coloured[i].size(); ++at) {
      if (coloured[i][at] == '\x1b') {
        at = coloured[i].find('m', at);
      } else {
        bare += coloured[i][at];
      }
    }
    EXPECT_EQ(bare, plain[i]);
  }
}

TEST(StatusTable, ShowsTheMapOfAMappingTeam) {
  scenario::Scenario scenario = lab();
  scenario.targets.clear();
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  logs::TrialMetrics metrics(scenario, from_utime(1'000'000));
  models::RobotMap map;
  map.robot = "Q1";
  map.entropy_nats = 321.0;
  metrics.on_map(map);
  const std::vector<std::string> lines = status_table(scenario, metrics, 2.0);
  EXPECT_NE(row_of(lines, "map entropy").find("321 nat"), std::string::npos);
  EXPECT_EQ(row_of(lines, "target"), "");
}

}  // namespace
}  // namespace vantage::tools
