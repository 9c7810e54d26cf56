#include "planner/mapping/drive_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "test/planner/mapping/random_map.hpp"

namespace vantage::planner {
namespace {

using models::GridGeometry;
using models::OccupancyBelief;

const GridGeometry kGrid{{-2.0, 1.0}, 0.25, 30, 24};

// Returns the distance from a point to the nearest occupied cell's square or the grid's edge, m.
double clearance_m(const OccupancyBelief& belief, const Eigen::Vector2d& p_m) {
  const Eigen::Vector2d low_m = p_m - kGrid.origin_m;
  double least_m = std::min({low_m.x(), low_m.y(), 30 * 0.25 - low_m.x(), 24 * 0.25 - low_m.y()});
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    if (belief.occupancy(cell) > 0.51) {
      const Eigen::Vector2d gap_m =
          ((p_m - kGrid.centre_m(cell)).cwiseAbs().array() - 0.125).cwiseMax(0.0);
      least_m = std::min(least_m, gap_m.norm());
    }
  }
  return least_m;
}

TEST(DriveMap, KeepsDiscOffOccupiedCells) {
  test::Random random(4601);
  int driven = 0;
  for (int i = 0; i < 300; ++i) {
    const OccupancyBelief belief = test::random_map(random, kGrid, 0.01);
    const DriveMap map(belief, {});
    const Pose2 from{random.uniform(-2.0, 5.5), random.uniform(1.0, 7.0),
                     random.uniform(-kPi, kPi)};
    const models::UnicycleControl control{random.uniform(0.0, 2.0), random.uniform(-2.0, 2.0)};
    if (!map.is_free(from.position_m()) || !map.is_free(from, control, 1.0)) {
      continue;
    }
    ++driven;
    for (int k = 0; k <= 200; ++k) {
      const Pose2 at = models::step_unicycle(from, control, k / 200.0);
      ASSERT_GE(clearance_m(belief, at.position_m()), 0.2 - 1e-9);
    }
  }
  EXPECT_GT(driven, 50);
}

// Driving backwards covers the same path as driving forwards with the opposite heading.
TEST(DriveMap, IsSymmetricInDrivingDirection) {
  test::Random random(4602);
  int free = 0;
  int blocked = 0;
  for (int i = 0; i < 300; ++i) {
    const OccupancyBelief belief = test::random_map(random, kGrid, 0.01);
    const DriveMap map(belief, {});
    const Pose2 from{random.uniform(-2.0, 5.5), random.uniform(1.0, 7.0),
                     random.uniform(-kPi, kPi)};
    const double speed_mps = random.uniform(0.2, 2.0);
    const double yaw_rate_radps = random.uniform(-2.0, 2.0);
    const bool is_free = map.is_free(from, {-speed_mps, yaw_rate_radps}, 1.0);
    EXPECT_EQ(is_free, map.is_free({from.x_m, from.y_m, wrap_to_pi(from.yaw_rad + kPi)},
                                   {speed_mps, yaw_rate_radps}, 1.0));
    (is_free ? free : blocked) += 1;
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(blocked, 50);
}

TEST(DriveMap, AllowsTooNearRobotOnlyToMoveAway) {
  OccupancyBelief belief(kGrid, 3.0);
  belief.add_log_odds(12 * 30 + 10, 9.0);  // a post
  const DriveMap map(belief, {});
  const Eigen::Vector2d post_m = kGrid.centre_m(12 * 30 + 10);
  const Pose2 beside{post_m.x() + 0.2, post_m.y(), 0.0};
  EXPECT_FALSE(map.is_free(beside.position_m()));
  EXPECT_TRUE(map.is_free(beside, {1.0, 0.0}, 1.0));
  EXPECT_FALSE(map.is_free({beside.x_m, beside.y_m, kPi}, {1.0, 0.0}, 1.0));
  EXPECT_FALSE(map.is_free({post_m.x() + 1.0, post_m.y(), kPi}, {1.0, 0.0}, 1.0));
  // From within the post's cell the robot may leave directly but must not drive across the post.
  EXPECT_TRUE(map.is_free({post_m.x() - 0.1, post_m.y(), kPi}, {1.0, 0.0}, 1.0));
  EXPECT_FALSE(map.is_free({post_m.x() + 0.1, post_m.y(), kPi}, {1.0, 0.0}, 1.0));
  EXPECT_TRUE(map.is_free(beside, {0.0, 2.0}, 1.0)) << "a turn on the spot is allowed";
}

TEST(DriveMap, MeasuresDistanceToUnknownCells) {
  OccupancyBelief belief(kGrid, 3.0);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    if (cell % 30 < 20) {
      belief.add_log_odds(cell, -9.0);  // columns 0 … 19 are free, the rest unknown
    }
  }
  const DriveMap map(belief, {});
  EXPECT_EQ(map.frontier_distance_m(kGrid.centre_m(12 * 30 + 20)), 0.0);
  EXPECT_NEAR(map.frontier_distance_m(kGrid.centre_m(12 * 30 + 15)), 5 * 0.25, 1e-12);
  EXPECT_TRUE(std::isinf(map.frontier_distance_m({-9.0, 0.0})));
}

// A map that is mirrored left to right or top to bottom gives mirrored results.
TEST(DriveMap, IsMirrorSymmetric) {
  test::Random random(4603);
  const int columns = kGrid.columns;
  const int rows = kGrid.rows;
  int on_the_way = 0;
  for (int i = 0; i < 20; ++i) {
    const OccupancyBelief belief = test::random_map(random, kGrid, 0.05);
    const DriveMap map(belief, {});
    for (const bool is_upside_down : {false, true}) {
      const auto mirrored = [&](int cell) {
        const int column = cell % columns;
        const int row = cell / columns;
        return is_upside_down ? (rows - 1 - row) * columns + column
                              : row * columns + columns - 1 - column;
      };
      OccupancyBelief turned(kGrid, 3.0);
      for (int cell = 0; cell < kGrid.size(); ++cell) {
        turned.add_log_odds(mirrored(cell), belief.log_odds(cell));
      }
      const DriveMap of_turned(turned, {});
      for (int cell = 0; cell < kGrid.size(); ++cell) {
        const double path_m = map.frontier_distance_m(kGrid.centre_m(cell));
        const double turned_m = of_turned.frontier_distance_m(kGrid.centre_m(mirrored(cell)));
        EXPECT_TRUE(path_m == turned_m || std::abs(path_m - turned_m) < 1e-9)
            << path_m << " and " << turned_m;
        on_the_way += path_m > 0.0 && std::isfinite(path_m) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(on_the_way, 1'000);
}

TEST(DriveMap, MeasuresDistanceAroundWallsOrReportsNone) {
  OccupancyBelief belief(kGrid, 3.0);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    const int column = cell % 30;
    const int row = cell / 30;
    if (column == 18 && row < 16) {
      belief.add_log_odds(cell, 9.0);
    } else if (column < 26) {
      belief.add_log_odds(cell, -9.0);
    }
  }
  const double detour_m = DriveMap(belief, {}).frontier_distance_m(kGrid.centre_m(3 * 30 + 10));
  EXPECT_GT(detour_m, 18 * 0.25);
  EXPECT_LT(detour_m, 40 * 0.25);
  for (int row = 16; row < 24; ++row) {
    belief.add_log_odds(row * 30 + 18, 20.0);
  }
  EXPECT_TRUE(std::isinf(DriveMap(belief, {}).frontier_distance_m(kGrid.centre_m(3 * 30 + 10))));
}

// Returns the gap between the squares of two cells, m. A cell beyond the grid represents the grid's
// edge.
double gap_m(int a, int b_column, int b_row) {
  const int columns = std::abs(a % kGrid.columns - b_column);
  const int rows = std::abs(a / kGrid.columns - b_row);
  return 0.25 * std::hypot(std::max(0, columns - 1), std::max(0, rows - 1));
}

// A cell is blocked if and only if the disc, enlarged by a quarter of a cell, would touch an
// obstacle or the edge from a point in the cell.
TEST(DriveMap, IsFreeIfAndOnlyIfNothingIsNear) {
  test::Random random(4604);
  int free = 0;
  int near = 0;
  for (const double radius_m : {0.2, 0.55, 1.1}) {
    for (const double occupied_from : {0.51, 0.3}) {
      const OccupancyBelief belief = test::random_map(random, kGrid, 0.01);
      const DriveMap map(belief, {radius_m, occupied_from, 0.2});
      for (int cell = 0; cell < kGrid.size(); ++cell) {
        const int column = cell % kGrid.columns;
        const int row = cell / kGrid.columns;
        double least_m =
            0.25 * std::min({column, row, kGrid.columns - 1 - column, kGrid.rows - 1 - row});
        for (int other = 0; other < kGrid.size(); ++other) {
          if (belief.occupancy(other) >= occupied_from) {
            least_m = std::min(least_m, gap_m(cell, other % kGrid.columns, other / kGrid.columns));
          }
        }
        const bool is_free = least_m >= radius_m + 0.25 * 0.25;
        EXPECT_EQ(map.is_free(kGrid.centre_m(cell)), is_free) << radius_m << " cell " << cell;
        (is_free ? free : near) += 1;
      }
    }
  }
  EXPECT_GT(free, 200);
  EXPECT_GT(near, 200);
  const DriveMap empty(OccupancyBelief(kGrid, 3.0), {});
  EXPECT_TRUE(empty.is_free({1.75, 4.0}));
  for (const Eigen::Vector2d& outside_m :
       {Eigen::Vector2d(-2.1, 4.0), Eigen::Vector2d(5.6, 4.0), Eigen::Vector2d(1.75, 0.9),
        Eigen::Vector2d(1.75, 7.1)}) {
    EXPECT_FALSE(empty.is_free(outside_m));
  }
}

// Compares the distances with a relaxation of all paths until no path becomes shorter.
TEST(DriveMap, MeasuresShortestDistanceToNearestFrontier) {
  test::Random random(4605);
  constexpr double kNoPath_m = std::numeric_limits<double>::infinity();
  int frontiers = 0;
  int on_the_way = 0;
  for (int i = 0; i < 6; ++i) {
    const OccupancyBelief belief = test::random_map(random, kGrid, 0.03);
    const DriveMap map(belief, {0.2, 0.51, i % 2 == 0 ? 0.35 : 0.1});
    const double free_up_to = i % 2 == 0 ? 0.35 : 0.1;
    const auto is_within = [](int column, int row) {
      return column >= 0 && column < kGrid.columns && row >= 0 && row < kGrid.rows;
    };
    const auto is_free = [&](int cell) { return map.is_free(kGrid.centre_m(cell)); };
    std::vector<double> paths_m(static_cast<std::size_t>(kGrid.size()), kNoPath_m);
    for (int cell = 0; cell < kGrid.size(); ++cell) {
      for (const Eigen::Vector2i& by : {Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0),
                                        Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)}) {
        const int column = cell % kGrid.columns + by.x();
        const int row = cell / kGrid.columns + by.y();
        const int beside = row * kGrid.columns + column;
        if (is_free(cell) && belief.occupancy(cell) > free_up_to && is_within(column, row) &&
            is_free(beside) && belief.occupancy(beside) <= free_up_to) {
          paths_m[static_cast<std::size_t>(cell)] = 0.0;
        }
      }
    }
    frontiers += static_cast<int>(std::count(paths_m.begin(), paths_m.end(), 0.0));
    for (bool is_shorter = true; is_shorter;) {
      is_shorter = false;
      for (int cell = 0; cell < kGrid.size(); ++cell) {
        for (int by = 0; by < 9 && is_free(cell); ++by) {
          const int column = cell % kGrid.columns + by % 3 - 1;
          const int row = cell / kGrid.columns + by / 3 - 1;
          const int beside = row * kGrid.columns + column;
          if (!is_within(column, row) || !is_free(beside)) {
            continue;
          }
          const double path_m =
              paths_m[static_cast<std::size_t>(beside)] + 0.25 * std::hypot(by % 3 - 1, by / 3 - 1);
          if (path_m < paths_m[static_cast<std::size_t>(cell)] - 1e-12) {
            paths_m[static_cast<std::size_t>(cell)] = path_m;
            is_shorter = true;
          }
        }
      }
    }
    for (int cell = 0; cell < kGrid.size(); ++cell) {
      const double path_m = map.frontier_distance_m(kGrid.centre_m(cell));
      const double expected_m = paths_m[static_cast<std::size_t>(cell)];
      EXPECT_TRUE(path_m == expected_m || std::abs(path_m - expected_m) < 1e-9)
          << cell << ": " << path_m << " and " << expected_m;
      on_the_way += path_m > 0.0 && std::isfinite(path_m) ? 1 : 0;
    }
  }
  EXPECT_GT(frontiers, 20);
  EXPECT_GT(on_the_way, 60);
}

// Between two walls a robot is everywhere too near to a wall. It has enough clearance again 0.5 m
// beyond the ends of the walls. The robot may drive out if it is at most its radius plus two cells,
// 0.7 m, from a position with enough clearance.
TEST(DriveMap, LetsTooNearRobotLeaveWithinRadiusAndTwoCells) {
  for (const bool is_upright : {false, true}) {
    OccupancyBelief belief(kGrid, 3.0);
    for (int along = 9; along <= 14; ++along) {
      for (const int across : {10, 13}) {
        belief.add_log_odds(is_upright ? along * 30 + across : across * 30 + along, 9.0);
      }
    }
    const DriveMap map(belief, {});
    for (const double side : {1.0, -1.0}) {
      const double clear_from_m = side > 0.0 ? 17 * 0.25 : 7 * 0.25;  // m; from the grid's corner
      const auto may_drive = [&](double before_m, double path_m) {
        const double along_m = clear_from_m - side * before_m;
        const double across_m = 11.5 * 0.25 + 0.02;
        const double yaw_rad = (is_upright ? 0.5 * kPi : 0.0) + (side > 0.0 ? 0.0 : kPi);
        const Pose2 from{-2.0 + (is_upright ? across_m : along_m),
                         1.0 + (is_upright ? along_m : across_m), wrap_to_pi(yaw_rad)};
        EXPECT_FALSE(map.is_free(from.position_m())) << before_m;
        EXPECT_EQ(map.is_free(from, {path_m, 0.0}, 1.0),
                  map.is_free(from, {2.0 * path_m, 0.0}, 0.5));
        return map.is_free(from, {path_m, 0.0}, 1.0);
      };
      for (const double before_m : {0.04, 0.3, 0.5, 0.69}) {
        EXPECT_TRUE(may_drive(before_m, before_m + 0.9)) << before_m << ' ' << side << is_upright;
        EXPECT_FALSE(may_drive(before_m, before_m - 0.02)) << "the robot is not clear at the end";
      }
      for (const double before_m : {0.84, 1.0, 1.2}) {  // m; samples every half cell
        EXPECT_FALSE(may_drive(before_m, before_m + 0.9)) << before_m << ' ' << side << is_upright;
      }
    }
  }
}

// The path cuts the outer corner of the blocked area around a post. If 18 cm of the path are inside
// the area, samples every half cell detect this for any start. A path outside the area is accepted.
TEST(DriveMap, SamplesEveryHalfCell) {
  OccupancyBelief belief(kGrid, 3.0);
  belief.add_log_odds(12 * 30 + 10, 9.0);
  const DriveMap map(belief, {});
  const Eigen::Vector2d corner_m = kGrid.centre_m(12 * 30 + 10) + Eigen::Vector2d(0.625, 0.375);
  ASSERT_FALSE(map.is_free(corner_m - Eigen::Vector2d(0.01, 0.01)));
  ASSERT_TRUE(map.is_free(corner_m + Eigen::Vector2d(0.01, -0.01)));
  ASSERT_TRUE(map.is_free(corner_m + Eigen::Vector2d(-0.01, 0.01)));
  for (const double within_m : {0.09, -0.01}) {
    const Eigen::Vector2d middle_m = corner_m - within_m * Eigen::Vector2d(1.0, 1.0).normalized();
    for (const double before_m : {0.35, 0.375, 0.4}) {
      const Eigen::Vector2d from_m = middle_m + before_m * Eigen::Vector2d(1.0, -1.0).normalized();
      EXPECT_EQ(map.is_free({from_m.x(), from_m.y(), 0.75 * kPi}, {0.5, 0.0}, 1.0), within_m < 0.0)
          << before_m;
    }
  }
}

TEST(DriveMap, HasTheStatedDefaults) {
  const DriveOptions options;
  EXPECT_EQ(options.radius_m, 0.2);
  EXPECT_EQ(options.occupied_from, 0.51);
  EXPECT_EQ(options.free_up_to, 0.35);
}

TEST(DriveMap, RefusesInvalidOptions) {
  const OccupancyBelief belief(kGrid, 3.0);
  EXPECT_THROW(DriveMap(belief, {0.0, 0.51, 0.35}), UsageError);
  EXPECT_THROW(DriveMap(belief, {0.2, 0.3, 0.35}), UsageError);
}

}  // namespace
}  // namespace vantage::planner
