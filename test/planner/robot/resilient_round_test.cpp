#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

using test::first_inputs;

TEST(RoundSchedule, ReceivesAllProposalsBeforeTheFirstPlan) {
  scenario::PlannerSpec spec;
  spec.attacks_max = 2;
  const int robots = 5;
  std::optional<Time> last_end;
  for (const bool is_proposal : {true, false}) {
    for (int i = 0; i < robots; ++i) {
      const RoundSchedule schedule(spec, i, robots);
      const auto slot = is_proposal ? schedule.proposal_slot(9) : schedule.slot(9);
      EXPECT_EQ(slot.is_proposal, is_proposal);
      EXPECT_LT(slot.begin, slot.end);
      EXPECT_EQ(slot.begin, last_end.value_or(slot.begin));
      EXPECT_LE(slot.end, slot.activation - from_seconds(spec.publish_margin_s));
      last_end = slot.end;
      const auto next = schedule.next_slot(slot.begin - Duration{1});
      EXPECT_EQ(next.begin, slot.begin);
      EXPECT_EQ(schedule.next_slot(slot.begin).is_proposal, !is_proposal);
    }
  }
}

// Returns the sum of the information matrix traces of all targets; 0 without information.
double information_sum(const std::vector<std::vector<models::StateMatrix>>& information) {
  double sum = 0.0;
  for (const auto& of_target : information) {
    for (const models::StateMatrix& each : of_target) {
      sum += each.trace();
    }
  }
  return sum;
}

TEST(RobotPlanner, KeepsProposalsOfBaitAndPlansForTheRest) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.attacks_max = 1;
  const Deadline deadline = Deadline::nodes(scenario.planner.node_budget);
  int baits = 0;
  int taken = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::vector<RobotPlanner> planners;
    std::map<std::string, models::PlanProposal> proposals;
    std::string best;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string& name = scenario.robots[i].name;
      planners.emplace_back(scenario, name);
      const auto proposal = planners[i].propose(first_inputs(scenario, i, seed), deadline);
      ASSERT_TRUE(proposal);
      EXPECT_EQ(proposal->stamp.time, first_inputs(scenario, i, seed).slot.activation);
      EXPECT_EQ(information_sum(planners[i].problem().fixed_information), 0.0)
          << "as if no other robot observed";
      proposals[name] = *proposal;
      if (proposal->value_nats > 0.0 &&
          (best.empty() || proposal->value_nats > proposals[best].value_nats)) {
        best = name;
      }
    }
    std::map<std::string, models::RobotPlan> plans;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string& name = scenario.robots[i].name;
      PlanInputs inputs = first_inputs(scenario, i, seed);
      inputs.proposals = proposals;
      inputs.team_plans = plans;
      const auto plan = planners[i].plan(inputs, deadline);
      ASSERT_TRUE(plan);
      if (name == best) {
        ++baits;
        EXPECT_EQ(planners[i].counts().bait_rounds, 1);
        if (i == 0 || plan->nodes == 0) {  // no robot has planned after its proposal
          EXPECT_EQ(plan->cost, proposals[name].plan.cost);
          EXPECT_EQ(plan->nodes, 0);
          ++taken;
        } else {  // a teammate's plan blocks the proposal
          EXPECT_EQ(information_sum(planners[i].problem().fixed_information), 0.0)
              << "searches alone again";
        }
      } else {
        EXPECT_EQ(planners[i].counts().bait_rounds, 0);
        std::vector<FixedTeammate> others;
        for (const scenario::RobotSpec& robot : scenario.robots) {
          if (robot.name == name) {
            continue;
          }
          const auto known = plans.find(robot.name);
          others.push_back({known != plans.end()
                                ? known->second.trajectory
                                : hover_at(robot.start, robot.height_m, inputs.slot.activation),
                            robot.sensor, robot.name == best});
        }
        EXPECT_EQ(information_sum(planners[i].problem().fixed_information),
                  information_sum(fixed_information(planners[i].problem(), others)));
      }
      plans[name] = *plan;
    }
  }
  EXPECT_GE(baits, 15);
  EXPECT_GE(taken, 10);
}

TEST(RobotPlanner, IgnoresProposalsOfOtherRoundsOrWithoutAttack) {
  scenario::Scenario scenario = test::lab_scenario();
  const Deadline deadline = Deadline::nodes(scenario.planner.node_budget);
  for (const int attacks_max : {0, 1}) {
    scenario.planner.attacks_max = attacks_max;
    RobotPlanner planner(scenario, "Q1");
    const auto plain = planner.plan(first_inputs(scenario, 0, 4), deadline);
    auto proposal = planner.propose(first_inputs(scenario, 0, 4), deadline);
    ASSERT_TRUE(plain && proposal);
    proposal->plan.round -= attacks_max;  // if 1: a proposal of the previous round
    PlanInputs inputs = first_inputs(scenario, 0, 4);
    inputs.proposals["Q1"] = *proposal;
    const auto plan = planner.plan(inputs, deadline);
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->cost, plain->cost);
    EXPECT_EQ(plan->nodes, plain->nodes);
    EXPECT_EQ(planner.counts().bait_rounds, 0);
  }
}

}  // namespace
}  // namespace vantage::planner
