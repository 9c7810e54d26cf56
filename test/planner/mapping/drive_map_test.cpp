#include "planner/mapping/drive_map.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "test/planner/mapping/random_map.hpp"

namespace vantage::planner {
namespace {

using models::GridGeometry;
using models::OccupancyBelief;

const GridGeometry kGrid{{-2.0, 1.0}, 0.25, 30, 24};

// Distance from a point to the nearest occupied cell's square or to the grid's edge.
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

TEST(DriveMap, NeverLetsADiscTouchWhatIsOccupied) {
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

// Backwards leads where forwards would, had it turned round before.
TEST(DriveMap, DrivesBackwardsAsItDrivesForwardsTurnedRound) {
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

TEST(DriveMap, LetsARobotThatStandsTooNearLeaveButNotComeNear) {
  OccupancyBelief belief(kGrid, 3.0);
  belief.add_log_odds(12 * 30 + 10, 9.0);  // a post
  const DriveMap map(belief, {});
  const Eigen::Vector2d post_m = kGrid.centre_m(12 * 30 + 10);
  const Pose2 beside{post_m.x() + 0.2, post_m.y(), 0.0};
  EXPECT_FALSE(map.is_free(beside.position_m()));
  EXPECT_TRUE(map.is_free(beside, {1.0, 0.0}, 1.0));
  EXPECT_FALSE(map.is_free({beside.x_m, beside.y_m, kPi}, {1.0, 0.0}, 1.0));
  EXPECT_FALSE(map.is_free({post_m.x() + 1.0, post_m.y(), kPi}, {1.0, 0.0}, 1.0));
  EXPECT_TRUE(map.is_free(beside, {0.0, 2.0}, 1.0)) << "it may turn on the spot";
}

TEST(DriveMap, MeasuresTheWayToTheUnknown) {
  OccupancyBelief belief(kGrid, 3.0);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    if (cell % 30 < 20) {
      belief.add_log_odds(cell, -9.0);  // columns 0 … 19 are free, the rest unknown
    }
  }
  const DriveMap map(belief, {});
  EXPECT_EQ(map.to_frontier_m(kGrid.centre_m(12 * 30 + 20)), 0.0);
  EXPECT_NEAR(map.to_frontier_m(kGrid.centre_m(12 * 30 + 15)), 5 * 0.25, 1e-12);
  EXPECT_TRUE(std::isinf(map.to_frontier_m({-9.0, 0.0})));
}

// Left for right, and up for down.
TEST(DriveMap, MeasuresTheSameWayInAMirror) {
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
        const double way_m = map.to_frontier_m(kGrid.centre_m(cell));
        const double turned_m = of_turned.to_frontier_m(kGrid.centre_m(mirrored(cell)));
        EXPECT_TRUE(way_m == turned_m || std::abs(way_m - turned_m) < 1e-9)
            << way_m << " and " << turned_m;
        on_the_way += way_m > 0.0 && std::isfinite(way_m) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(on_the_way, 1'000);
}

TEST(DriveMap, GoesAroundWallsToTheUnknownAndKnowsWhenThereIsNoWay) {
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
  const double detour_m = DriveMap(belief, {}).to_frontier_m(kGrid.centre_m(3 * 30 + 10));
  EXPECT_GT(detour_m, 18 * 0.25);
  EXPECT_LT(detour_m, 40 * 0.25);
  for (int row = 16; row < 24; ++row) {
    belief.add_log_odds(row * 30 + 18, 20.0);
  }
  EXPECT_TRUE(std::isinf(DriveMap(belief, {}).to_frontier_m(kGrid.centre_m(3 * 30 + 10))));
}

TEST(DriveMap, RefusesOptionsThatMakeNoSense) {
  const OccupancyBelief belief(kGrid, 3.0);
  EXPECT_THROW(DriveMap(belief, {0.0, 0.51, 0.35}), UsageError);
  EXPECT_THROW(DriveMap(belief, {0.2, 0.3, 0.35}), UsageError);
}

}  // namespace
}  // namespace vantage::planner
