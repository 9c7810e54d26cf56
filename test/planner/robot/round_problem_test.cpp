#include "planner/robot/round_problem.hpp"

#include <gtest/gtest.h>

#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

// Its noise grows with the steps that a target has not been seen: until the plan begins, not only
// until the belief was made.
TEST(ProblemOfRound, PlansWithTheNoiseOfTargetsAsLongUnseenAsTheyAreThen) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.estimator.target_model = {models::TargetKind::kGrowingUncertainty, 2, 0.1};
  scenario.planner.step_s = 0.5;
  PlanInputs inputs = test::first_inputs(scenario, 0, 1);
  inputs.belief->stamp.time = inputs.slot.activation - from_seconds(1.2);
  inputs.belief->targets.resize(2);
  inputs.belief->targets[0].last_seen = inputs.belief->stamp.time - from_seconds(0.9);
  inputs.belief->targets[1].last_seen = inputs.belief->stamp.time;
  Workspace workspace(scenario);
  models::Trajectory committed;
  committed.start_time = inputs.slot.activation;
  committed.start = scenario.robots[0].start;
  const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
  ASSERT_GE(round.search.targets.size(), 2U);
  const double whole_steps[] = {4.0, 2.0};  // of 2.1 s and of 1.2 s
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(round.search.targets[m].model.kind, models::TargetKind::kRandomWalk);
    EXPECT_NEAR(round.search.targets[m].model.q, 0.1 * whole_steps[m] / 0.5, 1e-12) << m;
  }
}

}  // namespace
}  // namespace vantage::planner
