#include "planner/search/geodesic.hpp"

#include <cmath>
#include <queue>

#include <gtest/gtest.h>

#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::uniform;

// Reference distances on a fine lattice with edges to all cells within three cells. They exceed the
// shortest distance, by at most 1.3 % in free space.
constexpr double kCell_m = 0.05;
constexpr int kSide = 121;

std::vector<double> lattice_ways(const models::World& world, const Eigen::Vector2d& from_m) {
  const auto place = [](int cell) {
    return Eigen::Vector2d((cell % kSide) * kCell_m, (cell / kSide) * kCell_m);
  };
  std::vector<double> ways(kSide * kSide, std::numeric_limits<double>::infinity());
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
      open;
  const int start = static_cast<int>(std::lround(from_m.y() / kCell_m)) * kSide +
                    static_cast<int>(std::lround(from_m.x() / kCell_m));
  ways[static_cast<std::size_t>(start)] = 0.0;
  open.emplace(0.0, start);
  while (!open.empty()) {
    const auto [way, cell] = open.top();
    open.pop();
    if (way > ways[static_cast<std::size_t>(cell)]) {
      continue;
    }
    for (int dy = -3; dy <= 3; ++dy) {
      for (int dx = -3; dx <= 3; ++dx) {
        const int x = cell % kSide + dx;
        const int y = cell / kSide + dy;
        if (x < 0 || y < 0 || x >= kSide || y >= kSide) {
          continue;
        }
        const int to = y * kSide + x;
        const double next = way + std::hypot(dx, dy) * kCell_m;
        if (next < ways[static_cast<std::size_t>(to)] &&
            models::line_of_sight(world, place(cell), place(to))) {
          ways[static_cast<std::size_t>(to)] = next;
          open.emplace(next, to);
        }
      }
    }
  }
  return ways;
}

TEST(GeodesicTable, IsShortestPathAroundBoxes) {
  std::mt19937_64 rng(17);
  int bent = 0;
  for (int trial = 0; trial < 12; ++trial) {
    models::World world;
    world.bounds = {{0.0, 0.0}, {6.0, 6.0}};
    for (int i = 0; i < 1 + trial % 5; ++i) {
      const Eigen::Vector2d corner(uniform(rng, 0.0, 5.0), uniform(rng, 0.0, 5.0));
      const Eigen::Vector2d size(uniform(rng, 0.2, 3.0), uniform(rng, 0.2, 3.0));
      world.obstacles.push_back({{corner, corner + size}, 10.0});
    }
    const Eigen::Vector2d from_m(std::round(uniform(rng, 0.0, 120.0)) * kCell_m,
                                 std::round(uniform(rng, 0.0, 120.0)) * kCell_m);
    if (models::clearance_m(world, from_m) < 0.01) {
      continue;
    }
    const std::vector<double> lattice = lattice_ways(world, from_m);
    std::vector<Eigen::Vector2d> points;
    std::vector<double> ways;
    for (int i = 0; i < 60; ++i) {
      const int x = test::pick(rng, 0, kSide - 1);
      const int y = test::pick(rng, 0, kSide - 1);
      points.emplace_back(x * kCell_m, y * kCell_m);
      ways.push_back(lattice[static_cast<std::size_t>(y * kSide + x)]);
    }
    GeodesicTable table(64);
    table.reset(&world, points);
    GeodesicTable::VisibleCorners visible;
    table.find_visible_corners(from_m, visible);
    for (int i = 0; i < table.point_count(); ++i) {
      const double path_m = table.path_m(visible, i);
      const double lattice_m = ways[static_cast<std::size_t>(i)];
      if (!std::isfinite(lattice_m)) {
        continue;
      }
      EXPECT_LE(path_m, lattice_m + 1e-9);
      EXPECT_GE(path_m, lattice_m / 1.04 - 4.0 * kCell_m);
      bent += path_m > (points[static_cast<std::size_t>(i)] - from_m).norm() + 0.1 ? 1 : 0;
    }
  }
  EXPECT_GT(bent, 50);
}

TEST(GeodesicTable, IsAMetricForOverlappingBoxes) {
  std::mt19937_64 rng(5);
  models::World world;
  world.bounds = {{0.0, 0.0}, {4.0, 4.0}};
  world.obstacles = {{{{1.0, 0.0}, {1.5, 3.0}}, 10.0},
                     {{{1.4, 2.0}, {3.0, 3.0}}, 10.0},
                     {{{2.5, 3.5}, {3.0, 4.0}}, 10.0}};
  std::vector<Eigen::Vector2d> points;
  while (points.size() < 40) {
    const Eigen::Vector2d p_m(uniform(rng, 0.0, 4.0), uniform(rng, 0.0, 4.0));
    if (models::clearance_m(world, p_m) > 0.0) {
      points.push_back(p_m);
    }
  }
  GeodesicTable table(64);
  table.reset(&world, points);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      EXPECT_NEAR(table.path_between_m(i, j), table.path_between_m(j, i), 1e-9);
      for (int k = 0; k < 40; ++k) {
        EXPECT_LE(table.path_between_m(i, j),
                  table.path_between_m(i, k) + table.path_between_m(k, j) + 1e-9);
      }
    }
  }
  // The path leads around the top of the wall: no path leads below it.
  table.reset(&world, {{0.5, 0.5}, {2.0, 1.0}});
  const double around_m = std::hypot(0.5, 2.5) + 2.0 + 1.0 + std::hypot(1.0, 1.0);
  EXPECT_NEAR(table.path_between_m(0, 1), around_m, 1e-6);
}

// Returns the position, mirrored if `is_mirrored` and then rotated by `quarters` quarter turns.
Eigen::Vector2d transformed(const Eigen::Vector2d& p_m, bool is_mirrored, int quarters) {
  Eigen::Vector2d out = is_mirrored ? Eigen::Vector2d(-p_m.x(), p_m.y()) : p_m;
  for (int i = 0; i < quarters; ++i) {
    out = Eigen::Vector2d(-out.y(), out.x());
  }
  return out;
}

models::Rectangle transformed(const models::Rectangle& box, bool is_mirrored, int quarters) {
  const Eigen::Vector2d a = transformed(box.min_m, is_mirrored, quarters);
  const Eigen::Vector2d b = transformed(box.max_m, is_mirrored, quarters);
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

// No path leads between a box and a wall that it touches, for any wall. The path leads around the
// other end of the box, past two corners. If a point lies outside the walls, a path outside them
// exists.
TEST(GeodesicTable, HasNoPathBetweenBoxAndTouchedWall) {
  for (int which = 0; which < 8; ++which) {
    SCOPED_TRACE(which);
    const auto turned = [&](const auto& it) { return transformed(it, which >= 4, which % 4); };
    models::World world;
    world.bounds = turned(models::Rectangle{{0.0, 0.0}, {4.0, 6.0}});
    world.obstacles = {{turned(models::Rectangle{{1.0, 0.0}, {1.5, 3.0}}), 10.0}};
    const std::vector<Eigen::Vector2d> points{
        turned(Eigen::Vector2d(0.5, 0.5)), turned(Eigen::Vector2d(2.0, 1.0)),
        turned(Eigen::Vector2d(0.5, 5.0)), turned(Eigen::Vector2d(3.0, 5.5))};
    GeodesicTable table(8);
    table.reset(&world, points);
    const double around_m = std::hypot(0.5, 2.5) + 0.5 + std::hypot(0.5, 2.0);
    EXPECT_NEAR(table.path_between_m(0, 1), around_m, 1e-6);
    EXPECT_NEAR(table.path_between_m(1, 0), around_m, 1e-6);
    EXPECT_NEAR(table.path_between_m(2, 3), std::hypot(2.5, 0.5), 1e-9);
    EXPECT_NEAR(table.path_between_m(0, 2), 4.5, 1e-9);
    EXPECT_NEAR(table.path_between_m(2, 1), std::hypot(1.0, 2.0) + std::hypot(0.5, 2.0), 1e-6);
    // Distances are also available from positions other than the points.
    GeodesicTable::VisibleCorners visible;
    table.find_visible_corners(turned(Eigen::Vector2d(0.9, 0.1)), visible);
    EXPECT_NEAR(table.path_m(visible, 1), std::hypot(0.1, 2.9) + 0.5 + std::hypot(0.5, 2.0), 1e-6);

    std::vector<Eigen::Vector2d> with_one_outside = points;
    with_one_outside.push_back(turned(Eigen::Vector2d(2.0, -0.5)));
    table.reset(&world, with_one_outside);
    const double below_m = std::hypot(0.5, 0.5) + 0.5 + std::hypot(0.5, 1.0);
    EXPECT_NEAR(table.path_between_m(0, 1), below_m, 1e-6);
    EXPECT_NEAR(table.path_between_m(0, 4), std::hypot(0.5, 0.5) + std::hypot(1.0, 0.5), 1e-6);
    // Resets the table with the same world, then without a world.
    table.reset(&world, points);
    EXPECT_EQ(table.point_count(), 4);
    EXPECT_NEAR(table.path_between_m(0, 1), around_m, 1e-6);
    table.reset(nullptr, points);
    EXPECT_NEAR(table.path_between_m(0, 1), std::hypot(1.5, 0.5), 1e-9);
    EXPECT_FALSE(table.is_blocked(turned(Eigen::Vector2d(1.2, 1.0))));
    EXPECT_FALSE(table.is_blocked(turned(Eigen::Vector2d(-9.0, 1.0))));
  }
}

TEST(GeodesicTable, ReportsBlockedPositions) {
  models::World world;
  world.bounds = {{-3.0, -2.0}, {3.0, 2.0}};
  world.obstacles = {{{{-1.0, -1.0}, {0.0, 0.5}}, 10.0}, {{{1.0, 0.0}, {2.0, 1.0}}, 10.0}};
  GeodesicTable table(8);
  table.reset(&world, {{0.5, 0.0}});
  constexpr double kLittle_m = 1e-5;
  const auto expect_edges = [&](const models::Rectangle& box, bool is_inside_blocked) {
    const Eigen::Vector2d middle_m = 0.5 * (box.min_m + box.max_m);
    for (int axis = 0; axis < 2; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        Eigen::Vector2d edge_m = middle_m;
        edge_m(axis) += side * 0.5 * (box.max_m - box.min_m)(axis);
        Eigen::Vector2d off_m = Eigen::Vector2d::Zero();
        off_m(axis) = side * kLittle_m;
        EXPECT_EQ(table.is_blocked(edge_m - off_m), is_inside_blocked) << edge_m.transpose();
        EXPECT_EQ(table.is_blocked(edge_m + off_m), !is_inside_blocked) << edge_m.transpose();
        EXPECT_FALSE(table.is_blocked(edge_m)) << "a point on the border is not inside";
      }
    }
  };
  expect_edges(world.bounds, false);
  expect_edges(world.obstacles[0].footprint, true);
  expect_edges(world.obstacles[1].footprint, true);
}

// If there are too many boxes, the largest are kept, for any order. A box without width is ignored.
TEST(GeodesicTable, KeepsTheLargestBoxes) {
  for (const int first : {0, 3, 8}) {
    models::World world;
    world.bounds = {{-50.0, -50.0}, {50.0, 50.0}};
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 9; ++i) {
      const int size = (i + first) % 9;  // 0 is the smallest
      const double half_m = 0.5 + 0.1 * size;
      const Eigen::Vector2d middle_m(10.0 * size - 40.0, 0.0);
      world.obstacles.push_back({{middle_m.array() - half_m, middle_m.array() + half_m}, 10.0});
    }
    for (int size = 0; size < 9; ++size) {
      points.emplace_back(10.0 * size - 40.0, -2.0);
      points.emplace_back(10.0 * size - 40.0, 2.0);
    }
    world.obstacles.push_back({{{-45.0, 1.0}, {45.0, 1.0}}, 10.0});  // without width
    GeodesicTable table(32);
    table.reset(&world, points);
    for (int size = 0; size < 9; ++size) {
      const double half_m = 0.5 + 0.1 * size;
      const double around_m = 2.0 * std::hypot(half_m, 2.0 - half_m) + 2.0 * half_m;
      EXPECT_NEAR(table.path_between_m(2 * size, 2 * size + 1), size == 0 ? 4.0 : around_m, 1e-5)
          << size << " of those from " << first;
    }
  }
}

}  // namespace
}  // namespace vantage::planner
