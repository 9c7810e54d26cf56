#include "planner/robot/commitment.hpp"

#include <cstdint>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"
#include "test/support/bisect.hpp"

namespace vantage::planner {
namespace {

// A vehicle that was stopped by its driver holds its set-point and does not return to its plan.
// Here the set-point is turned away from the plan. In a flight, 49 plans in a row began at the
// plan's heading and were refused.
TEST(RobotPlanner, PlanStartsAtSetPointOfHoldingVehicle) {
  const scenario::Scenario scenario = test::lab_scenario();
  PlanInputs inputs = test::first_inputs(scenario, 0);
  inputs.own_plan = RobotPlanner(scenario, "Q1").plan(inputs, Deadline::nodes(500));
  ASSERT_TRUE(inputs.own_plan);
  const Pose2 planned =
      models::at(inputs.own_plan->trajectory, inputs.slot.activation).world_from_body;
  models::VehicleStatus& status = inputs.team_statuses["Q1"];
  status.stamp.time = inputs.slot.activation;
  const auto start = [&](models::FlightState state, const Pose2& off) {
    status.state = state;
    status.setpoint = {planned.x_m + off.x_m, planned.y_m + off.y_m,
                       wrap_to_pi(planned.yaw_rad + off.yaw_rad)};
    const auto plan = RobotPlanner(scenario, "Q1").plan(inputs, Deadline::nodes(500));
    return plan ? plan->trajectory.start : Pose2{99.0, 99.0, 0.0};
  };
  for (const Pose2& off :
       {Pose2{0.0, 0.0, 1.2}, Pose2{0.0, 0.0, -1.2}, Pose2{0.3, 0.0, 0.0}, Pose2{0.0, -0.3, 0.0}}) {
    const Pose2 held = start(models::FlightState::kHold, off);
    EXPECT_LT((held.position_m() - status.setpoint.position_m()).norm(), 1e-9);
    EXPECT_NEAR(wrap_to_pi(held.yaw_rad - status.setpoint.yaw_rad), 0.0, 1e-9);
    EXPECT_EQ(start(models::FlightState::kFollow, off), planned);  // returns to plan
  }
  EXPECT_EQ(start(models::FlightState::kHold, {0.1, 0.1, 0.3}), planned);  // within the tolerance
}

// The tracking controller returns a vehicle that hovers slightly off its plan. Beyond the
// tolerance, or with a heading error above 0.4 rad, the next plan begins at the vehicle's
// set-point.
TEST(RobotPlanner, PlanStartsOnLastPlanWithinTheTolerance) {
  const scenario::Scenario scenario = test::lab_scenario();
  RobotPlanner planner(scenario, "Q1");
  PlanInputs inputs = test::first_inputs(scenario, 0);
  inputs.own_plan = planner.plan(inputs, Deadline::nodes(500));
  ASSERT_TRUE(inputs.own_plan);
  const Pose2 planned =
      models::at(inputs.own_plan->trajectory, inputs.slot.activation).world_from_body;
  models::VehicleStatus& status = inputs.team_statuses["Q1"];
  status.stamp.time = inputs.slot.activation;
  const auto begins_on_plan = [&](const Pose2& off) {
    status.setpoint = {planned.x_m + off.x_m, planned.y_m + off.y_m,
                       wrap_to_pi(planned.yaw_rad + off.yaw_rad)};
    const auto plan = planner.plan_without_search(inputs);
    return plan && plan->trajectory.start == planned;
  };
  const auto last = [&](const Pose2& way) {
    return vantage::test::last_accepted(0.0, 0.6, 1e-4, [&](double by) {
      return begins_on_plan({by * way.x_m, by * way.y_m, by * way.yaw_rad});
    });
  };
  status.state = models::FlightState::kHold;
  for (const Pose2& way :
       {Pose2{1.0, 0.0, 0.0}, Pose2{-1.0, 0.0, 0.0}, Pose2{0.0, 1.0, 0.0}, Pose2{0.0, -1.0, 0.0}}) {
    EXPECT_NEAR(last(way), scenario.planner.tracking_tolerance_m, 1e-3);
  }
  for (const double side : {1.0, -1.0}) {
    EXPECT_NEAR(last({0.0, 0.0, side}), 0.4, 1e-3);
  }
  // In FOLLOW and LAND the plan begins on the last plan at this deviation, too.
  for (const auto state : {models::FlightState::kFollow, models::FlightState::kLand}) {
    status.state = state;
    EXPECT_TRUE(begins_on_plan({0.3, 0.0, 1.2})) << name_of(state);
  }
}

// In successive rounds the vehicle is held and turned, flies, and is held and turned again.
TEST(RobotPlanner, PlanStartsAtSetPointOfHoldingVehicleInEachRound) {
  const scenario::Scenario scenario = test::lab_scenario();
  const RoundSchedule schedule(scenario.planner, 0, 3);
  RobotPlanner planner(scenario, "Q1");
  PlanInputs inputs = test::first_inputs(scenario, 0, 7);
  models::VehicleStatus& status = inputs.team_statuses["Q1"];
  std::int64_t holds = 0;
  for (const double turned_rad : {0.0, 1.2, 0.0, -1.2, 0.0, 2.0}) {
    const bool is_held = turned_rad != 0.0;
    const bool is_first = !inputs.own_plan;
    Pose2 there = scenario.robots[0].start;
    if (!is_first) {
      inputs.slot = schedule.slot(inputs.slot.round + 1);
      there = models::at(inputs.own_plan->trajectory, inputs.slot.begin).world_from_body;
      there.yaw_rad = wrap_to_pi(there.yaw_rad + turned_rad);
    }
    holds += is_held ? 1 : 0;
    inputs.mocap->stamp.time = inputs.belief->stamp.time = inputs.slot.begin;
    inputs.mocap->bodies[0].world_from_body = lift(there, scenario.robots[0].height_m);
    status.stamp.time = inputs.slot.begin;
    status.state = is_held ? models::FlightState::kHold : models::FlightState::kFollow;
    status.setpoint = there;
    const auto plan = planner.plan(inputs, Deadline::nodes(500));
    ASSERT_TRUE(plan);
    if (is_held) {
      const Pose2& start = plan->trajectory.start;
      EXPECT_LT((start.position_m() - there.position_m()).norm(), 1e-9);
      EXPECT_NEAR(wrap_to_pi(start.yaw_rad - there.yaw_rad), 0.0, 1e-9);
    }
    EXPECT_EQ(planner.counts().off_plan, holds);
    inputs.own_plan = plan;
  }
}

/// Q2 drives along its last plan: 1 m/s along the x axis, since two seconds before the slot begins.
class CommitmentOfADriver : public ::testing::Test {
 protected:
  CommitmentOfADriver() : inputs_(test::first_inputs(scenario_, 1)) {
    models::Trajectory& last = inputs_.own_plan.emplace().trajectory;
    last = hover_at({-3.0, 0.5, 0.0}, 1.5, inputs_.slot.begin - from_seconds(2.0));
    last.segments = {{{1.0, 0.0}, 6.0, 0.0}};
    see({0.0, 0.0, 0.0});
  }

  /// Reports Q2 at offset `off` from its plan, in a frame that is `ago_s` older than the slot.
  void see(const Pose2& off, double ago_s = 0.5) {
    inputs_.mocap->stamp.time = inputs_.slot.begin - from_seconds(ago_s);
    const Pose2 planned =
        models::at(inputs_.own_plan->trajectory, inputs_.mocap->stamp.time).world_from_body;
    seen_ = {planned.x_m + off.x_m, planned.y_m + off.y_m, off.yaw_rad};
    inputs_.mocap->bodies[1].world_from_body = lift(seen_, 1.3);
  }
  [[nodiscard]] Commitment commitment() const { return commitment_of(scenario_, 1, inputs_); }
  [[nodiscard]] Pose2 on_plan() const {
    return models::at(inputs_.own_plan->trajectory, inputs_.slot.activation).world_from_body;
  }

  scenario::Scenario scenario_ = test::lab_scenario();
  PlanInputs inputs_;
  Pose2 seen_;
};

// Within the tolerance the vehicle counts as on its plan. Beyond it, the vehicle is off its plan
// but continues it. Beyond three tolerances its commitment is a hover at its observed position. The
// limits are equal in all directions.
TEST_F(CommitmentOfADriver, ContinuesThePlanUpToThreeTolerances) {
  const double tolerance_m = scenario_.planner.tracking_tolerance_m;
  for (int bearing = 0; bearing < 8; ++bearing) {
    const double to_rad = 0.25 * kPi * bearing;
    for (const double share : {0.0, 0.999, 1.001, 2.999, 3.001, 9.0}) {
      const double off_m = share * tolerance_m;
      see({off_m * std::cos(to_rad), off_m * std::sin(to_rad), 2.0});
      const Commitment commitment = this->commitment();
      ASSERT_EQ(commitment.known, Commitment::Known::kMotion);
      EXPECT_EQ(commitment.is_off_plan, share > 1.0) << share;
      EXPECT_EQ(commitment.motion.start_time, inputs_.slot.activation);
      EXPECT_EQ(commitment.motion.height_m, 1.5);
      const Pose2 expected = share > 3.0 ? seen_ : on_plan();
      EXPECT_LT((commitment.motion.start.position_m() - expected.position_m()).norm(), 1e-9);
      EXPECT_NEAR(wrap_to_pi(commitment.motion.start.yaw_rad - expected.yaw_rad), 0.0, 1e-9);
      EXPECT_EQ(commitment.motion.segments.empty(), share > 3.0)
          << "either hovers or continues to drive";
    }
  }
}

// A frame does not count if it is older than the start of the plan or does not show the vehicle.
TEST_F(CommitmentOfADriver, IsComparedWithTheObservedPose) {
  const auto is_on_plan = [&] {
    const Commitment commitment = this->commitment();
    return !commitment.is_off_plan &&
           (commitment.motion.start.position_m() - on_plan().position_m()).norm() < 1e-9;
  };
  see({0.0, 1.5, 0.0}, 2.0 - 1e-6);
  EXPECT_FALSE(is_on_plan());
  see({0.0, 1.5, 0.0}, 2.0 + 1e-6);
  EXPECT_TRUE(is_on_plan());
  see({0.0, 1.5, 0.0});
  inputs_.mocap->bodies[1].occluded = true;
  EXPECT_TRUE(is_on_plan());
  inputs_.mocap->bodies[1].occluded = false;
  EXPECT_FALSE(is_on_plan());
  inputs_.mocap->bodies[1].name = "X2";
  EXPECT_TRUE(is_on_plan());
  inputs_.mocap.reset();
  EXPECT_TRUE(is_on_plan());
}

// A vehicle without a plan hovers at its observed pose. If the vehicle is not observed either, its
// motion is unknown.
TEST_F(CommitmentOfADriver, HoversAtTheObservedPoseWithoutAPlan) {
  see({0.3, -0.4, 1.0});
  inputs_.own_plan.reset();
  const Commitment commitment = this->commitment();
  ASSERT_EQ(commitment.known, Commitment::Known::kMotion);
  EXPECT_FALSE(commitment.is_off_plan);
  EXPECT_LT((commitment.motion.start.position_m() - seen_.position_m()).norm(), 1e-12);
  EXPECT_NEAR(commitment.motion.start.yaw_rad, 1.0, 1e-12);
  EXPECT_EQ(commitment.motion.height_m, 1.5) << "its flight height, not the observed height";
  EXPECT_EQ(commitment.motion.start_time, inputs_.slot.activation);
  EXPECT_TRUE(commitment.motion.segments.empty());
  inputs_.mocap->bodies[1].occluded = true;
  EXPECT_EQ(this->commitment().known, Commitment::Known::kNoPose);
  inputs_.mocap.reset();
  EXPECT_EQ(this->commitment().known, Commitment::Known::kNoPose);
}

// A holding vehicle is compared with the point of its plan at the time of its status. Before the
// plan begins, that is the start of the plan.
TEST_F(CommitmentOfADriver, ComparesAHoldingVehicleWithItsPlanAtTheStatusTime) {
  models::VehicleStatus& status = inputs_.team_statuses["Q2"];
  status.state = models::FlightState::kHold;
  for (const double since_s : {-3.0, 0.0, 0.7, 1.9}) {
    status.stamp.time = inputs_.own_plan->trajectory.start_time + from_seconds(since_s);
    const double along_m = -3.0 + std::max(0.0, since_s);
    for (const double off_m : {0.0, 0.19, -0.19, 0.21, -0.21}) {
      status.setpoint = {along_m + off_m, 0.5, 0.0};
      const Commitment commitment = this->commitment();
      const bool is_off = std::abs(off_m) > 0.2;
      EXPECT_EQ(commitment.is_off_plan, is_off) << since_s << ' ' << off_m;
      EXPECT_EQ(commitment.motion.start, is_off ? status.setpoint : on_plan()) << since_s;
      EXPECT_EQ(commitment.motion.height_m, 1.5);
      EXPECT_EQ(commitment.motion.start_time, inputs_.slot.activation);
    }
  }
}

// In a flight, a vehicle at 1 m passed over one that was climbing to 2 m. Only the final height of
// the climb was kept clear.
TEST(RobotPlanner, KeepsClearOfHeightsPassedInAClimbOrLanding) {
  const scenario::Scenario scenario = test::lab_scenario();
  const auto kept_at_m = [&](const std::string& own, models::FlightState state, double here_m) {
    PlanInputs inputs = test::first_inputs(scenario, own == "Q1" ? 0 : 2);
    inputs.team_statuses["Q2"].state = state;  // Q1 flies at 1 m, Q2 at 1.5 m, Q3 at 2 m
    inputs.team_statuses["Q2"].stamp.time = inputs.slot.begin;
    for (models::MocapBody& body : inputs.mocap->bodies) {
      body.world_from_body.translation_m.z() =
          body.name == "Q2" ? here_m : body.world_from_body.translation_m.z();
    }
    RobotPlanner planner(scenario, own);
    EXPECT_TRUE(planner.plan(inputs, Deadline::nodes(500)));
    return planner.problem().teammates.back().height_m;
  };
  using models::FlightState;
  // Q2 climbs from 0.2 m to 1.5 m; this passes 1 m but does not reach 2 m.
  EXPECT_DOUBLE_EQ(kept_at_m("Q1", FlightState::kHold, 0.2), 1.0);
  EXPECT_DOUBLE_EQ(kept_at_m("Q3", FlightState::kHold, 0.2), 1.5);
  EXPECT_DOUBLE_EQ(kept_at_m("Q1", FlightState::kHold, 1.2), 1.2);
  EXPECT_DOUBLE_EQ(kept_at_m("Q1", FlightState::kHold, 1.5), 1.5);
  // A landing from 1.4 m passes 1 m; a landing from 0.6 m does not.
  EXPECT_DOUBLE_EQ(kept_at_m("Q1", FlightState::kLand, 1.4), 1.0);
  EXPECT_DOUBLE_EQ(kept_at_m("Q1", FlightState::kLand, 0.6), 0.6);
  EXPECT_DOUBLE_EQ(kept_at_m("Q3", FlightState::kLand, 1.4), 1.4);
  EXPECT_DOUBLE_EQ(kept_at_m("Q1", FlightState::kIdle, 0.0), 1.5);
}

// A rover planned a path through a quadrotor that had not taken off yet, because only the flight
// height of the quadrotor was kept clear. The driver refused the path for 18 s.
TEST(RobotPlanner, KeepsClearOfGroundedTeammateAtBothHeights) {
  const scenario::Scenario scenario = test::lab_scenario();
  const auto kept_at_m = [&](models::FlightState state, double here_m) {
    PlanInputs inputs = test::first_inputs(scenario, 0);
    const std::size_t others = scenario.robots.size() - 1;
    inputs.team_statuses["Q2"].state = state;
    inputs.team_statuses["Q2"].stamp.time = inputs.slot.begin;
    for (models::MocapBody& body : inputs.mocap->bodies) {
      body.world_from_body.translation_m.z() =
          body.name == "Q2" ? here_m : body.world_from_body.translation_m.z();
    }
    RobotPlanner planner(scenario, "Q1");
    EXPECT_TRUE(planner.plan(inputs, Deadline::nodes(500)));
    std::vector<double> out;
    const auto& teammates = planner.problem().teammates;
    for (std::size_t i = others; i < teammates.size(); ++i) {
      out.push_back(teammates[i].height_m);
    }
    return out;
  };
  using Heights = std::vector<double>;
  for (const auto state : {models::FlightState::kIdle, models::FlightState::kKilled}) {
    EXPECT_EQ(kept_at_m(state, 0.0), (Heights{0.0, 1.5}));
    EXPECT_EQ(kept_at_m(state, 0.74), (Heights{0.74, 1.5}));
    EXPECT_EQ(kept_at_m(state, 0.75), Heights{1.5});  // half height: airborne
    EXPECT_EQ(kept_at_m(state, 1.5), Heights{1.5});
  }
  EXPECT_EQ(kept_at_m(models::FlightState::kFollow, 0.0), Heights{});
}

// If the driver of a vehicle does not run, no status is sent, but the vehicle's position is still
// kept clear.
TEST(RobotPlanner, KeepsClearOfGroundedTeammateWithoutStatus) {
  const scenario::Scenario scenario = test::lab_scenario();
  PlanInputs inputs = test::first_inputs(scenario, 0);
  inputs.mocap->bodies[1].world_from_body.translation_m.z() = 0.1;
  RobotPlanner planner(scenario, "Q1");
  ASSERT_TRUE(planner.plan(inputs, Deadline::nodes(500)));
  const auto& teammates = planner.problem().teammates;
  ASSERT_EQ(teammates.size(), 3U);  // Q2 and Q3 at their flight heights, and Q2 on the ground
  EXPECT_DOUBLE_EQ(teammates[0].height_m, 1.5);
  EXPECT_DOUBLE_EQ(teammates[1].height_m, 2.0);
  EXPECT_DOUBLE_EQ(teammates[2].height_m, 0.1);
}

// Before take-off and after landing each teammate on the ground counts three times: its plan, its
// position on the ground, and its flight position.
TEST(RobotPlanner, PlansWithWholeTeamOnGround) {
  for (std::size_t team = 1; team <= 9; ++team) {
    scenario::Scenario scenario = test::lab_scenario();
    const scenario::RobotSpec model = scenario.robots.front();
    scenario.robots.clear();
    for (std::size_t i = 0; i < team; ++i) {
      scenario::RobotSpec robot = model;
      robot.name = "Q" + std::to_string(i + 1);
      robot.start = {-3.5 + 0.8 * static_cast<double>(i), i % 2 == 0 ? -1.5 : 1.5, 0.0};
      scenario.robots.push_back(robot);
    }
    PlanInputs inputs = test::first_inputs(scenario, 0, 1);
    for (std::size_t i = 0; i < team; ++i) {
      const std::string& name = scenario.robots[i].name;
      inputs.mocap->bodies[i].world_from_body.translation_m.z() = 0.0;
      inputs.team_statuses[name].state = models::FlightState::kIdle;
      if (i > 0) {
        inputs.team_plans[name].trajectory =
            hover_at(scenario.robots[i].start, model.height_m, inputs.slot.activation);
      }
    }
    RobotPlanner planner(scenario, "Q1");
    EXPECT_TRUE(planner.plan(inputs, Deadline::nodes(500))) << team;
    EXPECT_EQ(planner.problem().teammates.size(), 3 * (team - 1));
  }
}

// In a flight, the operator stopped a vehicle that faced a wall at 0.5 m. The vehicle hovered there
// for seven minutes, because no primitive turns on the spot.
TEST(RobotPlanner, TurnsOnTheSpotNearAWall) {
  scenario::Scenario scenario = test::lab_scenario();
  const double nearest_m = scenario.robots[0].limits.radius_m + scenario.planner.obstacle_margin_m;
  const Pose2 inward{0.0, 0.0, 0.3};  // rad; angle to the wall's normal
  for (const Pose2& start : {Pose2{0.0, 2.0 - nearest_m - 0.06, kPi / 2},
                             Pose2{0.0, -2.0 + nearest_m + 0.06, -kPi / 2 + inward.yaw_rad},
                             Pose2{4.0 - nearest_m - 0.06, 2.0 - nearest_m - 0.06, kPi / 4},
                             Pose2{-4.0 + nearest_m + 0.06, 0.0, kPi},
                             // Poses from a flight, at the smallest allowed clearance within the
                             // rounding of other checks.
                             Pose2{4.0 - nearest_m - 0.011, -2.0 + nearest_m + 0.012, 0.0},
                             Pose2{0.0, 2.0 - nearest_m - 0.003, kPi / 2}}) {
    PlanInputs inputs = test::first_inputs(scenario, 0, 7);
    inputs.mocap->bodies[0].world_from_body = lift(start, scenario.robots[0].height_m);
    const RoundSchedule schedule(scenario.planner, 0, 3);
    RobotPlanner planner(scenario, "Q1");
    double gone_m = 0.0;
    for (int round = 0; round < 8; ++round) {
      const auto plan = planner.plan(inputs, Deadline::nodes(20'000));
      ASSERT_TRUE(plan);
      ASSERT_TRUE(models::is_clear(scenario.world, plan->trajectory, plan->trajectory.start_time,
                                   nearest_m - 0.021));
      inputs.own_plan = plan;
      inputs.slot = schedule.slot(inputs.slot.round + 1);
      const Pose2 then = models::at(plan->trajectory, inputs.slot.begin).world_from_body;
      inputs.mocap->stamp.time = inputs.slot.begin;
      inputs.mocap->bodies[0].world_from_body = lift(then, scenario.robots[0].height_m);
      inputs.belief->stamp.time = inputs.slot.begin;
      gone_m = std::max(gone_m, (then.position_m() - start.position_m()).norm());
    }
    EXPECT_GT(gone_m, 1.0) << start.x_m << " " << start.y_m;
    EXPECT_GE(planner.counts().turns_away, 1);
    EXPECT_LE(planner.counts().turns_away, 4);
  }
}

}  // namespace
}  // namespace vantage::planner
