#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "models/world/grid.hpp"
#include "test/support/random.hpp"

// Windows: grids that are a part of the world's grid.

namespace vantage::models {
namespace {

constexpr Time kNow = from_utime(1'000'000'000);
constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

World field() {
  return {{{-20.3, -11.1}, {40.9, 30.2}}, 3.0, {{{{3.0, 1.0}, {7.0, 6.0}}, 1.0}}, {}};
}

TEST(GridWindow, HasTheWorldsCellsThatOverlapTheSquare) {
  const GridGeometry whole = GridGeometry::covering(field().bounds, 0.7);
  test::Random random(7);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d around_m(random.uniform(-40, 60), random.uniform(-40, 60));
    const double half_m = random.uniform(0.0, 30.0);
    const GridGeometry part = whole.window(around_m, half_m);
    const auto place = whole.cell_offset_of(part);
    ASSERT_TRUE(place);
    ASSERT_GE(part.columns, 1);
    ASSERT_GE(part.rows, 1);
    ASSERT_GE(place->minCoeff(), 0);
    ASSERT_LE(place->x() + part.columns, whole.columns);
    ASSERT_LE(place->y() + part.rows, whole.rows);
    for (int index = 0; index < whole.size(); index += 17) {
      const Eigen::Vector2d centre_m = whole.centre_m(index);
      if (((centre_m - around_m).cwiseAbs().array() <= half_m).all()) {
        ASSERT_GE(part.index_of(centre_m), 0) << "cell " << index;
      }
    }
  }
}

TEST(GridWindow, HasNoOffsetIfTheCellsDoNotCoincide) {
  const GridGeometry whole = GridGeometry::covering(field().bounds, 0.7);
  GridGeometry other = whole.window({0.0, 0.0}, 5.0);
  EXPECT_TRUE(whole.cell_offset_of(other));
  other.origin_m.x() += 0.1;
  EXPECT_FALSE(whole.cell_offset_of(other));
  other = whole.window({0.0, 0.0}, 5.0);
  other.resolution_m = 0.35;
  EXPECT_FALSE(whole.cell_offset_of(other));
  other = whole;
  other.origin_m.x() = std::nan("");
  EXPECT_FALSE(whole.cell_offset_of(other));
}

// The result is the offset in cells along each axis, in both directions. An offset of more than 10⁸
// cells gives nullopt.
TEST(GridWindow, ReturnsOffsetInCells) {
  const GridGeometry whole = GridGeometry::covering(field().bounds, 0.5);
  for (const int columns : {-7, 0, 3}) {
    for (const int rows : {-2, 0, 5}) {
      GridGeometry other = whole;
      other.origin_m += 0.5 * Eigen::Vector2d(columns, rows);
      EXPECT_EQ(whole.cell_offset_of(other), Eigen::Vector2i(columns, rows));
    }
  }
  for (int axis = 0; axis < 2; ++axis) {
    for (const double side : {1.0, -1.0}) {
      GridGeometry other = whole;
      other.origin_m(axis) += side * 0.5 * 0.99e8;
      EXPECT_TRUE(whole.cell_offset_of(other));
      other.origin_m(axis) += side * 0.5 * 0.02e8;
      EXPECT_FALSE(whole.cell_offset_of(other));
      other.origin_m(axis) = side * 1e300;
      EXPECT_FALSE(whole.cell_offset_of(other));
    }
  }
}

TEST(GridWindow, AgreesWithTheWholeGrid) {
  const World world = field();
  const GridGeometry whole = GridGeometry::covering(world.bounds, 0.7);
  test::Random random(8);
  for (int i = 0; i < 50; ++i) {
    const GridGeometry parts[] = {
        whole.window({random.uniform(-20, 40), random.uniform(-11, 30)}, random.uniform(1, 20)),
        whole.window({random.uniform(-20, 40), random.uniform(-11, 30)}, random.uniform(1, 20))};
    VisibilityGrid grid(world, 0.7, 0.0);
    VisibilityGrid all(world, 0.7, 0.0);
    VisibilityGrid windows[] = {{world, parts[0], 0.0}, {world, parts[1], 0.0}};
    SensorModel eye;
    eye.range_max_m = 12.0;
    for (VisibilityGrid& window : windows) {
      const Viewpoint from{{random.uniform(-20, 40), random.uniform(-11, 30), 0.0}, 1.0};
      const Time when = kNow + Duration{random.integer(1, 1000)};
      window.see(eye, from, world, when);
      all.see(eye, from, world, when);
      EXPECT_TRUE(grid.merge(window.geometry(), window.last_seen_utime(), kNoLimit));
    }
    for (int index = 0; index < whole.size(); ++index) {
      std::int64_t newest = VisibilityGrid::kNeverSeen;
      for (const VisibilityGrid& window : windows) {
        const int there = window.geometry().index_of(whole.centre_m(index));
        if (there >= 0) {
          newest = std::max(newest, window.last_seen_utime()[static_cast<std::size_t>(there)]);
        }
      }
      ASSERT_EQ(grid.last_seen_utime()[static_cast<std::size_t>(index)], newest);
      ASSERT_LE(newest, all.last_seen_utime()[static_cast<std::size_t>(index)]);
    }
  }
}

TEST(GridWindow, RefusesStampsOfOtherCells) {
  const World world = field();
  VisibilityGrid grid(world, 0.7, 0.0);
  const GridGeometry part = grid.geometry().window({0.0, 0.0}, 3.0);
  std::vector<std::int64_t> stamps(static_cast<std::size_t>(part.size()) + 1, 5);
  EXPECT_FALSE(grid.merge(part, stamps, kNoLimit));
  stamps.pop_back();
  EXPECT_TRUE(grid.merge(part, stamps, 3));
  EXPECT_EQ(*std::max_element(grid.last_seen_utime().begin(), grid.last_seen_utime().end()), 3)
      << "no stamp is later than the limit";
}

// Each cell of the window overlaps the square. If the square is outside the grid, the window is the
// nearest cell.
TEST(GridWindow, HasOnlyCellsThatOverlapTheSquare) {
  const GridGeometry whole = GridGeometry::covering(field().bounds, 0.7);
  test::Random random(9);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d around_m(random.uniform(-40, 60), random.uniform(-40, 60));
    const double half_m = random.uniform(0.0, 30.0);
    const GridGeometry part = whole.window(around_m, half_m);
    for (int axis = 0; axis < 2; ++axis) {
      const int cells = axis == 0 ? part.columns : part.rows;
      const double low_m = part.origin_m(axis);
      const double high_m = low_m + cells * 0.7;
      if (cells > 1) {
        EXPECT_GT(low_m + 0.7, around_m(axis) - half_m);
        EXPECT_LT(high_m - 0.7, around_m(axis) + half_m);
        continue;
      }
      const double begin_m = whole.origin_m(axis);
      const double end_m = begin_m + (axis == 0 ? whole.columns : whole.rows) * 0.7;
      const double nearest_m = std::clamp(around_m(axis), begin_m, end_m);
      EXPECT_LE(low_m - 1e-9, nearest_m);
      EXPECT_GE(high_m + 1e-9, nearest_m);
    }
  }
}

// Only common cells are merged, for any overlap. Nothing is merged if the number of stamps differs
// from the number of cells.
TEST(MergeStamps, KeepsTheNewerStampOfSharedCells) {
  const GridGeometry own{{0.0, 0.0}, 0.5, 3, 2};
  const GridGeometry theirs{{0.5, -0.5}, 0.5, 3, 2};  // two columns and one row in common
  std::vector<std::int64_t> stamps{1, 2, 3, 4, 5, 6};
  const std::vector<std::int64_t> others{100, 200, 300, 40, 1, 60};
  EXPECT_TRUE(merge_stamps(own, stamps, theirs, others, 50));
  EXPECT_EQ(stamps, (std::vector<std::int64_t>{1, 40, 3, 4, 5, 6}));
  std::vector<std::int64_t> back = others;
  EXPECT_TRUE(merge_stamps(theirs, back, own, {1, 2, 3, 4, 5, 6}, kNoLimit));
  EXPECT_EQ(back, (std::vector<std::int64_t>{100, 200, 300, 40, 3, 60}));
  std::vector<std::int64_t> short_one{1, 2, 3, 4, 5};
  EXPECT_FALSE(merge_stamps(own, short_one, theirs, others, 50));
  EXPECT_EQ(short_one, (std::vector<std::int64_t>{1, 2, 3, 4, 5}));
  EXPECT_FALSE(merge_stamps(own, stamps, theirs, short_one, 50));
  const GridGeometry apart{{5.0, 5.0}, 0.5, 3, 2};
  EXPECT_TRUE(merge_stamps(own, stamps, apart, others, 50));
  EXPECT_EQ(stamps, (std::vector<std::int64_t>{1, 40, 3, 4, 5, 6}));
}

TEST(GridWindow, TreatsRoundedSquaresAsEqual) {
  const GridGeometry own{{0.0, 0.0}, 0.5, 3, 2};
  const auto cell_offset_of = [&](double x_m, double y_m) {
    return own.cell_offset_of({{x_m, y_m}, 0.5, 1, 1});
  };
  ASSERT_TRUE(cell_offset_of(1.0 + 5e-10, -1.5 - 5e-10));
  EXPECT_EQ(*cell_offset_of(1.0, -1.5), Eigen::Vector2i(2, -3));
  EXPECT_FALSE(cell_offset_of(1.0 + 5e-9, -1.5));
  EXPECT_FALSE(cell_offset_of(1.0, -1.5 - 5e-9));
  EXPECT_TRUE(cell_offset_of(0.49e8, 0.0));
  EXPECT_FALSE(cell_offset_of(0.51e8, 0.0)) << "a hundred million cells away";
  EXPECT_FALSE(cell_offset_of(0.0, -0.51e8));
}

}  // namespace
}  // namespace vantage::models
