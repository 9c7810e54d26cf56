#include "tools/up/process_plan.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

models::Scenario two_robots() {
  models::Scenario out;
  out.robots.resize(2);
  out.robots[0].name = "Q1";
  out.robots[1].name = "Q2";
  return out;
}

TEST(ProcessPlan, HasOneSimulatorAndThreeProcessesARobot) {
  const auto plan = process_plan(two_robots(), {"/opt/bin", "s.yaml", "udpm://x"});
  ASSERT_EQ(plan.size(), 7U);
  EXPECT_EQ(plan[0].name, "sim");
  EXPECT_EQ(plan[0].arguments, (std::vector<std::string>{"/opt/bin/vantage-sim", "--scenario",
                                                         "s.yaml", "--url", "udpm://x"}));
  EXPECT_EQ(plan[6].name, "planner Q2");
  EXPECT_EQ(plan[6].arguments,
            (std::vector<std::string>{"/opt/bin/vantage-planner", "--scenario", "s.yaml", "--url",
                                      "udpm://x", "--robot", "Q2"}));
}

TEST(ProcessPlan, StartsNoSimulatorWhenEveryDeviceIsReal) {
  models::Scenario scenario = two_robots();
  scenario.mocap.device = models::DeviceSource::kReal;
  for (models::RobotSpec& robot : scenario.robots) {
    robot.device = models::DeviceSource::kReal;
  }
  const auto plan = process_plan(scenario, {".", "s.yaml", ""});
  EXPECT_TRUE(std::none_of(plan.begin(), plan.end(),
                           [](const ProcessSpec& process) { return process.name == "sim"; }));
}

}  // namespace
}  // namespace vantage::tools
