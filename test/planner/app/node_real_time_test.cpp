#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planner/app/replay_node.hpp"
#include "test/planner/app/node_fixture.hpp"

// Tests of planner nodes with a real-time clock: the time for which they wait and search, and their
// behaviour when they are late.

namespace vantage::planner {
namespace {

using namespace std::chrono_literals;
using test::PlannerNodeTest;

/// A clock that the node regards as a real-time clock, but that advances only when the test sets
/// it.
class RealClock : public bus::Clock {
 public:
  [[nodiscard]] Time now() const override { return now_; }
  [[nodiscard]] bool is_real_time() const override { return true; }
  void set(Time now) { now_ = now; }

 private:
  Time now_{};
};

// A restarted planner waits for one round plus 350 ms. In that time it receives the status of its
// vehicle and the plans of its teammates.
TEST_F(PlannerNodeTest, WaitsForMessagesBeforePlanningOnlyInRealTime) {
  const scenario::Scenario scenario = test::lab_scenario();
  const RoundSchedule::Slot slot = test::first_inputs(scenario, 0).slot;
  const auto workspace = std::make_shared<Workspace>(scenario);
  const auto first_tick = [&](const bus::Clock& clock) {
    return PlannerNode(robot_bus_, clock, workspace, "Q1").next_tick();
  };
  RealClock real;
  real.set(slot.begin - 1350ms - 1us);
  EXPECT_EQ(first_tick(real), slot.begin);
  real.set(slot.begin - 1350ms);
  EXPECT_EQ(first_tick(real), slot.begin + 1s);
  clock_.set(slot.begin - 1us);
  EXPECT_EQ(first_tick(clock_), slot.begin);
  clock_.set(slot.begin);
  EXPECT_EQ(first_tick(clock_), slot.begin + 1s);
}

// Whenever a planner is started, each teammate has a slot to publish a plan before the first slot
// of this planner. A teammate without a plan would be assumed to hover.
TEST_F(PlannerNodeTest, ReceivesPlanOfEachTeammateBeforeFirstSlot) {
  for (const int attacks : {0, 1}) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.planner.attacks_max = attacks;
    const auto workspace = std::make_shared<Workspace>(scenario);
    const std::int64_t round = test::first_inputs(scenario, 0).slot.round;
    const Time begin = RoundSchedule(scenario.planner, 0, 3).slot(round).activation - 1s;
    for (Duration after = 0ms; after < 1s; after += 10ms) {
      RealClock clock;
      clock.set(begin + after);
      for (int own = 0; own < 3; ++own) {
        const std::string& name = scenario.robots[static_cast<std::size_t>(own)].name;
        const Time first = PlannerNode(robot_bus_, clock, workspace, name).next_tick();
        for (int other = 0; other < 3; ++other) {
          const RoundSchedule schedule(scenario.planner, other, 3);
          std::int64_t next = round;
          while (schedule.slot(next).begin < clock.now()) {
            ++next;
          }
          EXPECT_TRUE(other == own || schedule.slot(next).end <= first)
              << name << " started after " << after.count() << " us has not received " << other;
        }
        EXPECT_LE(first - clock.now(), 2400ms) << "but not longer";
      }
    }
  }
}

// A search that ends after the slot leads to no new plan and no new proposal.
TEST_F(PlannerNodeTest, PublishesNoSearchResultAfterItsSlot) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.attacks_max = 1;
  RealClock clock;
  clock.set(test::first_inputs(scenario, 0).slot.activation - 2s);
  start(scenario, clock);
  std::vector<models::PlanProposal> proposals;
  world_.subscribe<models::PlanProposal>(bus::proposal_channel("Q1"),
                                         [&](const auto& each) { proposals.push_back(each); });
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  const RoundSchedule schedule(scenario.planner, 0, 3);
  std::int64_t late = 0;
  std::size_t proposed = 0;
  for (std::int64_t k = 0; k < 4; ++k) {
    const bool is_late = k % 2 == 1;
    for (const bool is_proposal : {true, false}) {
      const std::int64_t round = inputs_.slot.round + k;
      const RoundSchedule::Slot slot =
          is_proposal ? schedule.proposal_slot(round) : schedule.slot(round);
      ASSERT_EQ(node_->next_tick(), slot.begin);
      clock.set(is_late ? slot.end + 1us : slot.end);
      node_->tick(slot.begin);
      deliver();
      late += is_late ? 1 : 0;
      proposed += is_proposal && !is_late ? 1 : 0;
      EXPECT_EQ(proposals.size(), proposed);
      EXPECT_EQ(node_->deadlines_missed(), late);
      EXPECT_EQ(count("plans_late"), late);
    }
    ASSERT_EQ(plans_.size(), static_cast<std::size_t>(k) + 1);
    EXPECT_EQ(plans_.back().finish, clock.now());
    EXPECT_EQ(plans_.back().late, is_late);
    EXPECT_EQ(plans_.back().source,
              is_late ? models::PlanSource::kShifted : models::PlanSource::kSearched);
  }
  EXPECT_EQ(count("slots_skipped"), 0);
}

/// The parameter is true for a vehicle with a driver.
class OverloadedPlannerNode : public PlannerNodeTest, public ::testing::WithParamInterface<bool> {};

INSTANTIATE_TEST_SUITE_P(WithADriver, OverloadedPlannerNode, ::testing::Bool());

// The planner of a vehicle with a driver brakes if it waited too long for a processor within the
// last second. It searches again when the machine is no longer busy.
TEST_P(OverloadedPlannerNode, PlansAStopWhileItWaitsForAProcessor) {
  struct Row {
    double wait_s;
    bool stops_with_driver;
  };
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[0].device =
      GetParam() ? scenario::DeviceSource::kWire : scenario::DeviceSource::kDirect;
  start(scenario);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  std::int64_t stops = 0;
  for (const Row& row : std::vector<Row>{
           {0.0, false}, {0.2, false}, {0.2001, true}, {0.9, true}, {0.19, false}, {0.5, true}}) {
    SCOPED_TRACE(row.wait_s);
    const bool is_stop = row.stops_with_driver && GetParam();
    node_->on_processor_wait(row.wait_s);
    plans_.clear();
    round();
    inputs_.slot.activation += from_seconds(1.0);
    stops += is_stop ? 1 : 0;
    ASSERT_EQ(plans_.size(), 1U);
    EXPECT_EQ(plans_[0].late, is_stop);
    EXPECT_LE(plans_[0].finish, plans_[0].deadline) << "teammates rely on this time";
    EXPECT_EQ(plans_[0].source,
              is_stop ? models::PlanSource::kBraking : models::PlanSource::kSearched);
    EXPECT_EQ(count("rounds_short_of_processor"), stops);
    EXPECT_EQ(count("plans_late"), 0) << "no plan was late";
  }
}

// A node budget is used in full in real time as well, even if the slot is nearly over.
TEST_F(PlannerNodeTest, UsesNodeBudgetInRealTime) {
  scenario::Scenario scenario = test::lab_scenario();
  RealClock clock;
  clock.set(test::first_inputs(scenario, 0).slot.activation - 2s);
  start(scenario, clock);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  clock.set(inputs_.slot.end - 1us);
  node_->tick(clock.now());
  deliver();
  ASSERT_EQ(plans_.size(), 1U);
  RobotPlanner planner(scenario, "Q1");
  const auto expected = planner.plan(inputs_, Deadline::nodes(1'500));
  EXPECT_TRUE(is_same_decision(plans_[0], *expected));
  EXPECT_EQ(plans_[0].nodes, expected->nodes);
}

// A planner that is woken near the end of its slot still publishes a plan in time, after a short
// search.
TEST_F(PlannerNodeTest, EndsSearchWithItsSlot) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.node_budget = 0;
  RealClock clock;
  clock.set(test::first_inputs(scenario, 0).slot.activation - 2s);
  start(scenario, clock);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  clock.set(inputs_.slot.end - 20ms);
  node_->tick(clock.now());
  deliver();
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_LT(plans_[0].nodes, 100);
}

}  // namespace
}  // namespace vantage::planner
