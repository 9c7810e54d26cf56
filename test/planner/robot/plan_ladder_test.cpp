#include "planner/robot/plan_ladder.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/infinity.hpp"
#include "planner/robot/closing_check.hpp"
#include "planner/robot/trajectory_tools.hpp"

namespace vantage::planner {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// Fixture with a robot of radius 0.3 m that drives at 1 m/s towards a wall and may brake at 2
/// m/s².
class Ladder : public ::testing::Test {
 protected:
  Ladder() {
    world_.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
    problem_.start_time = kStart;
    problem_.start_speed_mps = 1.0;
    problem_.height_m = 1.5;
    problem_.controls = {{1.0, 0.0}, {0.5, 1.0}};
    problem_.step_s = 0.5;
    problem_.world = &world_;
    problem_.clearance_m = 0.3;
    problem_.separation_m = 1.0;
    problem_.brake_mps2 = 2.0;
    blank_.robot = "Q7";
    blank_.cost = 77.0;
    blank_.lower_bound = 66.0;
  }

  // Starts the fallbacks for a robot that is `ahead_m` before the wall.
  PlanLadder begin(double ahead_m) {
    problem_.start = {10.0 - ahead_m, 0.0, 0.0};
    committed_ = hover_at(problem_.start, problem_.height_m, kStart);
    committed_.segments = {{{1.0, 0.0}, 1.0, 0.0}, {{1.0, 0.0}, 0.5, 2.0}};  // 1.25 m long
    counts_ = {};
    return {problem_, committed_, blank_, counts_};
  }
  void expect_counts(std::int64_t checks_failed, std::int64_t rests, std::int64_t turns_away,
                     std::int64_t shifted, std::int64_t braking) const {
    EXPECT_EQ(counts_.checks_failed, checks_failed);
    EXPECT_EQ(counts_.rest_rounds, rests);
    EXPECT_EQ(counts_.turns_away, turns_away);
    EXPECT_EQ(counts_.fallbacks_shifted, shifted);
    EXPECT_EQ(counts_.fallbacks_braking, braking);
  }

  models::World world_;
  SearchProblem problem_;
  models::Trajectory committed_;
  models::RobotPlan blank_;
  PlannerCounts counts_;
};

Pose2 end_of(const models::RobotPlan& plan) {
  return models::at(plan.trajectory, Time::max()).world_from_body;
}

TEST(BlankPlan, HasNoMotionOrCertificate) {
  scenario::PlannerSpec planner;
  planner.horizon_steps = 7;
  planner.step_s = 0.4;
  RoundSchedule::Slot slot;
  slot.round = 12;
  slot.begin = kStart;
  slot.end = kStart + Duration{10};
  slot.activation = kStart + Duration{300};
  const models::RobotPlan plan = blank_plan(planner, "Q3", slot);
  EXPECT_EQ(plan.stamp.time, slot.activation);
  EXPECT_EQ(plan.robot, "Q3");
  EXPECT_EQ(plan.round, 12);
  EXPECT_EQ(plan.horizon_steps, 7);
  EXPECT_EQ(plan.step_s, 0.4);
  EXPECT_TRUE(std::isnan(plan.cost));
  EXPECT_EQ(plan.lower_bound, -kInfinity);
  EXPECT_EQ(plan.epsilon, kInfinity);
  EXPECT_EQ(plan.delta_m, kInfinity);
  EXPECT_EQ(plan.slot_start, slot.begin);
  EXPECT_EQ(plan.deadline, slot.end);
  EXPECT_TRUE(plan.trajectory.segments.empty());
}

// The plan contains the certificate of the search. A plan that is too near to a wall is refused.
TEST_F(Ladder, UsesTheSearchResultIfSafe) {
  SearchResult result;
  result.controls = {0, 1};
  result.cost = 1.0;
  result.lower_bound = 2.0;
  result.epsilon = 3.0;
  result.delta_m = 4.0;
  result.passes = 5;
  {
    PlanLadder ladder = begin(5.0);
    EXPECT_FALSE(ladder.searched(result)) << "no plan was found";
    result.found = true;
    const auto silent = ladder.searched(result);
    ASSERT_TRUE(silent);
    EXPECT_EQ(silent->nodes, 0);
    ladder.set_nodes(99);
    const auto plan = ladder.searched(result);
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->source, models::PlanSource::kSearched);
    EXPECT_EQ(plan->robot, "Q7");
    EXPECT_EQ(plan->nodes, 99);
    EXPECT_EQ(plan->cost, 1.0);
    EXPECT_EQ(plan->lower_bound, 2.0);
    EXPECT_EQ(plan->epsilon, 3.0);
    EXPECT_EQ(plan->delta_m, 4.0);
    EXPECT_EQ(plan->passes, 5);
    EXPECT_EQ(plan->trajectory.segments.size(), 3U);
    expect_counts(0, 0, 0, 0, 0);
    const auto chosen = ladder.chosen(plan->trajectory);
    ASSERT_TRUE(chosen);
    EXPECT_EQ(chosen->source, models::PlanSource::kSearched);
    EXPECT_EQ(chosen->cost, 77.0) << "the plan was not searched";
  }
  PlanLadder ladder = begin(0.7);
  EXPECT_FALSE(ladder.searched(result));
  expect_counts(1, 0, 0, 0, 0);
  EXPECT_FALSE(ladder.chosen(to_trajectory(problem_, result)));
  expect_counts(2, 0, 0, 0, 0);
}

// A proposal is used only if it was searched and is still safe. The plan keeps its certificate.
TEST_F(Ladder, UsesItsProposalIfSearchedAndSafe) {
  models::RobotPlan proposal;
  proposal.source = models::PlanSource::kSearched;
  proposal.cost = -3.0;
  proposal.lower_bound = -4.0;
  proposal.epsilon = 0.5;
  proposal.delta_m = 0.25;
  proposal.passes = 2;
  proposal.nodes = 1234;
  {
    const PlanLadder ladder = begin(5.0);
    proposal.trajectory = committed_;
    const auto plan = ladder.proposed(proposal);
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->cost, -3.0);
    EXPECT_EQ(plan->lower_bound, -4.0);
    EXPECT_EQ(plan->epsilon, 0.5);
    EXPECT_EQ(plan->delta_m, 0.25);
    EXPECT_EQ(plan->passes, 2);
    EXPECT_EQ(plan->nodes, 0) << "no search was needed";
    EXPECT_EQ(plan->robot, "Q7");
    EXPECT_EQ(plan->source, models::PlanSource::kSearched);
    for (const auto source : {models::PlanSource::kShifted, models::PlanSource::kBraking}) {
      proposal.source = source;
      EXPECT_FALSE(ladder.proposed(proposal));
    }
  }
  const PlanLadder ladder = begin(0.7);
  proposal.source = models::PlanSource::kSearched;
  proposal.trajectory = committed_;
  EXPECT_FALSE(ladder.proposed(proposal));
  expect_counts(0, 0, 0, 0, 0);
}

// The robot stops within v² / 2a = 0.25 m. If the wall is nearer, the last fallback still gives a
// plan.
TEST_F(Ladder, HoversIfSafeAndAlwaysHasAFallback) {
  {
    PlanLadder ladder = begin(5.0);
    const auto rest = ladder.hovering();
    ASSERT_TRUE(rest);
    EXPECT_EQ(rest->source, models::PlanSource::kSearched);
    EXPECT_NEAR(end_of(*rest).x_m, 5.25, 1e-12);
    EXPECT_EQ(rest->trajectory.height_m, 1.5);
    expect_counts(0, 1, 0, 0, 0);
    const models::RobotPlan shifted = ladder.fall_back();
    EXPECT_EQ(shifted.source, models::PlanSource::kShifted);
    EXPECT_NEAR(end_of(shifted).x_m, 6.25, 1e-12);
    expect_counts(0, 1, 0, 1, 0);
    const models::RobotPlan turned = ladder.turned(hover_at(problem_.start, 1.5, kStart));
    EXPECT_EQ(turned.source, models::PlanSource::kBraking);
    EXPECT_EQ(end_of(turned), problem_.start);
    expect_counts(0, 1, 1, 1, 0);
  }
  {
    PlanLadder ladder = begin(0.7);
    EXPECT_TRUE(ladder.hovering());
    const models::RobotPlan braking = ladder.fall_back();
    EXPECT_EQ(braking.source, models::PlanSource::kBraking);
    EXPECT_NEAR(end_of(braking).x_m, 9.55, 1e-12);
    expect_counts(0, 1, 0, 0, 1);
  }
  PlanLadder ladder = begin(0.4);
  EXPECT_FALSE(ladder.hovering());
  EXPECT_EQ(ladder.fall_back().source, models::PlanSource::kBraking);
  expect_counts(0, 1, 0, 0, 1);
}

// A planner that gets no processor time brakes if that is safe. If a teammate passes the stop
// position, the planner continues the last plan.
TEST_F(Ladder, StopsImmediatelyIfSafe) {
  {
    PlanLadder ladder = begin(5.0);
    const models::RobotPlan stopped = ladder.stopped();
    EXPECT_EQ(stopped.source, models::PlanSource::kBraking);
    EXPECT_NEAR(end_of(stopped).x_m, 5.25, 1e-12);
    expect_counts(0, 0, 0, 0, 1);
  }
  PlanLadder ladder = begin(5.0);
  const Pose2 crossing{5.25, -6.0, kPi / 2.0};
  models::Trajectory teammate = hover_at(crossing, problem_.height_m, kStart);
  teammate.segments = {{{1.0, 0.0}, 12.0, 0.0}};
  problem_.teammates = {teammate};
  const models::RobotPlan shifted = ladder.stopped();
  EXPECT_EQ(shifted.source, models::PlanSource::kShifted);
  EXPECT_NEAR(end_of(shifted).x_m, 6.25, 1e-12);
  expect_counts(0, 0, 0, 1, 0);
}

// The result is the nearest teammate within the required separation, at any index, or none if all
// are farther away.
TEST(TooNear, ReturnsTheNearestTeammate) {
  SearchProblem problem;
  problem.start_time = kStart;
  problem.start = {1.0, 2.0, 0.0};
  problem.height_m = 1.0;
  problem.separation_m = 1.0;
  const auto place = [&](double ahead_m, double up_m) {
    return hover_at({1.0 + ahead_m, 2.0, 0.0}, 1.0 + up_m, kStart);
  };
  EXPECT_EQ(nearest_violating_teammate(problem), std::nullopt);
  problem.teammates = {place(1.02, 0.0), place(-5.0, 0.0), place(0.0, 1.02)};
  EXPECT_EQ(nearest_violating_teammate(problem), std::nullopt);
  problem.separation_from_above = true;
  EXPECT_EQ(nearest_violating_teammate(problem), 2U);
  problem.separation_from_above = false;
  problem.teammates = {place(0.8, 0.0), place(0.5, 0.0), place(0.3, 0.6), place(3.0, 0.0)};
  EXPECT_EQ(nearest_violating_teammate(problem), 1U);
  problem.teammates[1] = place(3.0, 0.0);
  EXPECT_EQ(nearest_violating_teammate(problem), 2U);
  problem.teammates[2] = place(0.6, 0.6);
  EXPECT_EQ(nearest_violating_teammate(problem), 0U);
}

// Each teammate must have at least the required separation minus the given rounding. If the
// separation applies from above, heights have no effect.
TEST(KeepsApart, RequiresSeparationFromEachTeammate) {
  SearchProblem problem;
  problem.start_time = kStart;
  problem.separation_m = 1.0;
  models::Trajectory motion = hover_at({0.0, 0.0, 0.0}, 0.0, kStart);
  motion.segments = {{{1.0, 0.0}, 2.0, 0.0}, {{1.0, 0.0}, 0.5, 2.0}};  // ends at x = 2.25
  for (const std::size_t which : {0U, 2U}) {
    problem.teammates.assign(3, hover_at({9.0, 9.0, 0.0}, 0.0, kStart));
    for (const double rounding_m : {0.0, 0.02}) {
      for (const double hair_m : {-1e-5, 1e-5}) {
        problem.teammates[which] = hover_at({3.25 - rounding_m - hair_m, 0.0, 0.0}, 0.0, kStart);
        EXPECT_EQ(keeps_apart(problem, motion, rounding_m), hair_m < 0.0)
            << which << ' ' << rounding_m << ' ' << hair_m;
      }
    }
    problem.teammates[which] = hover_at({3.15, 0.0, 0.0}, 0.6, kStart);  // 1.08 m in space
    EXPECT_TRUE(keeps_apart(problem, motion, 0.0));
    problem.separation_from_above = true;
    EXPECT_FALSE(keeps_apart(problem, motion, 0.0));
    problem.separation_from_above = false;
  }
}

// The clearance to walls and the separation may be violated by up to two centimetres.
TEST(IsSafe, AllowsViolationsOfUpToTwoCentimetres) {
  models::World world;
  world.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
  SearchProblem problem;
  problem.start_time = kStart;
  problem.world = &world;
  problem.clearance_m = 0.5;
  problem.separation_m = 1.0;
  for (const double nearer_m : {-1e-6, 1e-6}) {
    const double x_m = 10.0 - 0.48 + nearer_m;
    EXPECT_EQ(is_safe(problem, hover_at({x_m, 0.0, 0.0}, 0.0, kStart)), nearer_m < 0.0);
    EXPECT_EQ(is_safe(problem, hover_at({0.0, -x_m, 0.0}, 0.0, kStart)), nearer_m < 0.0);
    SearchProblem beside = problem;
    beside.teammates = {hover_at({0.98 - nearer_m, 0.0, 0.0}, 0.0, kStart)};
    beside.start.x_m = -5.0;  // starts far from the wall
    EXPECT_EQ(is_safe(beside, hover_at({0.0, 0.0, 0.0}, 0.0, kStart)), nearer_m < 0.0);
  }
}

}  // namespace
}  // namespace vantage::planner
