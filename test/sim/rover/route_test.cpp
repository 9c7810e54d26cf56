#include "sim/rover/route.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "models/world/grid.hpp"

namespace vantage::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadiusM = 0.2;

models::World room() {
  models::World world;
  world.bounds = {{-1.0, 0.5}, {2.0, 4.5}};
  world.obstacles = {{{{-0.2, 1.8}, {0.4, 2.4}}, 0.5}, {{{1.0, 2.9}, {1.3, 3.2}}, 0.5}};
  return world;
}

/// Returns the length of the cheapest path between open cells, m; infinite if there is none.
/// Relaxes all pairs of neighbours until nothing changes.
double cheapest_m(const models::World& world, const Eigen::Vector2d& from_m,
                  const Eigen::Vector2d& to_m, const std::vector<Disc>& blocked) {
  const auto geometry = models::GridGeometry::covering(world.bounds, 0.1);
  const double needed_m = kRadiusM + 0.05 + 0.1 / std::numbers::sqrt2;
  const auto is_open = [&](int cell) {
    const Eigen::Vector2d centre_m = geometry.centre_m(cell);
    const double clearance_m = models::clearance_m(world, centre_m);
    bool is_free =
        clearance_m >= needed_m || (clearance_m >= kRadiusM && (centre_m - from_m).norm() <= 0.3);
    for (const Disc& disc : blocked) {
      is_free = is_free && (centre_m - disc.centre_m).norm() >= disc.radius_m;
    }
    return is_free;
  };
  const int start = geometry.index_of(from_m);
  const int goal = geometry.index_of(to_m);
  std::vector<double> cost(static_cast<std::size_t>(geometry.size()), kInfinity);
  const auto at = [&](int cell) -> double& { return cost[static_cast<std::size_t>(cell)]; };
  if (!is_open(goal) || models::clearance_m(world, geometry.centre_m(goal)) < needed_m) {
    return kInfinity;
  }
  at(start) = 0.0;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (int cell = 0; cell < geometry.size(); ++cell) {
      if (cell == start || !is_open(cell)) {
        continue;
      }
      for (int other = 0; other < 9; ++other) {
        const int column = cell % geometry.columns + other % 3 - 1;
        const int row = cell / geometry.columns + other / 3 - 1;
        if (column < 0 || row < 0 || column >= geometry.columns || row >= geometry.rows) {
          continue;
        }
        const double step_m = 0.1 * std::hypot(other % 3 - 1, other / 3 - 1);
        const double via_m = at(row * geometry.columns + column) + step_m;
        if (via_m < at(cell) - 1e-12) {
          at(cell) = via_m;
          has_changed = true;
        }
      }
    }
  }
  return at(goal);
}

TEST(RouteMap, FindsTheCheapestRouteOrNone) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const models::World world = room();
  const RouteMap map(world);
  const auto geometry = models::GridGeometry::covering(world.bounds, 0.1);
  const auto place = [&] { return Eigen::Vector2d(-1.0 + 3.0 * u(rng), 0.5 + 4.0 * u(rng)); };
  int found = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Vector2d from_m = place();
    const Eigen::Vector2d to_m = place();
    std::vector<Disc> blocked;
    for (int k = 0; k < trial % 3; ++k) {
      blocked.push_back({place(), 0.3 + 0.5 * u(rng)});
    }
    if (models::clearance_m(world, from_m) < kRadiusM) {
      continue;
    }
    const auto path = map.route(from_m, to_m, kRadiusM, blocked);
    const double expected_m = cheapest_m(world, from_m, to_m, blocked);
    ASSERT_EQ(path.empty(), expected_m == kInfinity) << trial;
    if (path.empty()) {
      continue;
    }
    ++found;
    EXPECT_EQ(path.back(), to_m);
    Eigen::Vector2d last_m = geometry.centre_m(geometry.index_of(from_m));
    double length_m = 0.0;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      EXPECT_LE((path[k] - last_m).norm(), 0.1 * std::numbers::sqrt2 + 1e-9);
      length_m += (path[k] - last_m).norm();
      last_m = path[k];
    }
    EXPECT_NEAR(length_m, expected_m, 1e-9) << trial;
    EXPECT_NEAR((last_m - geometry.centre_m(geometry.index_of(to_m))).norm(), 0.0, 1e-9);
  }
  EXPECT_GT(found, 15);
}

// Start and goal are in the same cell, so the route has no intermediate point.
TEST(RouteMap, LeadsStraightToAGoalInTheSameCell) {
  const RouteMap map(room());
  const auto path = map.route({1.51, 1.51}, {1.57, 1.58}, kRadiusM, {});
  ASSERT_EQ(path.size(), 1u);
  EXPECT_EQ(path[0], Eigen::Vector2d(1.57, 1.58));
}

TEST(RouteMap, HasNoRouteOutsideTheWorldOrIntoADisc) {
  const RouteMap map(room());
  const Eigen::Vector2d inside_m(1.5, 1.5);
  for (const Eigen::Vector2d& outside_m : {Eigen::Vector2d(-1.5, 1.0), Eigen::Vector2d(2.5, 1.0),
                                           Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(1.0, 5.0)}) {
    EXPECT_TRUE(map.route(inside_m, outside_m, kRadiusM, {}).empty());
    EXPECT_TRUE(map.route(outside_m, inside_m, kRadiusM, {}).empty());
  }
  const Eigen::Vector2d goal_m(1.5, 1.0);
  EXPECT_FALSE(map.route(inside_m, goal_m, kRadiusM, {{{1.5, 1.2}, 0.1}}).empty());
  EXPECT_TRUE(
      map.route(inside_m, goal_m, kRadiusM, {{{0.0, 4.0}, 0.1}, {{1.5, 1.0}, 0.2}}).empty());
}

TEST(RouteMap, HasTheStatedCellSize) {
  EXPECT_NEAR(RouteMap(room()).clearance_needed_m(0.3), 0.35 + 0.1 / std::numbers::sqrt2, 1e-12);
  for (const bool is_wide : {true, false}) {
    models::World world;
    world.bounds = {{0.0, 0.0}, {is_wide ? 51.2 : 12.8, is_wide ? 12.8 : 51.2}};
    const RouteMap map(world);
    EXPECT_NEAR(map.clearance_needed_m(0.3), 0.35 + 0.4 / std::numbers::sqrt2, 1e-12);
    const auto path = map.route({2.2, 6.2}, {6.2, 6.2}, 0.2, {});
    ASSERT_EQ(path.size(), 11u);
    EXPECT_NEAR((path[5] - path[4]).norm(), 0.4, 1e-9);
  }
}

// The passage is narrower than routes allow. Its cells are open only within one and a half cells of
// the start. The rover can therefore leave from one large cell inside, but not from two.
TEST(RouteMap, LetsRoverLeaveNarrowPassageWithinOneCell) {
  models::World world;
  world.bounds = {{0.0, 0.0}, {51.2, 12.8}};
  world.obstacles = {{{{0.0, 0.0}, {2.0, 6.0}}, 0.5}, {{{0.0, 7.4}, {2.0, 12.8}}, 0.5}};
  const RouteMap map(world);
  EXPECT_FALSE(map.route({1.8, 6.6}, {6.2, 6.6}, 0.5, {}).empty());
  EXPECT_TRUE(map.route({1.4, 6.6}, {6.2, 6.6}, 0.5, {}).empty());
}

// A rover that is nearer to a wall than routes allow may move away from the wall, but not along it.
TEST(RouteMap, LetsRoverLeaveWall) {
  const RouteMap map(room());
  const Eigen::Vector2d at_wall_m(-0.79, 1.25);
  const auto path = map.route(at_wall_m, {-0.6, 3.5}, kRadiusM, {});
  ASSERT_FALSE(path.empty());
  const double needed_m = map.clearance_needed_m(kRadiusM);
  for (const Eigen::Vector2d& point_m : path) {
    const double clearance_m = models::clearance_m(room(), point_m);
    EXPECT_GE(clearance_m, kRadiusM);
    EXPECT_TRUE(clearance_m >= needed_m || (point_m - at_wall_m).norm() <= 0.3);
  }
  EXPECT_TRUE(map.route(at_wall_m, {-0.76, 3.5}, kRadiusM, {}).empty()) << "a goal too near a wall";
}

}  // namespace
}  // namespace vantage::sim
