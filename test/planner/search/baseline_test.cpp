#include "planner/search/baseline.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage::planner {
namespace {

TEST(LawnMower, CoversTheWholeFloor) {
  const models::Rectangle bounds{{-4.0, -2.0}, {4.0, 2.0}};
  const double range_m = 1.0;
  std::vector<std::vector<Eigen::Vector2d>> paths;
  for (int i = 0; i < 3; ++i) {
    paths.push_back(lawn_mower_waypoints(bounds, i, 3, 1.6 * range_m, 0.5));
  }
  for (double x = -3.5; x <= 3.5; x += 0.25) {
    for (double y = -1.5; y <= 1.5; y += 0.25) {
      double nearest_m = 1e9;
      for (const auto& path : paths) {
        for (std::size_t k = 0; k + 1 < path.size(); ++k) {
          const Eigen::Vector2d d = path[k + 1] - path[k];
          const double s = std::clamp(
              d.squaredNorm() > 0.0 ? (Eigen::Vector2d(x, y) - path[k]).dot(d) / d.squaredNorm()
                                    : 0.0,
              0.0, 1.0);
          nearest_m = std::min(nearest_m, (path[k] + s * d - Eigen::Vector2d(x, y)).norm());
        }
      }
      EXPECT_LT(nearest_m, range_m) << x << " " << y;
    }
  }
}

// The row spacing is the range of the first sensor, for any other sensors.
TEST(LawnMower, SpacesItsRowsByTheFirstSensor) {
  models::World world;
  world.bounds = {{-6.0, -4.0}, {6.0, 4.0}};
  SearchProblem problem;
  problem.world = &world;
  problem.clearance_m = 0.2;
  problem.start = {-5.0, -3.5, 0.0};
  problem.horizon_steps = 8;
  problem.controls = {{1.0, 0.0}, {1.0, 1.0}, {1.0, -1.0}, {0.0, 1.0}, {0.0, -1.0}};
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
  const auto way_with = [&](const std::vector<double>& ranges_m) {
    problem.sensors.clear();
    for (const double range_m : ranges_m) {
      models::SensorModel sensor;
      sensor.range_max_m = range_m;
      problem.sensors.push_back(sensor);
    }
    LawnMower search(SearchCapacity{});
    std::vector<int> way;
    SearchProblem next = problem;
    for (int round = 0; round < 8; ++round) {  // long enough to reach the next row
      const SearchResult& result = search.plan(next, {}, Deadline::never());
      way.insert(way.end(), result.controls.begin(), result.controls.end());
      if (!result.poses.empty()) {
        next.start = result.poses.back();
      }
    }
    return way;
  };
  EXPECT_EQ(way_with({1.0, 4.0}), way_with({1.0}));
  EXPECT_EQ(way_with({4.0, 1.0}), way_with({4.0}));
  EXPECT_NE(way_with({4.0}), way_with({1.0}));
}

// The longer side of the area is cut into strips. Each strip is swept row by row from its lower
// edge and back, with a margin to walls and neighbouring strips.
TEST(LawnMower, SweepsItsStripInBothDirections) {
  for (const bool is_wide : {false, true}) {
    const auto at = [&](double across, double along) {
      return is_wide ? Eigen::Vector2d(along, across) : Eigen::Vector2d(across, along);
    };
    const models::Rectangle bounds{at(-2.0, 1.0), at(4.0, 13.0)};
    const auto way = lawn_mower_waypoints(bounds, 1, 3, 1.5, 0.5);  // strip from 5 m to 9 m
    std::vector<Eigen::Vector2d> expected{at(-1.5, 5.5), at(3.5, 5.5),  at(3.5, 7.0),
                                          at(-1.5, 7.0), at(-1.5, 8.5), at(3.5, 8.5)};
    expected.insert(expected.end(), expected.rbegin(), expected.rend());
    ASSERT_EQ(way.size(), expected.size());
    for (std::size_t i = 0; i < way.size(); ++i) {
      EXPECT_LT((way[i] - expected[i]).norm(), 1e-12) << i;
    }
    // Rows are at most the given distance apart. One row is enough for a strip without a width.
    EXPECT_EQ(lawn_mower_waypoints(bounds, 1, 3, 1.5 - 1e-9, 0.5).size(), 2U * 2U * 4U);
    EXPECT_EQ(lawn_mower_waypoints(bounds, 0, 3, 9.0, 0.5).size(), 2U * 2U * 2U);
    const auto one = lawn_mower_waypoints(bounds, 0, 3, 1.0, 2.5);
    ASSERT_EQ(one.size(), 4U);
    EXPECT_LT((one[0] - at(0.5, 3.0)).norm(), 1e-12);
    EXPECT_LT((one[1] - at(1.5, 3.0)).norm(), 1e-12);
  }
  const auto square = lawn_mower_waypoints({{0.0, 0.0}, {4.0, 4.0}}, 1, 2, 9.0, 0.5);
  EXPECT_LT((square[0] - Eigen::Vector2d(0.5, 2.5)).norm(), 1e-12) << "cut across y";
}

SearchProblem sweeping(const models::World& world) {
  SearchProblem problem;
  problem.world = &world;
  problem.clearance_m = 0.2;
  problem.start = {-2.5, -1.4, 0.0};
  problem.horizon_steps = 6;
  problem.controls = {{1.0, 0.0}, {1.0, 1.5}, {1.0, -1.5}, {0.0, 1.5}, {0.0, -1.5}};
  models::SensorModel sensor;
  sensor.range_max_m = 1.0;
  problem.sensors = {sensor};
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
  return problem;
}

// When one step of each plan is executed, the robot reaches every waypoint in order and starts
// again.
TEST(LawnMower, ReachesWaypointsInOrder) {
  models::World world;
  world.bounds = {{-3.0, -2.0}, {3.0, 2.0}};
  SearchProblem problem = sweeping(world);
  const auto way = lawn_mower_waypoints(world.bounds, 0, 1, 1.6, 0.45);
  LawnMower search(SearchCapacity{});
  std::size_t next = 0;
  std::size_t reached = 0;
  for (int round = 0; round < 200; ++round) {
    while ((way[next] - problem.start.position_m()).norm() < 0.5) {
      next = (next + 1) % way.size();
      ++reached;
    }
    const SearchResult& result = search.plan(problem, {}, Deadline::never());
    ASSERT_TRUE(result.found);
    EXPECT_EQ(result.moving_steps, problem.horizon_steps);
    EXPECT_GE(result.work_nodes, problem.horizon_steps);
    EXPECT_EQ(result.work_nodes, result.nodes_generated);
    problem.start = result.poses.front();
  }
  EXPECT_GT(reached, way.size() + 2) << "the waypoints were not all reached";
}

// A robot that is enclosed skips a waypoint that it cannot reach.
TEST(LawnMower, SkipsUnreachableWaypoint) {
  models::World world;
  world.bounds = {{-3.0, -2.0}, {3.0, 2.0}};
  SearchProblem problem = sweeping(world);
  const SearchProblem free = problem;
  models::World shut_in = world;
  shut_in.obstacles = {{{{-2.2, -2.0}, {-2.0, 2.0}}, 3.0}, {{{-2.8, -2.0}, {-2.75, 2.0}}, 3.0}};
  problem.world = &shut_in;
  problem.start = {-2.5, 0.0, 0.0};
  problem.controls = {{1.0, 0.0}};
  LawnMower search(SearchCapacity{});
  const auto way = lawn_mower_waypoints(world.bounds, 0, 1, 1.6, 0.45);
  for (std::size_t i = 0; i < 3; ++i) {
    const SearchResult& result = search.plan(problem, {}, Deadline::never());
    EXPECT_EQ(result.moving_steps, 0);
    EXPECT_EQ(result.poses, (std::vector<Pose2>(6, problem.start)));
    EXPECT_TRUE(result.controls.empty());
    EXPECT_NEAR(result.cost, score(problem, result.poses), 1e-12);
  }
  // At the fourth waypoint the robot immediately turns to the fifth.
  problem = free;
  problem.start = {way[3].x(), way[3].y(), 0.0};
  const SearchResult& result = search.plan(problem, {}, Deadline::never());
  double nearest_m = 1e9;
  for (const Pose2& pose : result.poses) {
    nearest_m = std::min(nearest_m, (pose.position_m() - way[4]).norm());
  }
  EXPECT_LT(nearest_m, (way[3] - way[4]).norm() - 0.5);
  EXPECT_THROW(
      {
        problem.world = nullptr;
        LawnMower(SearchCapacity{}).plan(problem, {}, Deadline::never());
      },
      UsageError);
}

// All controls are equally likely at each step, and the plan has the stated cost.
TEST(RandomWalk, ChoosesControlsUniformly) {
  SearchProblem problem;
  problem.horizon_steps = 5;
  problem.controls = models::lab_primitives();
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
  RandomWalk search(SearchCapacity{});
  constexpr int kWalks = 2'000;
  std::vector<std::vector<int>> counts(5, std::vector<int>(5, 0));
  for (int i = 0; i < kWalks; ++i) {
    problem.seed = static_cast<std::uint64_t>(i);
    const SearchResult& result = search.plan(problem, {}, Deadline::never());
    ASSERT_EQ(result.controls.size(), 5U);
    EXPECT_EQ(result.nodes_generated, 5) << "no obstacle is in the way";
    for (std::size_t t = 0; t < 5; ++t) {
      ++counts[t][static_cast<std::size_t>(result.controls[t])];
    }
  }
  for (const auto& at_step : counts) {
    for (const int count : at_step) {
      EXPECT_NEAR(count, kWalks / 5, 5.0 * std::sqrt(kWalks * 0.16));
    }
  }
}

}  // namespace
}  // namespace vantage::planner
