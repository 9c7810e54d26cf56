#include "models/world/grid.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

World world_with_boxes() {
  return {{{-1.0, 2.0}, {7.0, 6.3}},
          3.0,
          {{{{0.0, 3.0}, {1.0, 4.0}}, 1.0}, {{{3.3, 2.9}, {4.1, 5.2}}, 1.0}},
          {}};
}

TEST(GridGeometry, CoversTheBoundsWithWholeCells) {
  const GridGeometry grid = GridGeometry::covering({{-1.0, 2.0}, {7.0, 6.3}}, 0.25);
  EXPECT_EQ(grid.columns, 32);
  EXPECT_EQ(grid.rows, 18);  // 17.2 cells, rounded up
  EXPECT_EQ(grid.size(), 576);
  EXPECT_EQ(GridGeometry::covering({{0, 0}, {0.3, 0.9}}, 0.1).columns, 3);  // not rounded up to 4
}

TEST(GridGeometry, RefusesEmptyCellsAndBounds) {
  EXPECT_THROW((void)GridGeometry::covering({{0, 0}, {1, 1}}, 0.0), UsageError);
  EXPECT_THROW((void)GridGeometry::covering({{0, 0}, {1, 1}}, std::nan("")), UsageError);
  EXPECT_THROW((void)GridGeometry::covering({{0, 0}, {0, 1}}, 0.1), UsageError);
  EXPECT_THROW((void)GridGeometry::covering({{0, 0}, {1e6, 1e6}}, 1e-3), UsageError);
}

TEST(GridGeometry, FindsEveryCellByItsCentre) {
  const GridGeometry grid = GridGeometry::covering({{-1.0, 2.0}, {7.0, 6.3}}, 0.25);
  for (int index = 0; index < grid.size(); ++index) {
    ASSERT_EQ(grid.index_of(grid.centre_m(index)), index);
  }
}

TEST(GridGeometry, IsRowMajorFromTheMinimumCorner) {
  const GridGeometry grid{{10.0, 20.0}, 0.5, 4, 3};
  EXPECT_TRUE(test::is_near(grid.centre_m(0), Eigen::Vector2d(10.25, 20.25), 1e-15));
  EXPECT_TRUE(test::is_near(grid.centre_m(1), Eigen::Vector2d(10.75, 20.25), 1e-15));
  EXPECT_TRUE(test::is_near(grid.centre_m(4), Eigen::Vector2d(10.25, 20.75), 1e-15));
}

TEST(GridGeometry, ContainsExactlyTheClosedBounds) {
  const Rectangle bounds{{-1.0, 2.0}, {7.0, 6.3}};
  const GridGeometry grid = GridGeometry::covering(bounds, 0.25);
  test::Random random(41);
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Vector2d p_m = random.vector<2>(-10.0, 10.0);
    const int index = grid.index_of(p_m);
    if (bounds.contains(p_m)) {
      ASSERT_GE(index, 0);
    }
    if (index >= 0) {
      ASSERT_LE((grid.centre_m(index) - p_m).cwiseAbs().maxCoeff(), 0.125 + 1e-12);
    }
  }
  EXPECT_EQ(grid.index_of(bounds.min_m), 0);
  EXPECT_EQ(grid.index_of({7.0, 2.0}), 31);
  EXPECT_EQ(grid.index_of({7.0 + 1e-9, 2.0}), -1);
  EXPECT_EQ(grid.index_of({-1.0 - 1e-9, 2.0}), -1);
  EXPECT_EQ(grid.index_of({std::nan(""), 2.0}), -1);
}

TEST(Rasterise, MarksCellsThatOverlapAnObstacle) {
  const World world = world_with_boxes();
  const OccupancyGrid grid = rasterise(world, 0.25);
  ASSERT_EQ(grid.occupied.size(), static_cast<std::size_t>(grid.geometry.size()));
  for (int index = 0; index < grid.geometry.size(); ++index) {
    const Eigen::Vector2d low_m = grid.geometry.centre_m(index).array() - 0.125;
    const Eigen::Vector2d high_m = grid.geometry.centre_m(index).array() + 0.125;
    bool overlaps = false;
    for (const Obstacle& obstacle : world.obstacles) {
      const Eigen::Vector2d shared_m =
          high_m.cwiseMin(obstacle.footprint.max_m) - low_m.cwiseMax(obstacle.footprint.min_m);
      overlaps = overlaps || shared_m.minCoeff() > 1e-9;
    }
    ASSERT_EQ(grid.occupied[static_cast<std::size_t>(index)] != 0, overlaps) << index;
  }
}

TEST(Rasterise, ClipsObstaclesAtTheBounds) {
  const World world{
      {{0, 0}, {1, 1}}, 3.0, {{{{-5, 0.5}, {0.3, 9}}, 1.0}, {{{2, 2}, {3, 3}}, 1.0}}, {}};
  const OccupancyGrid grid = rasterise(world, 0.25);
  int occupied = 0;
  for (const std::uint8_t cell : grid.occupied) {
    occupied += cell;
  }
  EXPECT_EQ(occupied, 4);  // two columns by two rows
}

TEST(DistanceField, IsALowerBoundOfTheClearance) {
  const World world = world_with_boxes();
  for (const double resolution_m : {0.05, 0.25, 1.0}) {
    const DistanceField field(world, resolution_m);
    test::Random random(42);
    for (int i = 0; i < 50'000; ++i) {
      const Eigen::Vector2d p_m(random.uniform(-1.0, 7.0), random.uniform(2.0, 6.3));
      const double exact_m = clearance_m(world, p_m);
      const double bound_m = field.lower_bound_m(p_m);
      ASSERT_LE(bound_m, exact_m);
      ASSERT_GE(bound_m, exact_m - resolution_m * std::sqrt(2.0) - 1e-5);  // the bound is tight
    }
  }
}

TEST(DistanceField, IsMinusOneOutside) {
  const DistanceField field(world_with_boxes(), 0.25);
  EXPECT_EQ(field.lower_bound_m({-1.1, 3.0}), -1.0);
  EXPECT_EQ(field.lower_bound_m({1e9, 3.0}), -1.0);
  EXPECT_EQ(DistanceField{}.lower_bound_m({0.1, 0.1}), -1.0);
}

}  // namespace
}  // namespace vantage::models
