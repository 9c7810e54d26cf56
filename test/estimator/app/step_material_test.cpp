#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "estimator/app/node.hpp"
#include "estimator/app/replay_node.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/occupancy/mapping_scenario.hpp"

// Tests of the inputs of a step, live and replayed, and of the comparison of two beliefs.

namespace vantage::estimator {
namespace {

using test::instant;

models::RobotBelief some_belief() {
  models::RobotBelief belief =
      test::prior(instant(3), {{Eigen::Vector2d(1.0, -2.0), 0.25 * Eigen::Matrix2d::Identity()},
                               {Eigen::Vector2d(3.0, 4.0), Eigen::Matrix2d::Identity()}});
  belief.degree = 2;
  belief.grid = {{0.0, 1.0}, 0.5, 2, 1};
  belief.last_seen_utime = {7, 8};
  return belief;
}

// Stamp, step number and inputs are not compared.
TEST(SameContent, IsTrueForEqualTargetsAndCells) {
  const models::RobotBelief one = some_belief();
  models::RobotBelief other = one;
  other.stamp.sequence = 9;
  other.step = 4;
  other.inputs.push_back({"VICON", 1, 2});
  EXPECT_TRUE(same_content(one, other, 0.0));
}

TEST(SameContent, IsFalseForAnyDifference) {
  const models::RobotBelief one = some_belief();
  const auto is_another = [&](auto change) {
    models::RobotBelief other = one;
    change(other);
    EXPECT_EQ(same_content(one, other, 1e-9), same_content(other, one, 1e-9));
    return !same_content(one, other, 1e-9);
  };
  using models::RobotBelief;
  EXPECT_FALSE(is_another([](RobotBelief&) {}));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.stamp.time += Duration{1}; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.degree = 1; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.grid.origin_m.x() += 1.0; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.last_seen_utime[1] = 9; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.targets.pop_back(); }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.targets.push_back(b.targets[0]); }));
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].target_id = 5; }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].last_seen += Duration{1}; }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].information.vector.setZero(4); }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].information.matrix.resize(2, 3); }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].information.matrix.resize(3, 2); }));
  }
}

// Each number may differ by tolerance × (1 + its magnitude), in either direction.
TEST(SameContent, AllowsARelativeTolerance) {
  constexpr double kTolerance = 1e-3;
  const models::RobotBelief one = some_belief();
  for (const double side : {-1.0, 1.0}) {
    for (const auto& [share, is_same] : {std::pair(0.99, true), std::pair(1.01, false)}) {
      for (const std::size_t i : {0U, 1U}) {
        for (const Eigen::Index row : {0, 1}) {
          models::RobotBelief other = one;
          double& number = other.targets[i].information.vector(row);
          const double logged = number;
          number += side * share * kTolerance * (1.0 + std::abs(logged));
          EXPECT_EQ(same_content(other, one, kTolerance), is_same) << logged;
          other = one;
          double& entry = other.targets[i].information.matrix(row, row);
          entry += side * share * kTolerance * (1.0 + std::abs(entry));
          EXPECT_EQ(same_content(other, one, kTolerance), is_same);
        }
      }
    }
  }
}

TEST(OwnPose, IsTheVisiblePoseOfTheRobot) {
  models::MocapFrame frame;
  frame.stamp.time = instant(2);
  frame.bodies = {{"Q1", lift({1.0, 2.0, 0.5}, 1.5), false},
                  {"Q2", lift({3.0, 4.0, -0.5}, 0.7), true}};
  for (const std::size_t hint : {0U, 1U, 9U}) {
    const auto pose = own_pose(frame, "Q1", hint);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->time, instant(2));
    EXPECT_NEAR(pose->viewpoint.world_from_body.y_m, 2.0, 1e-12);
    EXPECT_NEAR(pose->viewpoint.height_m, 1.5, 1e-12);
    EXPECT_FALSE(own_pose(frame, "Q2", hint)) << "occluded";
    EXPECT_FALSE(own_pose(frame, "Q3", hint)) << "not in the frame";
  }
}

TEST(HasViewpoint, IsTrueForAMeasurementWithinTheStep) {
  const Duration step = from_seconds(0.5);
  const auto has = [&](const char* robot, Time time) {
    models::RobotMeasurement look;
    look.robot = robot;
    look.stamp.time = time;
    return has_viewpoint({{{}, std::make_shared<const models::RobotMeasurement>(look)}}, "Q1",
                         instant(3), step);
  };
  EXPECT_TRUE(has("Q1", instant(3)));
  EXPECT_TRUE(has("Q1", instant(2) + Duration{1}));
  EXPECT_FALSE(has("Q1", instant(2)));
  EXPECT_FALSE(has("Q1", instant(3) + Duration{1}));
  EXPECT_FALSE(has("Q2", instant(3)));
}

// The robot's newest own observation gives the viewpoint, even if teammates observed later.
TEST(MakeStep, UsesTheLastViewpoint) {
  FilterSpec spec = test::open_spec({models::TargetKind::kStatic, 2, 0.0},
                                    test::far_sighted(models::SensorKind::kPosition), 1);
  spec.start = test::at(9.0, 9.0);
  DistributedFilter filter(spec);
  StepMaterial material;
  const auto add = [&](const char* robot, Time time, double x_m) {
    models::RobotMeasurement look;
    look.robot = robot;
    look.stamp.time = time;
    look.viewpoint = test::at(x_m, 0.0);
    const auto number = static_cast<std::int64_t>(material.measurements.size());
    material.measurements.push_back(
        {{"MEASUREMENT_Q1", 3, number}, std::make_shared<const models::RobotMeasurement>(look)});
  };
  add("Q1", instant(2), 1.0);  // belongs to the previous step
  add("Q1", instant(3) - Duration{9}, 2.0);
  add("Q1", instant(3) - Duration{20}, 3.0);
  add("Q2", instant(3), 4.0);
  add("Q1", instant(3) + Duration{1}, 5.0);  // belongs to the next step
  const models::RobotBelief made = make_step(filter, instant(3), 7, material);
  EXPECT_EQ(made.viewpoint.world_from_body.x_m, 2.0);
  EXPECT_EQ(made.step, 7);
  EXPECT_EQ(made.stamp.time, instant(3));
  EXPECT_EQ(made.inputs.size(), 5U);
  EXPECT_FALSE(mixture_of(filter, made)) << "no mixture to publish";
}

scenario::Scenario lone_robot() {
  scenario::Scenario scenario = vantage::test::mapping_scenario({"Q1"});
  scenario.planner.objective = scenario::PlanObjective::kTracking;
  return scenario;
}

/// Returns the time `s` after a multiple of 0.5 s.
Time after_an_instant(double s) { return from_utime(1'700'000'000'000'000) + from_seconds(s); }

TEST(EstimatorNode, StartsWithTheFirstUnpublishedStep) {
  bus::InProcessHub hub;
  const auto end = hub.connect();
  bus::Bus bus(*end, 1);
  const scenario::Scenario scenario = lone_robot();
  for (const auto& [now_s, first_s] :
       {std::pair(-0.02, 0.0), std::pair(0.02, 0.0), std::pair(0.06, 0.5)}) {
    const bus::VirtualClock clock{after_an_instant(now_s)};
    EstimatorNode node(bus, clock, scenario, "Q1");
    EXPECT_EQ(node.next_tick(), after_an_instant(first_s + 0.05)) << now_s;
    node.tick(node.next_tick() - Duration{1});  // too early: nothing happens
    EXPECT_EQ(node.next_tick(), after_an_instant(first_s + 0.05));
    EXPECT_TRUE(node.counters().empty());
    node.tick(node.next_tick());
    EXPECT_EQ(node.next_tick(), after_an_instant(first_s + 0.55));
    EXPECT_EQ(node.deadlines_missed(), 0);
  }
}

// A map follows each belief only if the scenario has the mapping objective. Both are replayed.
TEST(EstimatorNode, PublishesMapsIfTheScenarioHasMapping) {
  for (const bool maps : {false, true}) {
    scenario::Scenario scenario = lone_robot();
    if (maps) {
      scenario.planner.objective = scenario::PlanObjective::kMapping;
    }
    bus::InProcessHub hub;
    const auto end = hub.connect();
    const auto other_end = hub.connect();
    const auto replay_end = hub.connect();
    bus::Bus bus(*end, 1);
    bus::Bus receiver(*other_end, 2);
    bus::Bus replay_bus(*replay_end, 3, "REPLAY_");
    bus::VirtualClock clock{after_an_instant(0.02)};
    EstimatorNode node(bus, clock, scenario, "Q1");
    EstimatorReplayNode replay(replay_bus, clock, scenario, "Q1");
    EXPECT_EQ(replay.name(), "REPLAY_ESTIMATOR_Q1");
    EXPECT_EQ(replay.next_tick(), clock.now() + bus::kReplayTick);
    std::vector<models::RobotMap> made;
    std::vector<models::RobotMap> again;
    receiver.subscribe<models::RobotMap>(bus::map_channel("Q1"),
                                         [&](const auto& map) { made.push_back(map); });
    receiver.subscribe<models::RobotMap>(bus::Channel<models::RobotMap>{"REPLAY_MAP_Q1"},
                                         [&](const auto& map) { again.push_back(map); });
    models::RangeScan strange;
    strange.stamp.time = after_an_instant(0.0);
    strange.robot = "Q1";
    strange.field_of_view_rad = 1.0;
    strange.range_max_m = 3.0;
    strange.ranges_m = {1.0};
    receiver.publish(bus::scan_channel("Q1"), strange);
    const auto deliver = [&] {
      while (bus.handle(std::chrono::microseconds(0)) +
                 receiver.handle(std::chrono::microseconds(0)) +
                 replay_bus.handle(std::chrono::microseconds(0)) >
             0) {
      }
    };
    deliver();
    node.tick(node.next_tick());
    deliver();
    const Time later = clock.now() + from_seconds(0.25);
    replay.tick(later);
    deliver();
    EXPECT_EQ(replay.next_tick(), later + bus::kReplayTick);
    EXPECT_EQ(replay.steps_redone(), 1);
    EXPECT_EQ(made.size(), maps ? 1U : 0U);
    EXPECT_EQ(again.size(), maps ? 1U : 0U);
    const auto has = [](const std::vector<models::NamedCount>& counters, const char* name) {
      return std::any_of(counters.begin(), counters.end(),
                         [&](const auto& each) { return each.name == name; });
    };
    EXPECT_TRUE(has(node.counters(), "viewpoint_unknown"));
    EXPECT_EQ(has(node.counters(), "map.malformed_scans"), maps);
    EXPECT_EQ(has(replay.counters(), "map.malformed_scans"), maps);
  }
}

}  // namespace
}  // namespace vantage::estimator
