#include <gtest/gtest.h>

#include "models/world/grid.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

constexpr Time kNow = from_utime(1'000'000'000);

World lab() {
  return {{{0.0, 0.0}, {8.0, 4.0}},
          3.0,
          {{{{3.0, 1.0}, {4.0, 2.0}}, 1.0}, {{{5.1, 2.6}, {6.3, 3.3}}, 1.0}},
          {}};
}

SensorModel eye(double range_max_m, double fov_rad = 2.0 * kPi) {
  SensorModel sensor;
  sensor.range_max_m = range_max_m;
  sensor.fov_rad = fov_rad;
  return sensor;
}

/// Returns the share of the free cells that are explored.
double explored_share(const VisibilityGrid& grid, Time now) {
  int free = 0;
  int explored = 0;
  for (int cell = 0; cell < grid.geometry().size(); ++cell) {
    free += grid.is_free(cell) ? 1 : 0;
    explored += grid.is_free(cell) && grid.is_explored(cell, now) ? 1 : 0;
  }
  return static_cast<double>(explored) / free;
}

TEST(VisibilityGrid, MarksExactlyTheVisibleFreeCells) {
  const World world = lab();
  test::Random random(51);
  for (int i = 0; i < 200; ++i) {
    VisibilityGrid grid(world, 0.25, 0.0);
    const SensorModel sensor = eye(random.uniform(0.5, 5.0), random.uniform(0.5, 7.0));
    const Viewpoint from{{random.uniform(0, 8), random.uniform(0, 4), random.uniform(-kPi, kPi)},
                         1};
    grid.see(sensor, from, world, kNow);
    for (int index = 0; index < grid.geometry().size(); ++index) {
      const Eigen::Vector2d centre_m = grid.geometry().centre_m(index);
      const bool expected = clearance_m(world, centre_m) > 0.0 && in_view(sensor, from, centre_m) &&
                            line_of_sight(world, from.world_from_body.position_m(), centre_m);
      ASSERT_EQ(grid.is_explored(index, kNow), expected) << "cell " << index;
      ASSERT_EQ(grid.last_seen_utime()[static_cast<std::size_t>(index)],
                expected ? to_utime(kNow) : VisibilityGrid::kNeverSeen);
    }
  }
}

TEST(VisibilityGrid, AcceptsAViewpointOutsideTheWorld) {
  VisibilityGrid grid(lab(), 0.25, 0.0);
  grid.see(eye(1.0), {{-100.0, 50.0, 0.0}, 1.0}, lab(), kNow);
  grid.see(eye(1.0), {{1e12, -1e12, 0.0}, 1.0}, lab(), kNow);
  EXPECT_EQ(explored_share(grid, kNow), 0.0);
}

TEST(VisibilityGrid, ExcludesCellsInsideObstacles) {
  const VisibilityGrid grid(lab(), 0.25, 0.0);
  EXPECT_FALSE(grid.is_free(grid.geometry().index_of({3.5, 1.5})));
  EXPECT_TRUE(grid.is_free(grid.geometry().index_of({3.5, 2.1})));
}

TEST(VisibilityGrid, ForgetsACellAfterItsMemoryTime) {
  VisibilityGrid grid({{{0, 0}, {8, 4}}, 3.0, {}, {}}, 0.25, 30.0);
  grid.see(eye(20.0), {{1.0, 1.0, 0.0}, 1.0}, lab(), kNow);
  const double share = explored_share(grid, kNow);
  EXPECT_GT(share, 0.5);
  EXPECT_EQ(explored_share(grid, kNow + from_seconds(30.0)), share);
  EXPECT_EQ(explored_share(grid, kNow + from_seconds(30.000001)), 0.0);
}

TEST(VisibilityGrid, NeverForgetsWithoutAMemoryLimit) {
  VisibilityGrid grid({{{0, 0}, {8, 4}}, 3.0, {}, {}}, 0.25, 0.0);
  grid.see(eye(20.0), {{1.01, 1.02, 0.0}, 1.0}, {{{0, 0}, {8, 4}}, 3.0, {}, {}}, kNow);
  EXPECT_EQ(explored_share(grid, kNow + from_seconds(1e9)), 1.0);
}

TEST(VisibilityGrid, CountsAnObservationAtTimeZero) {
  VisibilityGrid grid(lab(), 0.25, 10.0);
  grid.see(eye(20.0), {{1.0, 1.0, 0.0}, 1.0}, lab(), Time{});
  EXPECT_GT(explored_share(grid, Time{}), 0.5);
}

TEST(VisibilityGrid, KeepsTheNewerStamp) {
  const World world = lab();
  const Time later = kNow + from_seconds(5.0);
  VisibilityGrid left(world, 0.25, 0.0);
  VisibilityGrid right(world, 0.25, 0.0);
  left.see(eye(3.0), {{1.0, 1.0, 0.0}, 1.0}, world, kNow);
  right.see(eye(3.0), {{3.0, 3.0, 0.0}, 1.0}, world, later);
  VisibilityGrid one = left;
  one.merge(right);
  VisibilityGrid other = right;
  other.merge(left);
  EXPECT_EQ(one.last_seen_utime(), other.last_seen_utime());
  for (std::size_t i = 0; i < one.last_seen_utime().size(); ++i) {
    ASSERT_EQ(one.last_seen_utime()[i],
              std::max(left.last_seen_utime()[i], right.last_seen_utime()[i]));
  }
  VisibilityGrid again = one;
  again.merge(right);
  again.see(eye(3.0), {{3.0, 3.0, 0.0}, 1.0}, world, kNow);
  EXPECT_EQ(again.last_seen_utime(), one.last_seen_utime());
}

TEST(VisibilityGrid, IsRestoredFromItsStamps) {
  const World world = lab();
  VisibilityGrid sender(world, 0.25, 0.0);
  sender.see(eye(2.0), {{1.0, 1.0, 0.0}, 1.0}, world, kNow);
  VisibilityGrid receiver(world, 0.25, 0.0);
  receiver.set_last_seen(sender.last_seen_utime());
  EXPECT_EQ(explored_share(receiver, kNow), explored_share(sender, kNow));
}

TEST(Frontiers, AreTheUnexploredFreeNeighboursOfExploredCells) {
  const World world = lab();
  VisibilityGrid grid(world, 0.25, 0.0);
  grid.see(eye(2.0), {{2.1, 2.1, 0.0}, 1.0}, world, kNow);
  std::vector<Eigen::Vector2d> expected;
  const auto is_known = [&](const Eigen::Vector2d& p_m) {
    const int index = grid.geometry().index_of(p_m);
    return index >= 0 && grid.is_free(index) && grid.is_explored(index, kNow);
  };
  for (int index = 0; index < grid.geometry().size(); ++index) {
    const Eigen::Vector2d c_m = grid.geometry().centre_m(index);
    if (grid.is_free(index) && !grid.is_explored(index, kNow) &&
        (is_known(c_m + Eigen::Vector2d(0.25, 0)) || is_known(c_m - Eigen::Vector2d(0.25, 0)) ||
         is_known(c_m + Eigen::Vector2d(0, 0.25)) || is_known(c_m - Eigen::Vector2d(0, 0.25)))) {
      expected.push_back(c_m);
    }
  }
  EXPECT_GT(expected.size(), 10u);
  EXPECT_EQ(grid.frontiers(kNow, 0.0), expected);
}

// Frontiers are kept greedily in index order: a frontier is kept if it is far from all frontiers
// kept before it.
TEST(Frontiers, AreThinnedGreedilyInIndexOrder) {
  const World world = lab();
  for (const double spacing_m : {0.1, 0.25, 0.6, 1.0, 3.0, 100.0}) {
    for (const bool seen_something : {false, true}) {
      VisibilityGrid grid(world, 0.25, 0.0);
      if (seen_something) {
        grid.see(eye(2.0), {{2.1, 2.1, 0.0}, 1.0}, world, kNow);
      }
      std::vector<Eigen::Vector2d> expected;
      for (const Eigen::Vector2d& p_m : grid.frontiers(kNow, 0.0)) {
        bool is_far = true;
        for (const Eigen::Vector2d& kept_m : expected) {
          is_far = is_far && (kept_m - p_m).norm() >= spacing_m;
        }
        if (is_far) {
          expected.push_back(p_m);
        }
      }
      EXPECT_EQ(grid.frontiers(kNow, spacing_m), expected) << spacing_m;
    }
  }
}

TEST(Frontiers, AreEveryFreeCellWhileNothingIsExplored) {
  const VisibilityGrid grid(lab(), 0.25, 0.0);
  std::vector<Eigen::Vector2d> expected;
  for (int index = 0; index < grid.geometry().size(); ++index) {
    if (grid.is_free(index)) {
      expected.push_back(grid.geometry().centre_m(index));
    }
  }
  EXPECT_EQ(grid.frontiers(kNow, 0.0), expected);
}

TEST(Frontiers, AreEmptyWhenAllIsExplored) {
  const World empty{{{0, 0}, {8, 4}}, 3.0, {}, {}};
  VisibilityGrid grid(empty, 0.25, 0.0);
  grid.see(eye(20.0), {{1.01, 1.02, 0.0}, 1.0}, empty, kNow);
  EXPECT_TRUE(grid.frontiers(kNow, 1.0).empty());
}

TEST(Frontiers, LieOutsideTheViewAndInsideTheBounds) {
  const World world{{{0, 0}, {8.1, 4.1}}, 3.0, {}, {}};  // the last cells extend beyond the bounds
  const VisibilityGrid grid(world, 0.25, 0.0);
  for (const Eigen::Vector2d& p_m : grid.frontiers(kNow, 0.0)) {
    ASSERT_TRUE(world.bounds.contains(p_m));
  }
}

// The visible area reaches the grid's edge. The end of a row is not adjacent to the start of the
// next row.
TEST(Frontiers, StayWithinTheGrid) {
  const World world{{{0, 0}, {2.0, 1.5}}, 3.0, {}, {}};
  test::Random random(52);
  for (int i = 0; i < 200; ++i) {
    VisibilityGrid grid(world, 0.25, 0.0);
    const GridGeometry& cells = grid.geometry();
    std::vector<std::int64_t> stamps(static_cast<std::size_t>(cells.size()));
    for (std::int64_t& stamp : stamps) {
      stamp = random.integer(0, 2 + i % 3) == 0 ? to_utime(kNow) : VisibilityGrid::kNeverSeen;
    }
    stamps[static_cast<std::size_t>(random.integer(0, cells.size() - 1))] = to_utime(kNow);
    grid.set_last_seen(stamps);
    std::vector<Eigen::Vector2d> expected;
    for (int index = 0; index < cells.size(); ++index) {
      const Eigen::Vector2d c_m = cells.centre_m(index);
      bool beside = false;
      for (int other = 0; other < cells.size(); ++other) {
        beside = beside || (stamps[static_cast<std::size_t>(other)] != 0 &&
                            (cells.centre_m(other) - c_m).norm() < 0.26);
      }
      if (stamps[static_cast<std::size_t>(index)] == 0 && beside) {
        expected.push_back(c_m);
      }
    }
    EXPECT_EQ(grid.frontiers(kNow, 0.0), expected);
  }
}

}  // namespace
}  // namespace vantage::models
