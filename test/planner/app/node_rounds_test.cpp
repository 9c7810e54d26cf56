#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/external_channels.hpp"
#include "planner/app/replay_node.hpp"
#include "scenario/node_budget.hpp"
#include "test/planner/app/node_fixture.hpp"
#include "test/support/sent_ref.hpp"

// Tests of the times at which a planner node works, the inputs that its plans name, and its
// counters.

namespace vantage::planner {
namespace {

using namespace std::chrono_literals;
using models::InputRef;
using test::PlannerNodeTest;
using vantage::test::sent_ref;

bool names_channel(const models::RobotPlan& plan, const std::string& channel) {
  return std::any_of(plan.inputs.begin(), plan.inputs.end(),
                     [&](const InputRef& input) { return input.channel == channel; });
}

scenario::Scenario team_that_agrees() {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.team_algorithm = scenario::TeamAlgorithm::kLocalSearch;
  scenario.planner.candidates_max = 20;
  return scenario;
}

TEST(NamesOf, ListsTheInputsInAFixedOrder) {
  PlanInputs inputs;
  EXPECT_TRUE(names_of(inputs, "Q1").empty());
  inputs.slot.round = 7;
  const auto stamp = [](std::int64_t i) { return models::Stamp{{}, 10 * i, 10 * i + 1}; };
  inputs.belief.emplace().stamp = stamp(1);
  inputs.mixture.emplace().stamp = stamp(2);
  inputs.map.emplace().stamp = stamp(3);
  inputs.mocap.emplace().stamp = stamp(4);
  inputs.own_plan.emplace().stamp = stamp(5);
  inputs.team_plans["Q2"].stamp = stamp(6);
  inputs.team_plans["Q3"].stamp = stamp(7);
  inputs.team_statuses["Q2"].stamp = stamp(8);
  for (const auto& [robot, round] : {std::pair("Q1", 7), {"Q2", 6}, {"Q3", 8}, {"Q4", 7}}) {
    models::PlanProposal& proposal = inputs.proposals[robot];
    proposal.stamp = stamp(robot == std::string("Q1") ? 9 : 10);
    proposal.plan.round = round;
  }
  models::TeamProposal& solution = inputs.solution.emplace();
  solution.robot = "Q5";
  solution.stamp = stamp(11);
  models::RobotPlan& answer = inputs.answer.emplace();
  answer.stamp = stamp(12);
  inputs.attack.emplace().stamp = stamp(13);
  const std::vector<InputRef> all = {{"BELIEF_Q1", 10, 11},
                                     {"MIXTURE_Q1", 20, 21},
                                     {"MAP_Q1", 30, 31},
                                     {"VICON", 40, 41},
                                     {"PLAN_Q1", 50, 51},
                                     {"PLAN_Q2", 60, 61},
                                     {"PLAN_Q3", 70, 71},
                                     {"VEHICLE_Q2", 80, 81},
                                     {"PROPOSAL_Q1", 90, 91},
                                     {"PROPOSAL_Q4", 100, 101},
                                     {"TEAM_PROPOSAL_Q5", 110, 111},
                                     {"EXTERNAL_PLAN_Q1", 120, 121},
                                     {"ATTACK", 130, 131}};
  for (const bool has_solution : {false, true}) {
    for (const bool has_answer : {false, true}) {
      solution.round = has_solution ? 7 : 6;
      answer.round = has_answer ? 7 : 8;
      std::vector<InputRef> expected = all;
      std::erase_if(expected, [&](const InputRef& each) {
        return (!has_solution && each.channel == "TEAM_PROPOSAL_Q5") ||
               (!has_answer && each.channel == "EXTERNAL_PLAN_Q1");
      });
      EXPECT_EQ(names_of(inputs, "Q1"), expected);
    }
  }
}

/// A team that expects an attack. One slot is a sixth of the team's planning budget.
class PlannerNodeClosing : public PlannerNodeTest, public testing::WithParamInterface<double> {};

INSTANTIATE_TEST_SUITE_P(Budgets, PlannerNodeClosing, testing::Values(0.06, 0.48, 0.9));

TEST_P(PlannerNodeClosing, ReservesAFifthOfTheSlotButAtMost20Ms) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.attacks_max = 1;
  scenario.planner.team_budget_s = GetParam();
  start(scenario);
  std::vector<models::PlanProposal> proposals;
  world_.subscribe<models::PlanProposal>(bus::proposal_channel("Q1"),
                                         [&](const auto& each) { proposals.push_back(each); });
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  round();
  const Duration slot = from_seconds(GetParam() / 6.0);
  ASSERT_EQ(proposals.size(), 1U);
  ASSERT_EQ(plans_.size(), 1U);
  for (const models::RobotPlan& plan : {proposals[0].plan, plans_[0]}) {
    EXPECT_EQ(plan.deadline - plan.slot_start, slot);
    EXPECT_EQ(plan.deadline - plan.finish, std::min<Duration>(20ms, slot / 5));
    EXPECT_FALSE(plan.late);
  }
}

TEST_F(PlannerNodeTest, NamesItsOwnPlanAndProposalAsInputs) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.attacks_max = 1;
  start(scenario);
  std::vector<models::PlanProposal> proposals;
  world_.subscribe<models::PlanProposal>(bus::proposal_channel("Q1"),
                                         [&](const auto& each) { proposals.push_back(each); });
  const InputRef belief = sent_ref(world_, bus::belief_channel("Q1"), *inputs_.belief);
  const InputRef mocap{"VICON", 100, 0};
  for (std::int64_t k = 0; k < 3; ++k) {
    round();
    inputs_.slot.activation += 1s;
    std::vector<InputRef> names = {belief, mocap};
    if (k > 0) {
      names.push_back({"PLAN_Q1", 1, k - 1});
    }
    ASSERT_EQ(proposals.size(), static_cast<std::size_t>(k) + 1);
    EXPECT_EQ(proposals.back().plan.inputs, names);
    names.push_back({"PROPOSAL_Q1", 1, k});
    EXPECT_EQ(plans_.back().inputs, names);
  }
  EXPECT_EQ(count("bait_rounds"), 3) << "only this robot gains information";
  EXPECT_EQ(node_->deadlines_missed(), 0);
}

// The planner may begin to plan until the last microsecond of its slot. After that it waits for the
// next slot.
TEST_F(PlannerNodeTest, SkipsOnlyMissedSlots) {
  start(test::lab_scenario());
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  const RoundSchedule schedule(scenario_.planner, 0, 3);
  const std::int64_t first = inputs_.slot.round;
  std::int64_t skipped = 0;
  std::size_t planned = 0;
  for (std::int64_t k = 0; k < 6; ++k) {
    const RoundSchedule::Slot slot = schedule.slot(first + k);
    const bool is_skipped = k % 3 == 1;
    EXPECT_EQ(node_->next_tick(), slot.begin);
    clock_.set(is_skipped ? slot.end : slot.end - 1us);
    node_->tick(clock_.now());
    deliver();
    skipped += is_skipped ? 1 : 0;
    planned += is_skipped ? 0 : 1;
    EXPECT_EQ(plans_.size(), planned);
    EXPECT_EQ(count("slots_skipped"), skipped);
    EXPECT_EQ(count("plans_late"), skipped);
    EXPECT_EQ(node_->deadlines_missed(), skipped);
  }
  clock_.set(schedule.slot(first + 9).begin);
  node_->tick(clock_.now());
  EXPECT_EQ(node_->next_tick(), schedule.slot(first + 10).begin) << "slots are skipped no longer";
}

TEST_F(PlannerNodeTest, DoesNothingBeforeItsSlot) {
  start(test::lab_scenario());
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  for (int k = 0; k < 2; ++k) {
    node_->tick(inputs_.slot.begin - 1us);
    deliver();
    EXPECT_TRUE(plans_.empty());
    EXPECT_EQ(node_->next_tick(), inputs_.slot.begin);
  }
  EXPECT_EQ(node_->name(), "PLANNER_Q1");
}

TEST_F(PlannerNodeTest, AcceptsPlansThatStartWithinFourHorizons) {
  start(test::lab_scenario());
  const Duration most = from_seconds(4.0 * 12 * 0.5);
  for (const auto& [ahead, unusable] :
       {std::pair(-most, 0), {most, 0}, {most + 1us, 1}, {most, 1}, {2 * most, 2}}) {
    models::RobotPlan plan = plan_of("Q2");
    plan.stamp.time = plan.trajectory.start_time = clock_.now() + ahead;
    world_.publish(bus::plan_channel("Q2"), plan);
    deliver();
    EXPECT_EQ(count("unusable_plans"), unusable);
  }
}

TEST_F(PlannerNodeTest, UsesNodeBudgetWithAnyClock) {
  scenario::Scenario scenario = test::lab_scenario();
  start(scenario);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  round();
  ASSERT_EQ(plans_.size(), 1U);
  const auto expected = [&](std::int64_t nodes) {
    RobotPlanner planner(scenario, "Q1");
    return *planner.plan(inputs_, Deadline::nodes(nodes));
  };
  EXPECT_TRUE(is_same_decision(plans_[0], expected(1'500)));
  EXPECT_EQ(plans_[0].nodes, expected(1'500).nodes);
}

TEST_F(PlannerNodeTest, PlansWithTheDefaultBudgetInVirtualTime) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.node_budget = 0;
  scenario.planner.horizon_steps = 6;
  start(scenario);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  round();
  ASSERT_EQ(plans_.size(), 1U);
  RobotPlanner planner(scenario, "Q1");
  const auto expected = planner.plan(inputs_, Deadline::nodes(scenario::kDefaultNodeBudget));
  EXPECT_TRUE(is_same_decision(plans_[0], *expected));
  EXPECT_EQ(plans_[0].nodes, expected->nodes);
}

// The messages of a robot that leaves the neighbourhood are dropped; those of a robot that enters
// it are used.
TEST_F(PlannerNodeTest, UsesMessagesOfNeighboursOnly) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.network.neighbourhood_m = 3.5;
  start(scenario);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  for (const bool is_near : {true, false, true, false}) {
    inputs_.mocap->stamp.time += 1s;
    inputs_.mocap->bodies[1].world_from_body.translation_m.x() =
        is_near ? 0.0 : 1.0;  // Q1 is at −3 m
    world_.publish(bus::kVicon, *inputs_.mocap);
    deliver();
    for (const char* const robot : {"Q2", "Q3"}) {
      if (is_near || robot == std::string("Q3")) {
        world_.publish(bus::plan_channel(robot), plan_of(robot));
        models::VehicleStatus status;
        status.robot = robot;
        world_.publish(bus::vehicle_channel(robot), status);
      }
    }
    round();
    inputs_.slot.activation += 1s;
    ++inputs_.slot.round;
    EXPECT_EQ(names_channel(plans_.back(), "PLAN_Q2"), is_near);
    EXPECT_EQ(names_channel(plans_.back(), "VEHICLE_Q2"), is_near);
    EXPECT_FALSE(names_channel(plans_.back(), "PLAN_Q3"));
    EXPECT_FALSE(names_channel(plans_.back(), "VEHICLE_Q3"));
  }
}

// A planner ignores messages that its team does not use: proposals, maps, external answers.
TEST_F(PlannerNodeTest, IgnoresUnusedMessageKinds) {
  start(test::lab_scenario());
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  world_.publish(bus::proposal_channel("Q2"),
                 models::PlanProposal{{inputs_.slot.activation, 0, 0}, 1.0, plan_of("Q2")});
  world_.publish(bus::external_plan_channel("Q1"), plan_of("Q1"));
  models::TeamProposal proposal;
  proposal.robot = "Q2";
  proposal.round = inputs_.slot.round;
  proposal.stamp.time = inputs_.slot.activation;
  proposal.value_nats = 1.0;
  proposal.history = {1};
  world_.publish(bus::team_proposal_channel("Q2"), proposal);
  models::RobotMap map;
  map.robot = "Q1";
  map.grid = {{-4.0, -2.0}, 1.0, 8, 4};
  map.own_looks.assign(32, 0);
  map.team_looks = map.own_looks;
  world_.publish(bus::map_channel("Q1"), map);
  round();
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(plans_[0].inputs, (std::vector<InputRef>{{"BELIEF_Q1", 100, 0}, {"VICON", 100, 0}}));
  for (const char* const counter : {"external_late", "external_unasked", "misaddressed",
                                    "proposals_refused", "unusable_maps"}) {
    EXPECT_EQ(count(counter), 0) << counter;
  }
}

TEST_F(PlannerNodeTest, PublishesItsCountersByName) {
  const std::vector<std::string> names = {
      "plans_late",         "slots_skipped",       "rounds_short_of_processor",
      "fallbacks_shifted",  "fallbacks_braking",   "off_plan",
      "turns_away",         "bait_rounds",         "rest_rounds",
      "plan_checks_failed", "rounds_without_pose", "rounds_of_unknown_plan",
      "misaddressed",       "unusable_beliefs",    "unusable_maps",
      "unusable_plans",     "proposals_refused",   "external_rounds",
      "external_missing",   "external_late",       "external_unasked",
      "external_refused"};
  start(test::lab_scenario());
  std::vector<std::string> counted;
  for (const models::NamedCount& each : node_->counters()) {
    counted.push_back(each.name);
    EXPECT_EQ(each.count, 0) << each.name;
  }
  EXPECT_EQ(counted, names);
}

// If two robots share a slot, the one with the lower index keeps it. The other yields, and then
// moves to a slot of its own.
TEST_F(PlannerNodeTest, YieldsSlotToRobotWithLowerIndex) {
  scenario::Scenario scenario = test::lab_scenario();
  std::swap(scenario.robots[0].name, scenario.robots[2].name);  // Q1 becomes the third robot
  scenario.planner.slots = 2;
  start(scenario);
  const RoundSchedule schedule(scenario.planner, 2, 3);
  ASSERT_EQ(schedule.first_slot_index(), 0);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  for (std::int64_t k = 0; k < 4; ++k) {
    models::RobotPlan lower = plan_of("Q3");
    lower.round = inputs_.slot.round;
    lower.slot_start = schedule.slot(lower.round, 0).begin;
    world_.publish(bus::plan_channel("Q3"), lower);
    deliver();
    EXPECT_EQ(node_->next_tick(), schedule.slot(inputs_.slot.round, k == 0 ? 0 : 1).begin) << k;
    round();
    inputs_.slot.activation += 1s;
    ++inputs_.slot.round;
  }
  EXPECT_EQ(plans_.size(), 4U);
  EXPECT_EQ(node_->counters().back().name, "yielded_rounds");
  EXPECT_EQ(count("yielded_rounds"), 2)
      << "in the slot of the other robot and in its own first slot";
}

// ---- A team that solves its problem jointly ----

// The node ticks every 5 ms in the first half of the budget, which lasts 250 ms. In the last 20 ms
// of this half the node only waits for the last proposals.
TEST_F(PlannerNodeTest, PollsProposalsEveryFiveMilliseconds) {
  start(team_that_agrees());
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  const RoundSchedule schedule(scenario_.planner, 0, 3);
  for (int k = 0; k < 2; ++k) {
    std::vector<Duration> ticks;
    const Time begin = schedule.proposal_slot(inputs_.slot.round + k).begin;
    while (node_->next_tick() < begin + 900ms) {
      clock_.set(node_->next_tick());
      node_->tick(clock_.now());
      deliver();
      ticks.push_back(clock_.now() - begin);
    }
    std::vector<Duration> expected;
    for (Duration at = 0ms; at <= 230ms; at += 5ms) {
      expected.push_back(at);
    }
    expected.push_back(250ms);  // the tick that computes the plan
    EXPECT_EQ(ticks, expected);
  }
}

TEST_F(PlannerNodeTest, NamesInputsOfProposalAndTheProposalItImproves) {
  start(team_that_agrees());
  std::vector<models::TeamProposal> proposals;
  world_.subscribe<models::TeamProposal>(bus::team_proposal_channel("Q1"),
                                         [&](const auto& each) { proposals.push_back(each); });
  const InputRef belief = sent_ref(world_, bus::belief_channel("Q1"), *inputs_.belief);
  std::size_t before = 0;
  for (std::int64_t k = 0; k < 2; ++k) {
    round();
    inputs_.slot.activation += 1s;
    ASSERT_GT(proposals.size(), before) << k;
    std::vector<InputRef> names = {belief, {"VICON", 100, 0}};
    if (k > 0) {
      names.push_back({"PLAN_Q1", 1, k - 1});
    }
    for (std::size_t i = before; i < proposals.size(); ++i) {
      std::vector<InputRef> with_base = names;
      if (i > before) {
        with_base.push_back({"TEAM_PROPOSAL_Q1", 1, static_cast<std::int64_t>(i) - 1});
      }
      EXPECT_EQ(proposals[i].inputs, with_base) << k << " " << i;
    }
    before = proposals.size();
    EXPECT_EQ(plans_.back().inputs.back(),
              (InputRef{"TEAM_PROPOSAL_Q1", 1, static_cast<std::int64_t>(before) - 1}));
    EXPECT_EQ(plans_.back().source, models::PlanSource::kSearched);
  }
}

TEST_F(PlannerNodeTest, CountsInvalidProposals) {
  start(team_that_agrees());
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  models::TeamProposal bad;
  bad.robot = "Q2";
  bad.round = inputs_.slot.round;
  bad.stamp.time = inputs_.slot.activation;
  bad.value_nats = 1.0;
  bad.history = {1};
  const auto refused_after = [&](const models::TeamProposal& each) {
    world_.publish(bus::team_proposal_channel("Q2"), each);
    deliver();
    return count("proposals_refused");
  };
  EXPECT_EQ(refused_after(bad), 0) << "not evaluated yet";
  clock_.set(node_->next_tick());
  node_->tick(clock_.now());
  EXPECT_EQ(count("proposals_refused"), 1);
  EXPECT_EQ(refused_after(bad), 2);
  models::TeamProposal other = bad;
  ++other.round;
  EXPECT_EQ(refused_after(other), 2) << "another round";
  EXPECT_EQ(refused_after(bad), 3);
  other = bad;
  other.robot = "Q3";
  EXPECT_EQ(refused_after(other), 3);
  EXPECT_EQ(count("misaddressed"), 1);
}

}  // namespace
}  // namespace vantage::planner
