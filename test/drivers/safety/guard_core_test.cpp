#include "drivers/safety/guard_core.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/limits.hpp"

namespace vantage::drivers {
namespace {

using models::OperatorAction;

scenario::Scenario room() {
  scenario::Scenario out;
  out.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  out.world.ceiling_m = 3.0;
  scenario::RobotSpec robot;
  robot.name = "Q1";
  robot.height_m = 1.0;
  robot.limits = {1.0, 3.0, 2.0, 0.25};
  out.robots.push_back(robot);
  return out;
}

// Whatever the order in which they come; and in the tick after that again.
TEST(GuardCore, AnswersTheSafestOfTheOrdersOfATick) {
  const scenario::Scenario scenario = room();
  GuardCore core(scenario, "Q1", limits_for(scenario, "Q1"), Course(0.25));
  std::vector<OperatorAction> orders = {OperatorAction::kFollow, OperatorAction::kHold,
                                        OperatorAction::kLand};
  Time now = from_utime(1'000'000);
  do {
    for (const OperatorAction order : orders) {
      EXPECT_EQ(core.ask(order), CommandVerdict::kObeyed);
    }
    core.look(now);
    EXPECT_EQ(core.in.request, OperatorAction::kLand);
    core.end_tick(now);
    now += from_seconds(0.02);
    core.look(now);
    EXPECT_EQ(core.in.request, std::nullopt) << "what was answered is asked no more";
  } while (std::next_permutation(orders.begin(), orders.end()));
}

}  // namespace
}  // namespace vantage::drivers
