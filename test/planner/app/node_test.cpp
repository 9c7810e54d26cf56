#include "planner/app/node.hpp"

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/planner/app/node_fixture.hpp"
#include "test/support/sent_ref.hpp"

namespace vantage::planner {
namespace {

using namespace std::chrono_literals;
using test::PlannerNodeTest;
using vantage::test::sent_ref;

bool names(const models::RobotPlan& plan, const models::InputRef& input) {
  return std::find(plan.inputs.begin(), plan.inputs.end(), input) != plan.inputs.end();
}

TEST_F(PlannerNodeTest, RefusesMessageWhoseRobotDiffersFromChannel) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.attacks_max = 1;
  start(scenario);
  const auto own = sent_ref(world_, bus::belief_channel("Q1"), *inputs_.belief);
  models::RobotBelief other = *inputs_.belief;
  other.robot = "Q2";
  other.targets.clear();
  world_.publish(bus::belief_channel("Q1"), other);
  const auto mate = sent_ref(world_, bus::plan_channel("Q2"), plan_of("Q2"));
  for (const char* robot : {"Q1", "Q3", "Q9"}) {
    world_.publish(bus::plan_channel("Q2"), plan_of(robot));
  }
  world_.publish(bus::proposal_channel("Q2"),
                 models::PlanProposal{{inputs_.slot.activation, 0, 0}, 1.0, plan_of("Q3")});
  round();
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_TRUE(names(plans_[0], own));
  EXPECT_TRUE(names(plans_[0], mate));
  EXPECT_EQ(plans_[0].inputs.size(), 4U) << "plus the mocap frame and its own proposal";
  EXPECT_EQ(count("misaddressed"), 5);
}

// Attack notices are repeated each second, so an old one must expire. Otherwise a teammate would
// count as jammed for the rest of the flight.
TEST_F(PlannerNodeTest, DropsAttackNoticeAfterThreeSeconds) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.execute_steps = 2;  // one round lasts 1 s
  start(scenario);
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  const Time notice_time = clock_.now();
  const auto attack =
      sent_ref(world_, bus::kAttack, models::AttackNotice{{notice_time, 0, 0}, {"Q2"}});
  deliver();
  for (int k = 0; k < 6; ++k) {
    round();
    inputs_.slot.activation += 1s;
  }
  int by_attack = 0;
  int without = 0;
  for (const models::RobotPlan& plan : plans_) {
    EXPECT_EQ(names(plan, attack), plan.slot_start <= notice_time + 3s)
        << to_seconds(plan.slot_start - notice_time);
    ++(names(plan, attack) ? by_attack : without);
  }
  EXPECT_GE(by_attack, 2);
  EXPECT_GE(without, 2);
}

TEST_F(PlannerNodeTest, SurvivesInvalidTeammatePlans) {
  const auto spoil = [&](int kind) {
    models::RobotPlan plan = plan_of("Q2");
    std::vector<models::PlanSegment>& segments = plan.trajectory.segments;
    segments = {{{0.5, 0.0}, 1.0, 0.0}};
    switch (kind) {
      case 0:
        segments[0].duration_s = 2e4;
        break;
      case 1:
        segments[0].control.speed_mps = 1e300;
        break;
      case 2:
        segments[0].control.yaw_rate_radps = 1e300;
        break;
      case 3:
        segments.assign(9'000, {{0.5, 0.0}, 0.0, 0.0});
        break;
      case 4:
        plan.trajectory.start.x_m = 1e308;
        break;
      case 5:
        plan.trajectory.height_m = 1e308;
        break;
      case 6:
        segments[0].brake_mps2 = 1e300;
        break;
      default:
        plan.stamp.time += 20'000s;
    }
    return plan;
  };
  start(test::lab_scenario());
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  const auto good = sent_ref(world_, bus::plan_channel("Q2"), plan_of("Q2"));
  for (int kind = 0; kind <= 7; ++kind) {
    world_.publish(bus::plan_channel("Q2"), spoil(kind));
    deliver();
    EXPECT_EQ(count("PLAN_Q2.refused") + count("unusable_plans"), kind + 1);
  }
  ASSERT_NO_THROW(round());
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_TRUE(names(plans_[0], good));
}

TEST_F(PlannerNodeTest, AcceptsAPlanWithALongStop) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.horizon_steps = 1;
  scenario.planner.execute_steps = 1;
  scenario.planner.step_s = 1.0;
  scenario.robots[1].limits.speed_max_mps = 2.0;
  scenario.robots[1].limits.brake_mps2 = 0.5;
  start(scenario);
  models::RobotPlan plan = plan_of("Q2");
  plan.trajectory.segments = {{{2.0, 0.0}, 1.0, 0.0}, models::brake(2.0, 0.5).front()};
  world_.publish(bus::plan_channel("Q2"), plan);
  deliver();
  EXPECT_EQ(count("unusable_plans"), 0);
  plan.trajectory.segments.back().duration_s = 8.0;
  world_.publish(bus::plan_channel("Q2"), plan);
  deliver();
  EXPECT_EQ(count("unusable_plans"), 1);
}

TEST_F(PlannerNodeTest, ContinuesWithoutAnInvalidBelief) {
  const auto plan_on = [&](const models::RobotBelief& belief) {
    RobotPlanner planner(test::lab_scenario(), "Q1");
    PlanInputs inputs = inputs_;
    inputs.belief = belief;
    const auto plan = planner.plan(inputs, Deadline::nodes(200));
    EXPECT_TRUE(plan);
    return planner.counts().unusable_beliefs;
  };
  start(test::lab_scenario());
  models::RobotBelief good = *inputs_.belief;
  EXPECT_EQ(plan_on(good), 1) << "the belief has no grid";
  const models::VisibilityGrid grid(scenario_.world, scenario_.estimator.grid_resolution_m,
                                    scenario_.estimator.grid_memory_s);
  good.grid = grid.geometry();
  good.last_seen_utime.assign(static_cast<std::size_t>(good.grid.size()),
                              models::VisibilityGrid::kNeverSeen);
  EXPECT_EQ(plan_on(good), 0);
  models::RobotBelief belief = good;
  belief.stamp.time += 3600s;
  EXPECT_EQ(plan_on(belief), 5) << "a clock that was ahead";
  belief = good;
  belief.stamp.time -= 3600s * 24 * 365 * 50;
  plan_on(belief);
  for (const double scale : {1e-300, 1e-150, 1e-20, 1e20, 1e150, 1e300}) {
    belief = good;
    belief.targets[0].information.matrix *= scale;
    EXPECT_LE(plan_on(belief), 1) << scale;
    belief.targets[0].information.vector *= scale;
    plan_on(belief);
  }
  belief = good;
  belief.targets[0].information.vector *= 1e300;
  EXPECT_EQ(plan_on(belief), 1);
}

/// A planner node that receives a belief of step 3 and a mixture of any step. `mixtures_named` is
/// the number of mixtures among the inputs that its plan names.
class PlannerNodeWithMixtures : public PlannerNodeTest {
 protected:
  std::int64_t mixtures_named(std::int64_t step_of_mixture) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.estimator.samples = true;
    start(scenario);
    models::BeliefMixture mixture;
    mixture.stamp = inputs_.belief->stamp;
    mixture.robot = "Q1";
    mixture.step = step_of_mixture;
    const models::Gaussian there{Eigen::Vector2d(1.0, 1.0), Eigen::Matrix2d::Identity()};
    mixture.targets.push_back({0, 1.0, {{0.5, there}, {0.5, there}}});
    inputs_.belief->step = 3;
    world_.publish(bus::mixture_channel("Q1"), mixture);
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
    round();
    if (plans_.size() != 1) {
      ADD_FAILURE() << plans_.size() << " plans";
      return -1;
    }
    return std::count_if(plans_[0].inputs.begin(), plans_[0].inputs.end(),
                         [](const auto& input) { return input.channel == "MIXTURE_Q1"; });
  }
};

TEST_F(PlannerNodeWithMixtures, UsesAMixtureThatArrivedBeforeItsBelief) {
  EXPECT_EQ(mixtures_named(3), 1);
}

TEST_F(PlannerNodeWithMixtures, IgnoresMixtureOfAnotherStep) { EXPECT_EQ(mixtures_named(2), 0); }

TEST_F(PlannerNodeTest, CountsUnusableMaps) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.targets.clear();
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  scenario.planner.horizon_steps = 2;
  start(scenario);
  models::RobotMap map;
  map.robot = "Q1";
  map.grid = {{-4.0, -2.0}, 1.0, 8, 4};
  map.own_looks.assign(32, 0);
  map.team_looks = map.own_looks;
  world_.publish(bus::map_channel("Q1"), map);
  map.robot = "Q2";
  world_.publish(bus::map_channel("Q1"), map);
  round();
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(count("unusable_maps"), 1);
  EXPECT_EQ(count("misaddressed"), 1);
}

}  // namespace
}  // namespace vantage::planner
