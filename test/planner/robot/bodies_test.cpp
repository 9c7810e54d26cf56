#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planner/robot/round_problem.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"

// Tests the obstacles of a plan in addition to the plans of teammates: bodies other than robots,
// and teammates that are silent or off their plan.

namespace vantage::planner {
namespace {

using models::FlightState;

/// Q1 at (−3, 0), height 1.0 m; Q2 at (0, 0), 1.5 m; Q3 at (3, 0), 2.0 m.
class PlanObstacles : public ::testing::Test {
 protected:
  PlanObstacles() { show_before(0.1); }

  /// Makes the previous frame a copy of the newest one, `before_s` older.
  void show_before(double before_s) {
    inputs.mocap_before = inputs.mocap;
    inputs.mocap_before->stamp.time -= from_seconds(before_s);
  }
  /// Adds a body that is at `p_m` in the newest frame and moves at `velocity_mps` between the two
  /// frames.
  void add(const std::string& name, const Eigen::Vector3d& p_m,
           const Eigen::Vector3d& velocity_mps = Eigen::Vector3d::Zero()) {
    for (auto* frame : {&*inputs.mocap, &*inputs.mocap_before}) {
      const double since_s = to_seconds(inputs.mocap->stamp.time - frame->stamp.time);
      models::MocapBody& body = frame->bodies.emplace_back();
      body.name = name;
      body.world_from_body.translation_m = p_m - since_s * velocity_mps;
    }
  }
  /// Returns the obstacles that the problem has in addition to the motions of the two teammates.
  std::vector<models::Trajectory> others() {
    Workspace workspace(scenario);
    models::Trajectory committed;
    committed.start_time = inputs.slot.activation;
    committed.start = scenario.robots[0].start;
    const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
    dropped = round.bodies_dropped;
    require_valid(round.search);
    EXPECT_EQ(round.teammates.size(), 2U);
    return {round.search.teammates.begin() + 2, round.search.teammates.end()};
  }
  bool is_in_the_way() { return shows_bodies_in_the_way(Workspace(scenario), 0, *inputs.mocap); }
  /// Sets the plan of Q2, a hover at `plan_at`, and its flight state, which its driver reported
  /// `ago_s` before the slot.
  void follows(FlightState state, double ago_s, const Pose2& plan_at) {
    models::VehicleStatus status;
    status.stamp.time = inputs.slot.begin - from_seconds(ago_s);
    status.robot = "Q2";
    status.state = state;
    inputs.team_statuses["Q2"] = status;
    inputs.team_plans["Q2"].trajectory =
        hover_at(plan_at, 1.5, inputs.slot.begin - from_seconds(5.0));
  }

  scenario::Scenario scenario = test::lab_scenario();
  PlanInputs inputs = test::first_inputs(scenario, 0);
  std::int64_t dropped = 0;
};

TEST_F(PlanObstacles, IncludeOtherBodiesAtFlightHeight) {
  struct Case {
    const char* what;
    Eigen::Vector3d at_m;
    bool is_kept_from;
    double height_m;
  };
  const std::vector<Case> cases = {
      {"a rover below", {-1.0, 0.5, 0.1}, false, 0.0},
      {"a rover with a mast", {-1.0, 0.5, 0.39}, false, 0.0},
      {"just too high to fly over", {-1.0, 0.5, 0.41}, true, 0.41},
      {"as high as it flies", {-1.0, 0.5, 1.0}, true, 1.0},
      {"a helmet", {-1.0, 0.5, 1.8}, true, 1.0},
      {"carried by the vehicle", {-3.0, 0.1, 1.1}, false, 0.0},
  };
  for (const Case& each : cases) {
    for (const char* name : {"R1", "PERSON"}) {
      inputs = test::first_inputs(scenario, 0);
      show_before(0.1);
      add(name, each.at_m);
      const auto others = this->others();
      EXPECT_EQ(is_in_the_way(), each.is_kept_from) << each.what;
      ASSERT_EQ(others.size(), each.is_kept_from ? 1U : 0U) << each.what;
      if (each.is_kept_from) {
        EXPECT_LT((others[0].start.position_m() - each.at_m.head<2>()).norm(), 1e-12);
        EXPECT_NEAR(others[0].height_m, each.height_m, 1e-12) << each.what;
        EXPECT_TRUE(others[0].segments.empty()) << "the body is stationary";
      }
      inputs.mocap_before.reset();
      EXPECT_TRUE(this->others().empty()) << "plans in older logs";
      inputs.mocap->bodies.back().occluded = true;
      EXPECT_FALSE(is_in_the_way());
    }
  }
}

TEST_F(PlanObstacles, IncludeMovingBodiesAtPredictedPositions) {
  add("PERSON", {-1.0, 1.0, 1.7}, {0.6, -0.8, 0.3});
  const auto others = this->others();
  ASSERT_EQ(others.size(), 1U);
  for (const double ahead_s : {0.0, 0.7, 3.0, 9.0}) {
    const Eigen::Vector2d there_m =
        Eigen::Vector2d(-1.0, 1.0) + std::min(ahead_s, 3.0) * Eigen::Vector2d(0.6, -0.8);
    const Pose2 planned =
        models::at(others[0], inputs.mocap->stamp.time + from_seconds(ahead_s)).world_from_body;
    EXPECT_LT((planned.position_m() - there_m).norm(), 1e-6) << ahead_s;
  }
}

// The velocity of a body is unknown if its name belonged to a different body in the earlier frame,
// or if the body was occluded in that frame.
TEST_F(PlanObstacles, TreatBodyOfUnknownVelocityAsStationary) {
  add("SWAPPED", {-1.0, 1.0, 1.0}, {9.0, 0.0, 0.0});
  add("NEW", {1.0, 1.0, 1.0}, {1.0, 0.0, 0.0});
  inputs.mocap_before->bodies.back().occluded = true;
  for (const models::Trajectory& other : others()) {
    EXPECT_TRUE(other.segments.empty());
  }
  EXPECT_EQ(others().size(), 2U);
}

TEST_F(PlanObstacles, IncludeNearestBodiesAndCountTheRest) {
  for (int i = 0; i < static_cast<int>(kBodiesMax) + 3; ++i) {
    add("P" + std::to_string(i), {3.0 - 0.25 * i, 1.5, 1.0});
  }
  const auto others = this->others();
  EXPECT_EQ(others.size(), kBodiesMax);
  EXPECT_EQ(dropped, 3);
  for (const models::Trajectory& other : others) {
    EXPECT_LT(other.start.x_m, 3.0 - 0.25 * 2.5);
  }
  // The workspace has memory for all these obstacles.
  Workspace workspace(scenario);
  models::Trajectory committed;
  committed.start_time = inputs.slot.activation;
  committed.start = scenario.robots[0].start;
  const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
  EXPECT_TRUE(workspace.search().plan(round.search, Deadline::nodes(200)).found);
}

TEST_F(PlanObstacles, IncludeSilentOrOffPlanTeammateAtObservedPosition) {
  struct Case {
    const char* what;
    FlightState state;
    double ago_s;
    double plan_off_m;
    bool is_column;
  };
  const std::vector<Case> cases = {
      {"follows, reported just now", FlightState::kFollow, 0.1, 0.0, false},
      {"follows, reported half a second ago", FlightState::kFollow, 0.49, 0.0, false},
      {"followed, silent", FlightState::kFollow, 0.51, 0.0, true},
      {"followed, silent for long", FlightState::kFollow, 30.0, 4.0, true},
      {"follows, a little off its plan", FlightState::kFollow, 0.1, 0.75, false},
      {"follows, off its plan", FlightState::kFollow, 0.1, 0.85, true},
      {"held, silent", FlightState::kHold, 3.0, 0.0, true},
  };
  for (const Case& each : cases) {
    inputs = test::first_inputs(scenario, 0);
    follows(each.state, each.ago_s, {0.0, each.plan_off_m, 0.0});
    const auto others = this->others();
    ASSERT_EQ(others.size(), each.is_column ? 1U : 0U) << each.what;
    if (each.is_column) {
      EXPECT_LT(others[0].start.position_m().norm(), 1e-12) << each.what;
      EXPECT_NEAR(others[0].height_m, 1.0, 1e-12) << "it may descend through the robot's height";
    }
  }
  // Until its plan starts, a teammate may be as far from the plan as it can fly in the remaining
  // time.
  inputs = test::first_inputs(scenario, 0);
  follows(FlightState::kFollow, 0.1, {0.0, 1.2, 0.0});
  inputs.team_plans["Q2"].trajectory.start_time = inputs.mocap->stamp.time + from_seconds(0.5);
  EXPECT_TRUE(others().empty());
}

}  // namespace
}  // namespace vantage::planner
