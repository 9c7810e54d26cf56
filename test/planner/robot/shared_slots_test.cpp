#include "planner/robot/shared_slots.hpp"

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planner/robot/robot_planner.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

/// The three robots Q1, Q2 and Q3 share two slots.
class SharedSlotsTest : public ::testing::Test {
 protected:
  SharedSlotsTest() : scenario_(test::lab_scenario()) { scenario_.planner.slots = 2; }

  [[nodiscard]] RoundSchedule schedule(int robot) const { return {scenario_.planner, robot, 3}; }
  // Returns a plan of the previous round that was made in slot `place`.
  [[nodiscard]] models::RobotPlan plan_of(std::int64_t round, int place) const {
    models::RobotPlan plan;
    plan.round = round - 1;
    plan.slot_start = schedule(0).slot(round - 1, place).begin;
    return plan;
  }
  /// Returns the inputs of `robot` in slot `place` if the last plans were made in slots `places`;
  /// −1: no plan.
  [[nodiscard]] PlanInputs inputs_of(int robot, int place, const std::vector<int>& places) const {
    PlanInputs inputs = test::first_inputs(scenario_, static_cast<std::size_t>(robot));
    inputs.slot = schedule(robot).slot(inputs.slot.round, place);
    for (int i = 0; i < 3; ++i) {
      const int made_in = places[static_cast<std::size_t>(i)];
      if (made_in >= 0 && i == robot) {
        inputs.own_plan = plan_of(inputs.slot.round, made_in);
      } else if (made_in >= 0) {
        inputs.team_plans["Q" + std::to_string(i + 1)] = plan_of(inputs.slot.round, made_in);
      }
    }
    return inputs;
  }

  scenario::Scenario scenario_;
};

struct Case {
  int robot;
  int place;
  std::vector<int> places;
  bool has_slot;
  int next;
};

TEST_F(SharedSlotsTest, BelongToLowestRobotWithAReceivedPlan) {
  const Workspace workspace(scenario_);
  const std::vector<Case> cases = {
      {0, 0, {-1, -1, -1}, false, 0},  // no robot has used the slot
      {1, 1, {-1, -1, -1}, false, 1}, {2, 0, {-1, -1, -1}, false, 0},
      {0, 0, {0, -1, -1}, true, 0},   {1, 1, {-1, 1, -1}, true, 1},
      {2, 0, {-1, -1, 0}, true, 0},   {0, 0, {0, 1, 0}, true, 0},  // Q3 must move away
      {2, 0, {0, 1, 0}, false, 0},                                 // Q3 has no free slot
      {2, 0, {0, -1, 0}, false, 1},                                // Q3 has a free slot
      {2, 0, {0, -1, -1}, false, 1},  {2, 1, {0, -1, 1}, true, 1},
      {2, 1, {0, 1, 1}, false, 1},    {2, 1, {1, -1, 1}, false, 0},
      {0, 0, {0, 0, 0}, true, 0},     {1, 0, {0, 0, 0}, false, 1},
      {0, 0, {1, -1, -1}, false, 1},  // its last plan was made in another slot
      {0, 1, {0, -1, -1}, false, 0},
  };
  for (const Case& each : cases) {
    const SharedSlots slots(workspace, each.robot);
    const PlanInputs inputs = inputs_of(each.robot, each.place, each.places);
    const std::string what = "Q" + std::to_string(each.robot + 1) + " in " +
                             std::to_string(each.place) + " of " +
                             ::testing::PrintToString(each.places);
    EXPECT_EQ(slots.has_slot(inputs), each.has_slot) << what;
    EXPECT_EQ(slots.next_slot_index(inputs), each.next) << what;
  }
}

// A plan outside the slots, or of a robot that the scenario lacks, occupies no slot.
TEST_F(SharedSlotsTest, IgnorePlansOutsideTheSlots) {
  const Workspace workspace(scenario_);
  const SharedSlots slots(workspace, 2);
  PlanInputs inputs = inputs_of(2, 0, {0, -1, 0});
  ASSERT_FALSE(slots.has_slot(inputs));
  const models::RobotPlan right = inputs.team_plans.at("Q1");
  inputs.team_plans.at("Q1").slot_start += Duration{1};
  EXPECT_TRUE(slots.has_slot(inputs));
  EXPECT_EQ(slots.next_slot_index(inputs), 0);
  inputs.team_plans.clear();
  inputs.team_plans["Q9"] = right;
  EXPECT_TRUE(slots.has_slot(inputs));
  inputs.team_plans["Q1"] = right;
  EXPECT_FALSE(slots.has_slot(inputs));
}

// A robot without a slot continues its committed motion, and the yield is counted.
TEST_F(SharedSlotsTest, RobotWithoutASlotContinuesItsMotion) {
  RobotPlanner planner(scenario_, "Q3");
  EXPECT_EQ(planner.robot_index(), 2);
  EXPECT_EQ(planner.robot_count(), 3);
  PlanInputs inputs = inputs_of(2, 0, {-1, -1, -1});
  for (std::int64_t yields = 1; yields <= 2; ++yields) {
    const auto claim = planner.plan(inputs, Deadline::nodes(500));
    ASSERT_TRUE(claim);
    EXPECT_EQ(claim->source, models::PlanSource::kShifted);
    EXPECT_EQ(planner.counts().yielded_rounds, yields);
    EXPECT_EQ(planner.next_slot_index(inputs), 0);
    if (yields == 2) {
      inputs.own_plan = claim;
    }
  }
  inputs.slot = schedule(2).slot(inputs.slot.round + 1, 0);
  const auto plan = planner.plan(inputs, Deadline::nodes(500));
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->source, models::PlanSource::kSearched);
  EXPECT_EQ(planner.counts().yielded_rounds, 2);
  scenario_.planner.slots = 3;  // one per robot
  EXPECT_EQ(RobotPlanner(scenario_, "Q3").next_slot_index(inputs), std::nullopt);
}

TEST(MaySearch, IsTrueForTheLowestRobotIndexOfASlot) {
  const std::vector<SlotHolder> holders = {{3, 0}, {5, 1}, {9, 2}};
  for (int robot = 0; robot < 12; ++robot) {
    for (int slot = 0; slot < 4; ++slot) {
      const bool is_lowest = slot == 3 || robot <= (slot == 0 ? 3 : slot == 1 ? 5 : 9);
      EXPECT_EQ(may_search({robot, slot}, holders), is_lowest) << robot << ' ' << slot;
      // Slots 3, 4 and 5 of six are free. Robots of the same slot that need a new one choose
      // different slots.
      EXPECT_EQ(next_slot({robot, slot}, holders, 6), is_lowest ? slot : 3 + robot % 3);
      EXPECT_EQ(next_slot({robot, slot}, holders, 3), slot) << "no slot is free";
    }
  }
  // Slot numbers outside the range do not count as occupied.
  EXPECT_EQ(next_slot({7, 0}, std::vector<SlotHolder>{{1, 0}, {2, -1}, {3, 2}}, 2), 1);
}

}  // namespace
}  // namespace vantage::planner
