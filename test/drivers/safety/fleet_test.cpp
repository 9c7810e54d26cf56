#include "drivers/safety/fleet.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/inputs.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/bisect.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

class TeammatesPlans : public testing::Test {
 protected:
  /// Returns a hover at the origin from `start_s` on.
  static models::RobotPlan hover(std::int64_t run, std::int64_t sequence, double start_s,
                                 const std::string& robot = "Q2") {
    models::RobotPlan plan;
    plan.robot = robot;
    plan.trajectory.start_time = kStart + from_seconds(start_s);
    plan.trajectory.height_m = 1.0;
    plan.stamp = {plan.trajectory.start_time, run, sequence};
    return plan;
  }
  bool accepts(const models::RobotPlan& plan, double at_s) {
    return fleet.on_plan(plan, limits, kStart + from_seconds(at_s));
  }
  bool accepts(std::int64_t run, std::int64_t sequence, double start_s, double at_s,
               const std::string& robot = "Q2") {
    return accepts(hover(run, sequence, start_s, robot), at_s);
  }

  scenario::Scenario scenario = test::FlightBench::scenario();
  SafetyLimits limits = limits_for(scenario, "Q1");
  Fleet fleet{scenario, "Q1"};
};

TEST_F(TeammatesPlans, MustBeCurrent) {
  EXPECT_FALSE(accepts(1, 0, -3600.0, 0.0)) << "from an old log";
  EXPECT_FALSE(accepts(1, 1, 3600.0, 0.0)) << "it would block later plans for an hour";
  EXPECT_TRUE(accepts(1, 2, 1.0, 0.0));
  EXPECT_FALSE(accepts(1, 3, 1.0, 0.0, "Q9"));
  EXPECT_EQ(fleet.plans_refused(), 3);
}

TEST_F(TeammatesPlans, MustBeNew) {
  EXPECT_TRUE(accepts(1, 5, 1.0, 0.0));
  EXPECT_FALSE(accepts(1, 5, 1.0, 0.1));
  EXPECT_FALSE(accepts(1, 4, 1.5, 0.1));
  EXPECT_FALSE(accepts(1, 6, 0.5, 0.1)) << "begins before the last plan";
  EXPECT_TRUE(accepts(1, 7, 1.0, 0.1));
}

TEST_F(TeammatesPlans, MustComeFromTheLeaseholder) {
  EXPECT_TRUE(accepts(1, 0, 1.0, 0.0));
  EXPECT_FALSE(accepts(2, 0, 1.5, 0.5));
  EXPECT_TRUE(accepts(2, 0, 1.0, 0.5, "Q3")) << "each teammate has a separate lease";
  const double after_s = limits.planner_lease_s + 0.1;
  EXPECT_TRUE(accepts(2, 1, after_s, after_s));
  EXPECT_FALSE(accepts(1, 1, after_s, after_s));
}

TEST_F(TeammatesPlans, BeginWithinTheTimeLimits) {
  const auto accepts_start = [&](double start_s) {
    fleet = Fleet(scenario, "Q1");
    return accepts(1, 0, start_s, 0.0);
  };
  EXPECT_NEAR(test::last_accepted(0.0, -60.0, 1e-7, accepts_start), -limits.plan_past_max_s, 2e-6);
  EXPECT_NEAR(test::last_accepted(0.0, 60.0, 1e-7, accepts_start), limits.plan_future_max_s, 2e-6);
}

TEST_F(TeammatesPlans, MayStartExactlyAtTheirLimits) {
  for (const auto& [start_s, is_taken] : {std::pair(-limits.plan_past_max_s, true),
                                          {-limits.plan_past_max_s - 1e-6, false},
                                          {limits.plan_future_max_s, true},
                                          {limits.plan_future_max_s + 1e-6, false}}) {
    fleet = Fleet(scenario, "Q1");
    EXPECT_EQ(accepts(1, 0, start_s, 0.0), is_taken) << start_s;
  }
}

// Sequence numbers of a run start at 0; a run id may have any value.
TEST_F(TeammatesPlans, AreAcceptedOnceFromAnyRun) {
  for (const std::int64_t run :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1},
        std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    fleet = Fleet(scenario, "Q1");
    EXPECT_TRUE(accepts(run, 0, 1.0, 0.0)) << run;
    EXPECT_FALSE(accepts(run, 0, 1.0, 0.1)) << run;
    EXPECT_TRUE(accepts(run, 1, 1.0, 0.1)) << run;
  }
}

TEST_F(TeammatesPlans, NumbersRestartWithANewPlanner) {
  double at_s = 0.0;
  for (std::int64_t run = 1; run <= 3; ++run) {
    EXPECT_TRUE(accepts(run, 1000, at_s, at_s)) << run;
    at_s += limits.planner_lease_s + 0.1;
    EXPECT_TRUE(accepts(run + 1, 0, at_s, at_s)) << run + 1;
    EXPECT_FALSE(accepts(run + 1, 0, at_s, at_s)) << run + 1;
  }
}

// A clock that was never set may give times before 1970.
TEST_F(TeammatesPlans, FirstPlanIsAcceptedOnAnyClock) {
  constexpr double kEpochS = -1'700'000'000.0;
  for (const double at_s : {kEpochS - 5.0, kEpochS + 5.0, 0.0}) {
    fleet = Fleet(scenario, "Q1");
    EXPECT_TRUE(accepts(1, 0, at_s, at_s)) << at_s;
    EXPECT_FALSE(accepts(1, 1, at_s - 1e-3, at_s)) << "begins before the last plan";
  }
}

// An infeasible plan is ignored and its planner does not get the lease.
TEST_F(TeammatesPlans, AreIgnoredWhenInfeasible) {
  models::RobotPlan plan = hover(1, 0, 1.0);
  plan.trajectory.start.x_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(accepts(plan, 0.0));
  plan = hover(1, 1, 1.0);
  plan.trajectory.segments = {{{1.0, 0.0}, -1.0, 0.0}};
  EXPECT_FALSE(accepts(plan, 0.0));
  plan = hover(1, 2, 1.0);
  plan.trajectory.segments.resize(HeldPlan::kSegmentsMax + 1);
  EXPECT_FALSE(accepts(plan, 0.0));
  EXPECT_TRUE(fleet.courses(kStart, limits).empty());
  EXPECT_EQ(fleet.plans_refused(), 3);
  EXPECT_TRUE(accepts(2, 0, 1.0, 0.0)) << "another planner is accepted immediately";
  EXPECT_EQ(fleet.courses(kStart, limits).size(), 1u);
}

TEST_F(TeammatesPlans, MustBelongToOtherRobots) {
  EXPECT_FALSE(accepts(1, 0, 1.0, 0.0, "W1")) << "targets have no plans";
  EXPECT_FALSE(accepts(1, 0, 1.0, 0.0, "Q1")) << "the vehicle is not its own teammate";
  EXPECT_TRUE(fleet.courses(kStart, limits).empty());
}

/// Fleet as seen by Q2: Q1, Q3 and the walkers W1 … W9.
class FleetBodies : public testing::Test {
 protected:
  void show(double at_s, const std::map<std::string, Eigen::Vector3d>& places_m) {
    models::MocapFrame frame;
    for (const auto& [name, p_m] : places_m) {
      frame.bodies.push_back({name, {p_m, Eigen::Quaterniond::Identity()}, false});
    }
    fleet.on_mocap(frame, limits, at(at_s));
  }
  /// Delivers a plan of Q3: a hover at `p_m` until `start_s`, then motion along x.
  bool plan_of_q3(double start_s, double heard_s, const Eigen::Vector3d& p_m) {
    models::RobotPlan plan;
    plan.robot = "Q3";
    plan.trajectory.start_time = at(start_s);
    plan.trajectory.start = {p_m.x(), p_m.y(), 0.0};
    plan.trajectory.height_m = p_m.z();
    plan.trajectory.segments = {{{0.8, 0.0}, 2.0, 0.0}, {{}, 0.1, 0.0}};
    plan.stamp = {plan.trajectory.start_time, 5, ++sequence};
    return fleet.on_plan(plan, limits, at(heard_s));
  }
  static Time at(double t_s) { return kStart + from_seconds(t_s); }
  OtherBody body(double at_s, std::size_t i = 0) {
    const auto bodies = fleet.bodies(at(at_s), limits);
    EXPECT_LT(i, bodies.size());
    return i < bodies.size() ? bodies[i] : OtherBody{};
  }
  OtherCourse course(double at_s, std::size_t i = 0) {
    const auto courses = fleet.courses(at(at_s), limits);
    EXPECT_LT(i, courses.size());
    return i < courses.size() ? courses[i] : OtherCourse{};
  }

  scenario::Scenario scenario = test::FlightBench::scenario();
  SafetyLimits limits = limits_for(scenario, "Q2");
  Fleet fleet{scenario, "Q2"};
  std::int64_t sequence = 0;
};

TEST_F(FleetBodies, AreListedWithTheirPriority) {
  EXPECT_TRUE(fleet.bodies(at(0.0), limits).empty());
  EXPECT_TRUE(fleet.courses(at(0.0), limits).empty());
  show(0.0, {{"Q1", {0, 0, 1}}, {"Q2", {1, 0, 1}}, {"Q3", {2, 0, 1}}, {"W1", {3, 0, 0}}});
  const auto bodies = fleet.bodies(at(0.0), limits);
  ASSERT_EQ(bodies.size(), 3u) << "the vehicle is not another body";
  const double xs_m[] = {0.0, 2.0, 3.0};
  const bool has_priority[] = {true, false, true};  // Q1 precedes Q2; non-robots have priority
  const int robots[] = {0, 2, -1};                  // indices in the scenario
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(bodies[i].position_world_m.x(), xs_m[i]);
    EXPECT_EQ(bodies[i].has_priority, has_priority[i]) << i;
    EXPECT_EQ(bodies[i].robot, robots[i]) << i;
  }
  const auto courses = fleet.courses(at(0.0), limits);
  ASSERT_EQ(courses.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(courses[i].plan, nullptr) << i;
    EXPECT_EQ(courses[i].reaches_ground, i == 2) << "a person reaches down to the ground";
  }
}

TEST_F(FleetBodies, CountUnknownBodiesAndRefusedPoses) {
  for (int time = 1; time <= 2; ++time) {
    show(0.01 * time, {{"Q1", {0, 0, 1}}, {"Q2", {1, 0, 1}}, {"X", {2, 0, 1}}, {"Y", {2, 1, 1}}});
    EXPECT_EQ(fleet.unknown_bodies(), 2 * time);
    EXPECT_EQ(fleet.poses_refused(), 0);
  }
  for (int time = 1; time <= 2; ++time) {
    show(0.02 + 0.01 * time, {{"Q1", {3, 0, 1}}, {"Q2", {1, 0, 1}}});
    EXPECT_EQ(fleet.poses_refused(), time) << "the pose has jumped";
  }
}

// A body that has been moved is accepted at its new position after fifty consecutive poses. Tested
// twice.
TEST_F(FleetBodies, AreAcceptedAfterFiftyPosesElsewhere) {
  double t_s = 0.0;
  show(t_s, {{"Q1", {0, 0, 1}}});
  for (const double x_m : {2.0, -2.0}) {
    const double before_m = body(t_s).position_world_m.x();
    for (int i = 0; i < 50; ++i) {
      show(t_s += 0.01, {{"Q1", {x_m, 0, 1}}});
      EXPECT_EQ(body(t_s).position_world_m.x(), before_m) << i;
    }
    show(t_s += 0.01, {{"Q1", {x_m, 0, 1}}});
    EXPECT_EQ(body(t_s).position_world_m.x(), x_m);
  }
}

// The measured velocity of a teammate is delayed. The velocity of its plan is therefore assumed
// from one reaction time before the plan starts to move, so that this vehicle brakes in time.
TEST_F(FleetBodies, AreAssumedToMoveOneReactionTimeBeforeTheirPlanStarts) {
  const Eigen::Vector3d hover_m(1.0, -1.0, 1.0);
  const double seen_s = test::last_accepted(1.5, 0.0, 1e-7, [&](double t_s) {
    fleet = Fleet(scenario, "Q2");
    show(t_s, {{"Q3", hover_m}});
    EXPECT_TRUE(plan_of_q3(1.5, t_s, hover_m));
    return body(t_s).planned_world_mps.norm() > 0.0;
  });
  EXPECT_NEAR(seen_s, 1.5 - limits.reaction_s, 3e-6);
  EXPECT_NEAR(body(1.4).planned_world_mps.x(), 0.8, 1e-12);
  EXPECT_EQ(body(1.4).velocity_world_mps.norm(), 0.0);
}

// A teammate that should hover according to its plan may still move, so the planned velocity does
// not replace a greater measured velocity.
TEST_F(FleetBodies, KeepTheMeasuredVelocityIfItIsGreater) {
  for (double t_s = 0.0; t_s < 0.5; t_s += 0.01) {
    show(t_s, {{"Q3", {0.5 * t_s, -1.0, 1.0}}});
  }
  const double faster_mps = body(0.49).velocity_world_mps.x();
  EXPECT_NEAR(faster_mps, 0.5, 0.01);
  EXPECT_TRUE(plan_of_q3(2.0, 0.49, {0.25, -1.0, 1.0}));
  EXPECT_EQ(body(0.49).planned_world_mps.x(), faster_mps) << "its plan is not finished";
  EXPECT_NEAR(body(0.58).position_world_m.x(), 0.245 + 0.09 * 0.5, 0.002) << "extrapolated to now";
}

TEST_F(FleetBodies, StayAtTheirLastPositionWhenUnseen) {
  for (double t_s = 0.0; t_s < 0.5; t_s += 0.01) {
    show(t_s, {{"Q3", {0.5 * t_s, -1.0, 1.0}}});
  }
  const double fresh_s = test::last_accepted(
      0.5, 2.0, 1e-7, [&](double t_s) { return body(t_s).velocity_world_mps.norm() > 0.0; });
  EXPECT_NEAR(fresh_s, 0.49 + limits.pose_age_hold_s, 3e-6);
  const double last_m = body(0.59).position_world_m.x();
  EXPECT_NEAR(body(5.0).position_world_m.x(), last_m, 1e-6);
  EXPECT_NEAR(body(5.0).age_s, 4.51, 1e-6);
  EXPECT_EQ(body(5.0).planned_world_mps.norm(), 0.0);
}

// An occluded person is assumed to keep walking, with the radius given in the scenario.
TEST_F(FleetBodies, KeepMovingAndKeepTheirRadiusIfNotRobots) {
  scenario.targets[0].radius_m = 0.4;
  scenario.robots[0].limits.radius_m = 0.3;
  scenario.robots[2].limits.radius_m = 0.1;
  fleet = Fleet(scenario, "Q2");
  ASSERT_EQ(limits.vehicle.radius_m, 0.25);
  for (double t_s = 0.0; t_s < 0.5; t_s += 0.01) {
    show(t_s, {{"Q1", {1.2 * t_s, 0.0, 1.0}},
               {"Q3", {1.2 * t_s, 3.0, 1.0}},
               {"W1", {0.0, -1.2 * t_s, 0.0}}});
  }
  for (const double t_s : {0.5, 1.5, 30.0}) {
    EXPECT_EQ(body(t_s, 0).last_speed_mps, 0.0);
    EXPECT_EQ(body(t_s, 1).last_speed_mps, 0.0);
    EXPECT_NEAR(body(t_s, 2).last_speed_mps, 1.2, 0.01);
    EXPECT_NEAR(body(t_s, 0).excess_radius_m, 0.05, 1e-12);
    EXPECT_EQ(body(t_s, 1).excess_radius_m, 0.0);
    EXPECT_NEAR(body(t_s, 2).excess_radius_m, 0.15, 1e-12);
  }
}

// A teammate close to its plan is assumed to follow it. A teammate that deviates is treated as a
// body at its measured position, until it is close to its plan again.
TEST_F(FleetBodies, AreAssumedToFollowTheirPlanWhileCloseToIt) {
  const Eigen::Vector3d hover_m(1.0, -1.0, 1.0);
  show(0.0, {{"Q3", hover_m}});
  EXPECT_EQ(course(0.0).plan, nullptr) << "no plan was received";
  EXPECT_TRUE(plan_of_q3(3.0, 0.0, hover_m));
  for (const double side : {1.0, -1.0}) {
    const double strays_m = test::last_accepted(0.0, 2.0, 1e-9, [&](double off_m) {
      fleet = Fleet(scenario, "Q2");
      show(0.0, {{"Q3", hover_m + Eigen::Vector3d(0.0, side * off_m, 0.0)}});
      EXPECT_TRUE(plan_of_q3(3.0, 0.0, hover_m));
      return course(0.0).plan != nullptr;
    });
    EXPECT_NEAR(strays_m, 2.0 * limits.tracking_hold_m, 1e-8);
    EXPECT_EQ(fleet.bodies(at(0.0), limits).size(), 1u);
  }
  fleet = Fleet(scenario, "Q2");
  EXPECT_TRUE(plan_of_q3(3.0, 0.0, hover_m));
  EXPECT_NE(course(0.0).plan, nullptr) << "never seen: only its plan is known";
  for (int time = 0; time < 2; ++time) {
    const double t_s = time;
    show(t_s, {{"Q3", hover_m}});
    EXPECT_NE(course(t_s).plan, nullptr);
    for (int i = 1; i <= 60; ++i) {
      show(t_s + 0.01 * i, {{"Q3", hover_m + Eigen::Vector3d(0.0, 0.9, 0.0)}});
    }
    EXPECT_EQ(course(t_s + 0.6).plan, nullptr);
    EXPECT_NEAR(course(t_s + 0.6).position_world_m.y(), -0.1, 1e-9);
    for (int i = 1; i <= 60; ++i) {
      show(t_s + 0.6 + 0.005 * i, {{"Q3", hover_m}});
    }
  }
}

// While a name appears twice in a frame, its body stays at its last position and counts as unseen.
TEST_F(FleetBodies, AreUnseenWhileTheirNameAppearsTwice) {
  const Eigen::Vector3d here_m(1.0, -1.0, 1.0);
  show(0.0, {{"Q3", here_m}});
  for (int time = 1; time <= 2; ++time) {
    models::MocapFrame frame;
    for (const double off_m : {0.0, 0.05}) {
      const Pose3 pose{here_m + Eigen::Vector3d(off_m, 0.0, 0.0), Quaternion::Identity()};
      frame.bodies.push_back({"Q3", pose, false});
    }
    fleet.on_mocap(frame, limits, at(0.01 * time));
    EXPECT_EQ(body(0.01 * time).position_world_m, here_m);
    EXPECT_NEAR(body(0.01 * time).age_s, 0.01 * time, 1e-9);
  }
  show(0.03, {{"Q3", here_m}});
  EXPECT_EQ(body(0.03).age_s, 0.0) << "accepted again when its name is unique";
}

// The measured position is compared with the planned position at the current time, not at the
// start.
TEST_F(FleetBodies, AreComparedWithTheCurrentPointOfTheirPlan) {
  const Eigen::Vector3d hover_m(-1.0, -1.0, 1.0);
  EXPECT_TRUE(plan_of_q3(0.0, 0.0, hover_m));
  for (int i = 0; i <= 300; ++i) {
    const double t_s = 0.01 * i;
    show(t_s, {{"Q3", hover_m + Eigen::Vector3d(0.8 * std::min(t_s, 2.0), 0.0, 0.0)}});
    EXPECT_NE(course(t_s).plan, nullptr) << t_s;
  }
  fleet = Fleet(scenario, "Q2");
  EXPECT_TRUE(plan_of_q3(0.0, 0.0, hover_m));
  const double left_behind_s = test::last_accepted(0.0, 2.5, 1e-7, [&](double t_s) {
    show(t_s, {{"Q3", hover_m}});
    return course(t_s).plan != nullptr;
  });
  EXPECT_NEAR(0.8 * left_behind_s, 2.0 * limits.tracking_hold_m, 3e-6)
      << "a robot that did not start";
}

TEST_F(FleetBodies, UseThePlannedVelocityOneReactionTimeAhead) {
  const Eigen::Vector3d hover_m(-1.0, -1.0, 1.0);
  models::RobotPlan plan;
  plan.robot = "Q3";
  plan.trajectory = {at(0.0), {-1.0, -1.0, 0.0}, 1.0, {}};
  plan.trajectory.segments = {
      {{0.3, 0.0}, 1.0, 0.0}, {{0.6, 0.0}, 1.0, 0.0}, {{-0.5, 0.0}, 1.0, 0.0}, {{}, 0.1, 0.0}};
  plan.stamp = {plan.trajectory.start_time, 5, 0};
  const auto asked_mps = [&](double t_s) {
    fleet = Fleet(scenario, "Q2");
    EXPECT_TRUE(fleet.on_plan(plan, limits, at(0.0)));
    show(t_s, {{"Q3", hover_m + Eigen::Vector3d(0.2 * t_s, 0.0, 0.0)}});  // close to its plan
    return body(t_s).planned_world_mps.x();
  };
  const double soon_s = limits.reaction_s;
  for (const double just_s : {-1e-3, 1e-3}) {
    const bool is_later = just_s > 0.0;
    EXPECT_NEAR(asked_mps(0.0), 0.3, 1e-12);
    EXPECT_NEAR(asked_mps(1.0 - soon_s + just_s), is_later ? 0.6 : 0.3, 1e-12);
    EXPECT_NEAR(asked_mps(2.0 - soon_s + just_s), is_later ? -0.5 : 0.6, 1e-12);
    EXPECT_NEAR(asked_mps(3.0 - soon_s + just_s), is_later ? 0.0 : -0.5, 1e-12);
  }
}

TEST_F(FleetBodies, IgnoreAPlanThatTheyHaveLeft) {
  const Eigen::Vector3d hover_m(1.0, -1.0, 1.0);
  for (const double off_m : {0.7, 0.9}) {
    fleet = Fleet(scenario, "Q2");
    show(0.0, {{"Q3", hover_m + Eigen::Vector3d(0.0, off_m, 0.0)}});
    EXPECT_TRUE(plan_of_q3(0.1, 0.0, hover_m));
    const bool keeps_to_it = off_m < 2.0 * limits.tracking_hold_m;
    EXPECT_EQ(body(0.0).planned_world_mps.norm(), keeps_to_it ? 0.8 : 0.0) << off_m;
  }
}

// A teammate without a received plan is treated as a body at its measured position, also near the
// origin.
TEST_F(FleetBodies, StayAtTheirPositionWithoutAPlan) {
  test::Random random(51);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d here_m = random.vector<3>(0.0, 1.5);
    fleet = Fleet(scenario, "Q2");
    show(0.0, {{"Q3", here_m}});
    EXPECT_EQ(course(0.0).plan, nullptr) << here_m.transpose();
    EXPECT_EQ(course(0.0).position_world_m, here_m);
    EXPECT_EQ(body(0.0).planned_world_mps.norm(), 0.0);
  }
}

// The position is extrapolated at the last velocity for at most half a second.
TEST_F(FleetBodies, AreExtrapolatedForHalfASecond) {
  for (double t_s = 0.0; t_s < 0.5; t_s += 0.01) {
    show(t_s, {{"Q3", {0.5 * t_s, -1.0, 1.0}}});
  }
  const Eigen::Vector3d last_m = course(0.49).position_world_m;
  const Eigen::Vector3d velocity_mps = body(0.49).velocity_world_mps;
  EXPECT_NEAR(velocity_mps.x(), 0.5, 0.01);
  for (const double gone_s : {0.0, 0.2, 0.4, 0.5, 0.6, 1.0, 5.0}) {
    const Eigen::Vector3d there_m = last_m + std::min(gone_s, 0.5) * velocity_mps;
    EXPECT_LT((course(0.49 + gone_s).position_world_m - there_m).norm(), 2e-6) << gone_s;
  }
}

TEST(FindUnique, FindsABodyWithAUniqueName) {
  models::MocapFrame frame;
  EXPECT_EQ(find_unique(frame, "Q1").body, nullptr);
  EXPECT_TRUE(find_unique(frame, "Q1").is_unique);
  frame.bodies = {{"Q2", {}, false}, {"Q1", {}, false}};
  EXPECT_EQ(find_unique(frame, "Q1").body, &frame.bodies[1]);
  EXPECT_TRUE(find_unique(frame, "Q1").is_unique);
  for (int more = 0; more < 2; ++more) {
    frame.bodies.push_back({"Q1", {}, false});
    EXPECT_FALSE(find_unique(frame, "Q1").is_unique) << more + 2;
  }
}

}  // namespace
}  // namespace vantage::drivers
