#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/fleet.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/allocation_counter.hpp"

// Tests of Fleet with bodies without plans, teammates with a dead driver, and infeasible plans.

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

class FleetOfQ2 : public testing::Test {
 protected:
  static Time at(double t_s) { return kStart + from_seconds(t_s); }
  void show(double at_s, const std::map<std::string, Eigen::Vector3d>& places_m) {
    models::MocapFrame frame;
    for (const auto& [name, p_m] : places_m) {
      frame.bodies.push_back({name, {p_m, Eigen::Quaterniond::Identity()}, false});
    }
    fleet.on_mocap(frame, limits, at(at_s));
  }
  /// Returns a plan of Q3: a hover at (1, −1, 1) unless `change` modifies it.
  models::RobotPlan plan(const std::function<void(models::Trajectory&)>& change = nullptr) {
    models::RobotPlan out;
    out.robot = "Q3";
    out.trajectory.start_time = at(0.0);
    out.trajectory.start = {1.0, -1.0, 0.0};
    out.trajectory.height_m = 1.0;
    if (change) {
      change(out.trajectory);
    }
    out.stamp = {out.trajectory.start_time, 5, ++sequence};
    return out;
  }

  scenario::Scenario scenario = test::FlightBench::scenario();
  SafetyLimits limits = limits_for(scenario, "Q2");
  Fleet fleet{scenario, "Q2"};
  std::int64_t sequence = 0;
};

// An infeasible plan is counted, and the teammate is treated as a body at its measured position.
TEST_F(FleetOfQ2, RefusesInfeasibleTeammatePlans) {
  using Segments = std::vector<models::PlanSegment>;
  struct Case {
    const char* what;
    Segments segments;
    bool is_taken;
  };
  const std::vector<Case> cases = {
      {"1000 m/s for a microsecond", {{{1000.0, 0.0}, 1e-6, 0.0}, {{}, 0.1, 0.0}}, false},
      {"twice as fast as its vehicle", {{{2.0, 0.0}, 1.0, 0.0}, {{2.0, 0.0}, 1.0, 2.0}}, false},
      {"turns three times as fast", {{{0.1, 9.0}, 1.0, 0.0}, {{}, 0.1, 0.0}}, false},
      {"brakes ten times as hard", {{{1.0, 0.0}, 1.0, 0.0}, {{1.0, 0.0}, 0.05, 20.0}}, false},
      {"ends in motion", {{{1.0, 0.0}, 1.0, 0.0}}, false},
      {"a duration below zero", {{{1.0, 0.0}, -1.0, 0.0}, {{}, 0.1, 0.0}}, false},
      {"a twentieth too fast", {{{1.05, 0.0}, 1.0, 0.0}, {{1.05, 0.0}, 0.525, 2.0}}, true},
  };
  std::int64_t refused = 0;
  for (const Case& each : cases) {
    fleet = Fleet(scenario, "Q2");
    show(0.0, {{"Q3", {1.0, -1.0, 1.0}}});
    const auto sent = plan([&](models::Trajectory& way) { way.segments = each.segments; });
    EXPECT_EQ(fleet.on_plan(sent, limits, at(0.0)), each.is_taken) << each.what;
    EXPECT_EQ(fleet.plans_refused(), each.is_taken ? 0 : 1) << each.what;
    const auto courses = fleet.courses(at(0.0), limits);
    ASSERT_EQ(courses.size(), 1u);
    EXPECT_EQ(courses[0].plan != nullptr, each.is_taken) << each.what;
    EXPECT_EQ(courses[0].position_world_m, Eigen::Vector3d(1.0, -1.0, 1.0)) << each.what;
    refused += fleet.plans_refused();
  }
  EXPECT_EQ(refused, 6);
}

// The teammate's driver is silent, so its autopilot lands it vertically. The whole column below it
// is therefore occupied.
TEST_F(FleetOfQ2, ReservesTheColumnBelowASilentTeammate) {
  const auto course_at = [&](double t_s) {
    show(t_s, {{"Q3", {1.0, -1.0, 1.5}}});
    return fleet.courses(at(t_s), limits)[0];
  };
  show(0.0, {{"Q3", {1.0, -1.0, 1.5}}});
  ASSERT_TRUE(fleet.on_plan(plan(), limits, at(0.0)));
  EXPECT_NE(course_at(0.1).plan, nullptr);
  EXPECT_NE(course_at(2.0).plan, nullptr) << "its driver has never reported";
  fleet.on_status("Q3", at(2.0));
  EXPECT_NE(course_at(2.49).plan, nullptr);
  const OtherCourse silent = course_at(2.51);
  EXPECT_EQ(silent.plan, nullptr);
  EXPECT_TRUE(silent.reaches_ground);
  EXPECT_NEAR(silent.position_world_m.z(), 1.5, 1e-9);
  fleet.on_status("Q3", at(2.6));
  EXPECT_NE(course_at(2.7).plan, nullptr);
  fleet.on_status("Q9", at(2.6));  // not in the scenario
}

TEST_F(FleetOfQ2, PredictsOtherBodiesAtConstantVelocity) {
  for (double t_s = 0.0; t_s < 0.5; t_s += 0.01) {
    show(t_s, {{"W1", {1.2 * t_s, 0.0, 1.0}}});
  }
  const auto courses = fleet.courses(at(0.49), limits);
  ASSERT_EQ(courses.size(), 1u);
  EXPECT_NEAR(courses[0].velocity_world_mps.x(), 1.2, 0.01);
  EXPECT_EQ(courses[0].prediction_s, limits.other_prediction_s);
  EXPECT_TRUE(courses[0].reaches_ground);
  EXPECT_EQ(fleet.courses(at(3.0), limits)[0].velocity_world_mps.norm(), 0.0) << "not seen";
}

// An unknown body, for example a person, is included under any name, unless this vehicle carries
// the body.
TEST_F(FleetOfQ2, KeepsBodiesWithUnknownNames) {
  show(0.0, {{"Q2", {0, 0, 1}}, {"HELMET", {1.5, 0, 1.7}}, {"GIMBAL", {0.1, 0, 1.0}}});
  auto bodies = fleet.bodies(at(0.0), limits);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0].position_world_m, Eigen::Vector3d(1.5, 0, 1.7));
  EXPECT_EQ(bodies[0].robot, -1);
  EXPECT_TRUE(bodies[0].has_priority);
  EXPECT_EQ(fleet.unknown_bodies(), 2);
  EXPECT_EQ(fleet.courses(at(0.0), limits).size(), 1u);
  EXPECT_EQ(fleet.bodies(at(9.9), limits).size(), 1u) << "occluded or absent";
  EXPECT_EQ(fleet.bodies(at(10.1), limits).size(), 0u) << "gone";
}

TEST_F(FleetOfQ2, KeepsTheNearestUnknownBodiesAndCountsTheRest) {
  std::map<std::string, Eigen::Vector3d> places_m = {{"Q2", {0, 0, 1}}};
  const auto add = [&](const std::string& name, double x_m) {
    places_m[name] = Eigen::Vector3d(x_m, 1.0, 0.0);
  };
  for (int i = 0; i < static_cast<int>(Fleet::kUnknownBodiesMax); ++i) {
    add("A" + std::to_string(i), 1.0 + 0.1 * i);
  }
  show(0.0, places_m);
  EXPECT_EQ(fleet.bodies_dropped(), 0);
  add("B", 3.5);
  show(0.01, places_m);
  EXPECT_EQ(fleet.bodies_dropped(), 1) << "the farthest body is dropped";
  add("C", 0.5);
  show(0.02, places_m);
  const auto bodies = fleet.bodies(at(0.02), limits);
  EXPECT_EQ(bodies.size(), Fleet::kUnknownBodiesMax);
  EXPECT_TRUE(std::any_of(bodies.begin(), bodies.end(),
                          [](const OtherBody& body) { return body.position_world_m.x() == 0.5; }));
}

TEST_F(FleetOfQ2, AllocatesNothingForUnknownBodies) {
  models::MocapFrame frame;
  for (const char* name : {"Q2", "a name that is longer than a string keeps in place",
                           "another name that is longer than a string keeps in place"}) {
    frame.bodies.push_back({name, {}, false});
    frame.bodies.back().world_from_body.translation_m.x() =
        static_cast<double>(frame.bodies.size());
  }
  const test::AllocationCounter counter;
  fleet.on_mocap(frame, limits, at(0.0));
  EXPECT_EQ(fleet.bodies(at(0.0), limits).size(), 2u);
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace vantage::drivers
