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

// A heartbeat asks for nothing, and says nothing that is to be answered.
TEST(GuardCore, ObeysAtOnceWhatNeedsNoLook) {
  const scenario::Scenario scenario = room();
  GuardCore core(scenario, "Q1", limits_for(scenario, "Q1"), Course(0.25));
  models::OperatorCommand command;
  const auto answer = [&](OperatorAction action, const std::string& robot) {
    command.action = action;
    command.robot = robot;
    return core.obey_at_once(command);
  };
  EXPECT_EQ(answer(OperatorAction::kHeartbeat, ""), CommandVerdict::kObeyed);
  EXPECT_EQ(answer(OperatorAction::kHeartbeat, "Q1"), CommandVerdict::kObeyed);
  EXPECT_EQ(answer(OperatorAction::kEmergencyStop, "Q2"), CommandVerdict::kNotForUs);
  EXPECT_FALSE(core.emergency_stop);
  for (const OperatorAction action :
       {OperatorAction::kArm, OperatorAction::kTakeOff, OperatorAction::kFollow,
        OperatorAction::kHold, OperatorAction::kLand}) {
    EXPECT_EQ(answer(action, ""), std::nullopt) << static_cast<int>(action);
  }
  EXPECT_FALSE(core.emergency_stop);
  EXPECT_EQ(answer(OperatorAction::kEmergencyStop, ""), CommandVerdict::kObeyed);
  EXPECT_TRUE(core.emergency_stop);
  EXPECT_FALSE(core.request);
}

}  // namespace
}  // namespace vantage::drivers
