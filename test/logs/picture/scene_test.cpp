#include "logs/picture/scene.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

models::TruthFrame truth(double at_s, const std::string& name, int target_id,
                         const Eigen::Vector2d& at_m) {
  models::TruthFrame out;
  out.stamp.time = kStart + from_seconds(at_s);
  out.bodies = {{name, target_id, lift({at_m.x(), at_m.y(), 0.5}, 1.0), Eigen::Vector3d::Zero()}};
  return out;
}

scenario::Scenario a_scenario() {
  scenario::Scenario out;
  out.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  out.robots.resize(2);
  out.robots[0].name = "Q1";
  out.robots[1].name = "Q2";
  out.targets = {{"R1", 3, {}, 0.2}};
  return out;
}

TEST(SceneRecorder, ThinsTracksByTimeAndDistance) {
  for (const int target_id : {-1, 3}) {
    SceneRecorder recorder(a_scenario());
    const auto points = [&] {
      const Scene& scene = recorder.scene();
      const auto& track = target_id < 0 ? scene.robots.at("Q1").track : scene.targets.at(3).track;
      return track.size();
    };
    const auto add = [&](double at_s, double x_m, double y_m) {
      recorder.on_truth(truth(at_s, "Q1", target_id, {x_m, y_m}));
    };
    EXPECT_EQ(points(), 0U);
    add(0.0, 1.0, 2.0);
    EXPECT_EQ(points(), 1U);
    add(0.09, 5.0, 2.0);
    EXPECT_EQ(points(), 1U) << "too soon";
    add(0.11, 1.0, 2.019);
    EXPECT_EQ(points(), 1U) << "too near";
    add(0.11, 1.0, 1.979);
    EXPECT_EQ(points(), 2U);
    EXPECT_EQ(recorder.scene().robots.size(), 2U);
    EXPECT_EQ(recorder.scene().targets.size(), 1U);
    EXPECT_EQ(recorder.scene().robots.at("Q1").world_from_body.has_value(), target_id < 0);
    if (target_id < 0) {
      add(0.12, 7.0, 8.0);
      const Pose2 pose = *recorder.scene().robots.at("Q1").world_from_body;
      EXPECT_NEAR(pose.x_m, 7.0, 1e-12) << "current position";
      EXPECT_NEAR(pose.y_m, 8.0, 1e-12);
      EXPECT_NEAR(pose.yaw_rad, 0.5, 1e-12);
      const TrackPoint& last = recorder.scene().robots.at("Q1").track.back();
      EXPECT_EQ(last.time, kStart + from_seconds(0.11));
      EXPECT_NEAR(last.position_m.y(), 1.979, 1e-12);
    }
  }
}

// A point is at least 0.1 s after the previous point and at least 2 cm from it.
TEST(SceneRecorder, KeepsAPointPerTenthOfASecondOrTwoCentimetres) {
  for (const double speed_mps : {0.04, 0.1, 0.25, 1.0}) {
    SceneRecorder recorder(a_scenario());
    for (int i = 0; i <= 500; ++i) {  // back and forth, 50 frames per second
      const double distance_m = speed_mps * 0.02 * i;
      const double x_m = std::abs(std::remainder(distance_m, 0.8));
      recorder.on_truth(truth(0.02 * i, "Q1", -1, {x_m, 0.0}));
    }
    const auto& track = recorder.scene().robots.at("Q1").track;
    const double apart_s = std::max(0.1, 0.02 / speed_mps);
    for (std::size_t i = 1; i < track.size(); ++i) {
      const double passed_s = to_seconds(track[i].time - track[i - 1].time);
      EXPECT_GE(passed_s, 0.1 - 1e-9) << speed_mps;
      EXPECT_GE((track[i].position_m - track[i - 1].position_m).norm(), 0.02 - 1e-9);
      EXPECT_LE(passed_s, 2.0 * apart_s + 0.021) << speed_mps;  // twice as long at a reversal
    }
    EXPECT_GT(track.size(), 0.8 * 10.0 / (apart_s + 0.02));
  }
}

// A full track is thinned; all other tracks remain unchanged.
TEST(SceneRecorder, ThinsOnlyFullTracks) {
  SceneRecorder recorder(a_scenario());
  for (int i = 0; i < 4100; ++i) {
    recorder.on_truth(truth(0.1 * i, "Q1", -1, {0.1 * i, 0.0}));
  }
  for (int i = 0; i < 10; ++i) {
    recorder.on_truth(truth(0.1 * i, "Q2", -1, {0.0, 0.1 * i}));
  }
  const auto& track = recorder.scene().robots.at("Q1").track;
  ASSERT_EQ(track.size(), 2048U + 2U) << "every second of 4096 points, then points 4097 and 4099";
  for (std::size_t i = 0; i < track.size(); ++i) {
    EXPECT_NEAR(track[i].position_m.x(), 0.2 * static_cast<double>(i), 1e-9);
  }
  EXPECT_EQ(recorder.scene().robots.at("Q2").track.size(), 10U);
}

models::RobotBelief belief(double at_s, const models::GridGeometry& grid,
                           std::vector<std::int64_t> seen) {
  models::RobotBelief out;
  out.stamp.time = kStart + from_seconds(at_s);
  out.grid = grid;
  out.last_seen_utime = std::move(seen);
  return out;
}

TEST(SceneRecorder, StatesTheNewestTimeOfAnyMessage) {
  SceneRecorder recorder(a_scenario());
  models::RobotMap map;
  recorder.on_belief(belief(3.0, {}, {}));
  EXPECT_EQ(recorder.scene().time, kStart + from_seconds(3.0));
  recorder.on_truth(truth(2.0, "Q1", -1, {0.0, 0.0}));
  EXPECT_EQ(recorder.scene().time, kStart + from_seconds(3.0));
  recorder.on_truth(truth(4.0, "Q1", -1, {0.0, 0.0}));
  EXPECT_EQ(recorder.scene().time, kStart + from_seconds(4.0));
  map.stamp.time = kStart + from_seconds(5.0);
  recorder.on_map(map);
  EXPECT_EQ(recorder.scene().time, kStart + from_seconds(5.0));
  recorder.on_belief(belief(3.0, {}, {}));
  map.stamp.time = kStart;
  recorder.on_map(map);
  EXPECT_EQ(recorder.scene().time, kStart + from_seconds(5.0));
}

TEST(SceneRecorder, HasTheNewestObservationPerCell) {
  SceneRecorder recorder(a_scenario());
  const models::GridGeometry grid{{-4.0, -2.0}, 1.0, 3, 1};
  recorder.on_belief(belief(1.0, grid, {5, 0, 7}));
  recorder.on_belief(belief(2.0, grid, {4, 9, 8}));
  EXPECT_TRUE(recorder.scene().grid == grid);
  EXPECT_EQ(recorder.scene().last_seen_utime, (std::vector<std::int64_t>{5, 9, 8}));
  const models::GridGeometry other{{-4.0, -2.0}, 0.5, 2, 1};
  recorder.on_belief(belief(3.0, other, {1, 2}));
  EXPECT_EQ(recorder.scene().last_seen_utime, (std::vector<std::int64_t>{1, 2}));
}

// With neighbourhoods, each belief covers a part of the grid; cells outside this part keep their
// values.
TEST(SceneRecorder, MergesNeighbourhoodGrids) {
  scenario::Scenario scenario = a_scenario();
  scenario.network.neighbourhood_m = 2.0;
  scenario.estimator.grid_resolution_m = 1.0;
  SceneRecorder recorder(scenario);
  const models::GridGeometry whole = models::GridGeometry::covering(scenario.world.bounds, 1.0);
  recorder.on_belief(belief(1.0, {{-4.0, -2.0}, 1.0, 1, 1}, {5}));
  recorder.on_belief(belief(2.0, {{2.0, 1.0}, 1.0, 2, 1}, {6, 7}));
  std::vector<std::int64_t> wanted(32, models::VisibilityGrid::kNeverSeen);
  wanted[0] = 5;
  wanted[30] = 6;
  wanted[31] = 7;
  EXPECT_TRUE(recorder.scene().grid == whole);
  EXPECT_EQ(recorder.scene().last_seen_utime, wanted);
}

TEST(SceneRecorder, HasTheLastMapsPlansAndAttacks) {
  SceneRecorder recorder(a_scenario());
  models::RobotMap map;
  for (const auto& [robot, nats] : {std::pair{"Q1", 9.0}, {"Q2", 8.0}, {"Q1", 7.0}}) {
    map.robot = robot;
    map.entropy_nats = nats;
    recorder.on_map(map);
  }
  ASSERT_TRUE(recorder.scene().map);
  EXPECT_EQ(recorder.scene().map->robot, "Q1");
  EXPECT_EQ(recorder.scene().map->entropy_nats, 7.0);
  EXPECT_EQ(recorder.scene().map_entropies_nats,
            (std::map<std::string, double>{{"Q1", 7.0}, {"Q2", 8.0}}));
  models::RobotPlan plan;
  plan.robot = "Q2";
  for (plan.round = 1; plan.round <= 2; ++plan.round) {
    recorder.on_plan(plan);
  }
  EXPECT_EQ(recorder.scene().robots.at("Q2").plan->round, 2);
  EXPECT_FALSE(recorder.scene().robots.at("Q1").plan);
  recorder.on_attack({{}, {"Q1", "Q2"}});
  EXPECT_EQ(recorder.scene().jammed.size(), 2U);
  recorder.on_attack({{}, {"Q2"}});
  EXPECT_EQ(recorder.scene().jammed, (std::set<std::string>{"Q2"}));
}

}  // namespace
}  // namespace vantage::logs
