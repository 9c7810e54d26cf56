#include <gtest/gtest.h>

#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {
namespace {

TEST(FindRobot, GivesTheOneOfThatNameOrNone) {
  Scenario scenario;
  scenario.robots.resize(2);
  scenario.robots[0].name = "Q1";
  scenario.robots[1].name = "Q2";
  EXPECT_EQ(scenario.find_robot("Q2"), &scenario.robots[1]);
  EXPECT_EQ(scenario.find_robot("Q"), nullptr);
  EXPECT_EQ(scenario.find_robot(""), nullptr);
  EXPECT_EQ(Scenario{}.find_robot("Q1"), nullptr);
}

TEST(RunsOn, IsTheHostThatNamesItElseTheFirst) {
  Scenario scenario;
  EXPECT_TRUE(scenario.runs_on("LAB", "Q1")) << "without hosts all runs on any";
  scenario.hosts = {{"LAB", {"sim", "Q2"}}, {"AIR", {"Q1"}}};
  EXPECT_TRUE(scenario.runs_on("LAB", "Q2"));
  EXPECT_FALSE(scenario.runs_on("LAB", "Q1"));
  EXPECT_TRUE(scenario.runs_on("AIR", "Q1"));
  EXPECT_TRUE(scenario.runs_on("LAB", kLoggerPart)) << "named by none";
  EXPECT_FALSE(scenario.runs_on("AIR", kLoggerPart));
  EXPECT_FALSE(scenario.runs_on("ELSE", "Q2"));
}

TEST(FindBody, GivesTheOneOfThatNameOrNone) {
  models::MocapFrame frame;
  frame.bodies.resize(2);
  frame.bodies[0].name = "Q1";
  frame.bodies[1].name = "ROVER1";
  EXPECT_EQ(frame.find("ROVER1"), &frame.bodies[1]);
  EXPECT_EQ(frame.find("rover1"), nullptr);
  EXPECT_EQ(models::MocapFrame{}.find("Q1"), nullptr);
}

}  // namespace
}  // namespace vantage::scenario
