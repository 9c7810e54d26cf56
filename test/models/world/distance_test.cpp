#include <cmath>

#include <gtest/gtest.h>

#include "models/world/world.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

Rectangle random_box(test::Random& random) {
  const Eigen::Vector2d min_m = random.vector<2>(0.5, 7.0);
  return {min_m, min_m + random.vector<2>(0.1, 2.5)};
}

World random_world(test::Random& random, int obstacles) {
  World world{{{0.0, 0.0}, {10.0, 10.0}}, 3.0, {}, {}};
  for (int i = 0; i < obstacles; ++i) {
    world.obstacles.push_back({random_box(random), 2.0});
  }
  return world;
}

// Returns the least distance from `p_m` to points at a spacing of `step_m` on the border of `box`,
// m.
double border_distance_m(const Rectangle& box, const Eigen::Vector2d& p_m, double step_m) {
  double least_m = INFINITY;
  const Eigen::Vector2d size_m = box.max_m - box.min_m;
  const int steps = static_cast<int>(size_m.maxCoeff() / step_m) + 1;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d along_m = box.min_m + size_m * (static_cast<double>(i) / steps);
    for (const Eigen::Vector2d& q_m :
         {Eigen::Vector2d(along_m.x(), box.min_m.y()), Eigen::Vector2d(along_m.x(), box.max_m.y()),
          Eigen::Vector2d(box.min_m.x(), along_m.y()),
          Eigen::Vector2d(box.max_m.x(), along_m.y())}) {
      least_m = std::min(least_m, (q_m - p_m).norm());
    }
  }
  return least_m;
}

TEST(Clearance, IsTheSignedDistanceToTheNearestBorder) {
  test::Random random(31);
  for (int i = 0; i < 2000; ++i) {
    const World world = random_world(random, i % 4);
    const Eigen::Vector2d p_m = random.vector<2>(-1.0, 11.0);
    const double wall_m = border_distance_m(world.bounds, p_m, 0.01);
    double expected_m = world.bounds.contains(p_m) ? wall_m : -wall_m;
    for (const Obstacle& obstacle : world.obstacles) {
      const double border_m = border_distance_m(obstacle.footprint, p_m, 0.01);
      expected_m = std::min(expected_m, obstacle.footprint.contains(p_m) ? -border_m : border_m);
    }
    ASSERT_NEAR(clearance_m(world, p_m), expected_m, 0.011);
  }
}

TEST(Clearance, EqualsTheClosedFormAroundOneBox) {
  const World world{{{-10, -10}, {10, 10}}, 3.0, {{{{-1, -2}, {1, 2}}, 1.0}}, {}};
  EXPECT_EQ(clearance_m(world, {3.0, 0.0}), 2.0);
  EXPECT_DOUBLE_EQ(clearance_m(world, {4.0, 6.0}), 4.0);  // the wall is nearer than the corner
  EXPECT_DOUBLE_EQ(clearance_m(world, {4.0, -6.0}), 4.0);
  EXPECT_EQ(clearance_m(world, {0.5, 0.0}), -0.5);
  EXPECT_EQ(clearance_m(world, {1.0, 0.0}), 0.0);
  EXPECT_EQ(clearance_m(world, {9.0, 0.0}), 1.0);
  EXPECT_EQ(clearance_m(world, {13.0, 14.0}), -5.0);  // 3-4-5 from the corner of the bounds
}

TEST(Clearance, IsLipschitzWithConstantOne) {
  test::Random random(32);
  for (int i = 0; i < 20'000; ++i) {
    const World world = random_world(random, 3);
    const Eigen::Vector2d a_m = random.vector<2>(-1.0, 11.0);
    const Eigen::Vector2d b_m = a_m + random.vector<2>(-0.5, 0.5);
    ASSERT_LE(std::abs(clearance_m(world, a_m) - clearance_m(world, b_m)),
              (a_m - b_m).norm() + 1e-12);
  }
}

TEST(NearbyObstacles, SufficeForTheClearanceNearby) {
  test::Random random(35);
  int left_out = 0;
  int too_many = 0;
  for (int i = 0; i < 2'000; ++i) {
    const World world = random_world(random, i % 2 == 0 ? 12 : 40);
    const Eigen::Vector2d centre_m = random.vector<2>(0.0, 10.0);
    const double reach_m = random.uniform(0.2, 4.0);
    const NearbyObstacles nearby = nearby_obstacles(world, centre_m, reach_m);
    left_out += nearby.count < world.obstacles.size() ? 1 : 0;
    too_many += nearby.is_complete ? 0 : 1;
    for (int k = 0; k < 10; ++k) {
      const Eigen::Vector2d p_m = centre_m + random.vector<2>(-1.0, 1.0) * reach_m;
      const double limit_m = reach_m - (p_m - centre_m).norm();
      const double known_m = clearance_m(world, nearby, p_m);
      const double true_m = clearance_m(world, p_m);
      ASSERT_GE(known_m, true_m);
      if (true_m < limit_m) {
        ASSERT_EQ(known_m, true_m);
      }
    }
  }
  EXPECT_GT(left_out, 1000);
  EXPECT_GT(too_many, 0);
}

TEST(LineOfSight, AgreesWithDenseSampling) {
  test::Random random(33);
  int hidden = 0;
  for (int i = 0; i < 5000; ++i) {
    const World world = random_world(random, 2);
    const Eigen::Vector2d a_m = random.vector<2>(0.0, 10.0);
    const Eigen::Vector2d b_m = random.vector<2>(0.0, 10.0);
    double deepest_m = -INFINITY;  // m; > 0: a sample is inside an obstacle
    for (int k = 0; k <= 2000; ++k) {
      const Eigen::Vector2d p_m = a_m + (k / 2000.0) * (b_m - a_m);
      for (const Obstacle& obstacle : world.obstacles) {
        const Eigen::Vector2d inner_m =
            (p_m - obstacle.footprint.min_m).cwiseMin(obstacle.footprint.max_m - p_m);
        deepest_m = std::max(deepest_m, inner_m.minCoeff());
      }
    }
    const bool seen = line_of_sight(world, a_m, b_m);
    ASSERT_EQ(seen, line_of_sight(world, b_m, a_m));
    if (deepest_m > 0.0) {
      ASSERT_FALSE(seen);
    }
    if (deepest_m < -0.01) {  // samples are at most 0.0071 m apart
      ASSERT_TRUE(seen);
    }
    hidden += seen ? 0 : 1;
  }
  EXPECT_GT(hidden, 500);
  EXPECT_LT(hidden, 4500);
}

TEST(LineOfSight, MayGrazeEdgesAndCorners) {
  const World world{{{-10, -10}, {10, 10}}, 3.0, {{{{-1, -1}, {1, 1}}, 1.0}}, {}};
  EXPECT_TRUE(line_of_sight(world, {-5, 1}, {5, 1}));  // along an edge
  EXPECT_TRUE(line_of_sight(world, {1, -5}, {1, 5}));
  EXPECT_TRUE(line_of_sight(world, {-2, 0}, {0, -2}));  // through the corner (−1, −1)
  EXPECT_TRUE(line_of_sight(world, {0, 2}, {2, 0}));
  EXPECT_TRUE(line_of_sight(world, {0, 3}, {0, 1}));  // ends on the border
  EXPECT_FALSE(line_of_sight(world, {0, 3}, {0, 0.999}));
  EXPECT_FALSE(line_of_sight(world, {-1, -1}, {1, 1}));  // corner to corner, through the middle
  EXPECT_FALSE(line_of_sight(world, {0, 0}, {0, 0}));    // a point inside
  EXPECT_TRUE(line_of_sight(world, {1, 1}, {1, 1}));
  EXPECT_FALSE(line_of_sight(world, {-0.9, -3}, {-0.9, 3}));
}

TEST(SweptClearance, IsLeastClearanceAlongPath) {
  test::Random random(34);
  for (int i = 0; i < 5000; ++i) {
    const World world = random_world(random, 3);
    const Eigen::Vector2d a_m = random.vector<2>(0.0, 10.0);
    const Eigen::Vector2d b_m = a_m + random.vector<2>(-2.0, 2.0);
    double least_m = INFINITY;
    for (int k = 0; k <= 1000; ++k) {
      least_m = std::min(least_m, clearance_m(world, a_m + (k / 1000.0) * (b_m - a_m)));
    }
    const double swept_m = swept_clearance_m(world, a_m, b_m);
    if (least_m > 0.0 && swept_m > 0.0) {
      ASSERT_LE(swept_m, least_m + 1e-12);
      ASSERT_GE(swept_m, least_m - 0.0015);  // half the spacing of the samples
    } else {
      ASSERT_LE(swept_m, 0.0);
      ASSERT_LE(least_m, 0.0015);
    }
  }
}

TEST(SweptClearance, DetectsAThinWallBetweenSamples) {
  const World world{{{-10, -10}, {10, 10}}, 3.0, {{{{0, -1}, {1e-6, 1}}, 1.0}}, {}};
  EXPECT_LE(swept_clearance_m(world, {-1, 0}, {1, 0}), 0.0);
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {-1, 2}, {1, 2}), 1.0);
}

TEST(ClosestApproach, IsTheLeastDistanceAtEqualTimes) {
  test::Random random(35);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d a0 = random.vector<3>(-2.0, 2.0);
    const Eigen::Vector3d a1 = random.vector<3>(-2.0, 2.0);
    const Eigen::Vector3d b0 = random.vector<3>(-2.0, 2.0);
    const Eigen::Vector3d b1 = random.vector<3>(-2.0, 2.0);
    double least_m = INFINITY;
    for (int k = 0; k <= 2000; ++k) {
      const double s = k / 2000.0;
      least_m = std::min(least_m, (a0 + s * (a1 - a0) - b0 - s * (b1 - b0)).norm());
    }
    const double closest_m = closest_approach_m(a0, a1, b0, b1);
    ASSERT_LE(closest_m, least_m + 1e-12);
    ASSERT_GE(closest_m, least_m - 0.01);
  }
}

TEST(ClosestApproach, DetectsASwapOfPositions) {
  const Eigen::Vector3d left(-1, 0, 1);
  const Eigen::Vector3d right(1, 0, 1);
  EXPECT_EQ(closest_approach_m(left, right, right, left), 0.0);
  EXPECT_EQ(closest_approach_m(left, left, right, right), 2.0);
  EXPECT_EQ(closest_approach_m(left, right, left, right), 0.0);
}

// Tests points next to each of the four sides, and on each side.
TEST(Rectangle, IncludesItsEdges) {
  const Rectangle box{{-1.0, 2.0}, {3.0, 4.5}};
  for (const double x_m : {-1.1, -1.0, 0.5, 3.0, 3.1}) {
    for (const double y_m : {1.9, 2.0, 3.0, 4.5, 4.6}) {
      const bool is_in = std::abs(x_m - 1.0) < 2.05 && std::abs(y_m - 3.25) < 1.3;
      EXPECT_EQ(box.contains({x_m, y_m}), is_in) << x_m << ' ' << y_m;
      World world{{{-9, -9}, {9, 9}}, 3.0, {}, {}};
      world.regions = {{"mud", box, 2.5}};
      EXPECT_EQ(region_cost(world, {x_m, y_m}), is_in ? 2.5 : 0.0);
    }
  }
}

TEST(RegionCost, SumsOverlappingRegionsIncludingTheirEdges) {
  World world{{{0, 0}, {10, 10}}, 3.0, {}, {}};
  world.regions = {{"mud", {{0, 0}, {2, 2}}, 3.0}, {"wind", {{1, 1}, {4, 4}}, 0.5}};
  EXPECT_EQ(region_cost(world, {0.5, 0.5}), 3.0);
  EXPECT_EQ(region_cost(world, {1.5, 1.5}), 3.5);
  EXPECT_EQ(region_cost(world, {2.0, 2.0}), 3.5);
  EXPECT_EQ(region_cost(world, {5.0, 5.0}), 0.0);
}

// A list of exactly kMax near obstacles is complete; with one more obstacle the list is incomplete.
TEST(NearbyObstacles, ReportOverflow) {
  World world{{{-50, -50}, {50, 50}}, 3.0, {}, {}};
  for (std::size_t i = 0; i < NearbyObstacles::kMax; ++i) {
    const double x_m = 0.1 * static_cast<double>(i);
    world.obstacles.push_back({{{x_m, 2.0}, {x_m + 0.05, 3.0}}, 1.0});
  }
  NearbyObstacles nearby = nearby_obstacles(world, {0.0, 0.0}, 5.0);
  EXPECT_TRUE(nearby.is_complete);
  ASSERT_EQ(nearby.count, NearbyObstacles::kMax);
  for (std::uint32_t i = 0; i < NearbyObstacles::kMax; ++i) {
    EXPECT_EQ(nearby.indices[i], i);
  }
  world.obstacles.push_back({{{20.0, 20.0}, {21.0, 21.0}}, 1.0});  // far away
  EXPECT_TRUE(nearby_obstacles(world, {0.0, 0.0}, 5.0).is_complete);
  world.obstacles.push_back({{{-3.0, -3.0}, {-1.0, -1.0}}, 1.0});
  nearby = nearby_obstacles(world, {0.0, 0.0}, 5.0);
  EXPECT_FALSE(nearby.is_complete);
  EXPECT_NEAR(clearance_m(world, nearby, {0.0, 0.0}), std::sqrt(2.0), 1e-12)
      << "from all obstacles";
  // The box is just within and just beyond the distance, on each of its sides.
  const World one{{{-50, -50}, {50, 50}}, 3.0, {{{{-1, -2}, {1, 2}}, 1.0}}, {}};
  for (const double side : {-1.0, 1.0}) {
    for (const double beyond_m : {-1e-9, 1e-9}) {
      const std::size_t count = beyond_m < 0.0 ? 1 : 0;
      EXPECT_EQ(nearby_obstacles(one, {side * (4.0 + beyond_m), 0.0}, 3.0).count, count);
      EXPECT_EQ(nearby_obstacles(one, {0.0, side * (5.0 + beyond_m)}, 3.0).count, count);
    }
  }
}

// The paths are parallel to an axis, pass a corner, or leave the bounds.
TEST(SweptClearance, EqualsTheClosedFormAroundOneBox) {
  const World world{{{-10, -8}, {10, 8}}, 3.0, {{{{-1, -2}, {1, 2}}, 1.0}}, {}};
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {3, -5}, {3, 5}), 2.0);
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {-3, 5}, {-3, -5}), 2.0);
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {-4, 3}, {4, 3}), 1.0);
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {4, -3.5}, {-4, -3.5}), 1.5);
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {3, 0}, {9.5, 0}), 0.5) << "the wall is nearer";
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {9.5, 1}, {3, 1}), 0.5);
  EXPECT_DOUBLE_EQ(swept_clearance_m(world, {4, -6}, {4, -6}), 2.0);
  // A slanted path past each corner: the clearance is the corner's distance from the line.
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      EXPECT_NEAR(swept_clearance_m(world, {sx * 4.0, sy * 1.0}, {sx * 0.0, sy * 5.0}),
                  std::abs(4.0 * (1.0 - 4.0) + 4.0 * (2.0 - 1.0)) / std::hypot(4.0, 4.0), 1e-12);
    }
  }
  EXPECT_LE(swept_clearance_m(world, {-3, 0}, {3, 0.5}), 0.0);
  EXPECT_LE(swept_clearance_m(world, {9, 0}, {11, 0}), -1.0) << "ends a metre outside";
}

}  // namespace
}  // namespace vantage::models
