#include <gtest/gtest.h>

#include "models/exchange/messages.hpp"
#include "models/scenario/scenario.hpp"

namespace vantage::models {
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

TEST(FindBody, GivesTheOneOfThatNameOrNone) {
  MocapFrame frame;
  frame.bodies.resize(2);
  frame.bodies[0].name = "Q1";
  frame.bodies[1].name = "ROVER1";
  EXPECT_EQ(frame.find("ROVER1"), &frame.bodies[1]);
  EXPECT_EQ(frame.find("rover1"), nullptr);
  EXPECT_EQ(MocapFrame{}.find("Q1"), nullptr);
}

}  // namespace
}  // namespace vantage::models
