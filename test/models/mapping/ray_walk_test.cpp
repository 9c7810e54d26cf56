#include "models/mapping/ray_walk.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

const GridGeometry kGrid{{-1.0, 2.0}, 0.25, 32, 18};

TEST(RayWalk, VisitsTheCellsOfARow) {
  std::vector<int> cells;
  std::vector<double> enter_m;
  for (RayWalk walk(kGrid, {-0.9, 2.1}, 0.0, 0.7); walk.next();) {
    cells.push_back(walk.cell());
    enter_m.push_back(walk.enter_m());
  }
  EXPECT_EQ(cells, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_NEAR(enter_m[1], 0.15, 1e-12);
  EXPECT_NEAR(enter_m[3], 0.65, 1e-12);
}

TEST(RayWalk, CoversTheRayWithItsCells) {
  test::Random random(4101);
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector2d from_m(random.uniform(-1.0, 7.0), random.uniform(2.0, 6.5));
    // Every fourth ray is along an axis or a diagonal.
    const double bearing_rad =
        i % 4 == 0 ? random.integer(-4, 4) * kPi / 4.0 : random.uniform(-kPi, kPi);
    const double range_m = random.uniform(0.0, 6.0);
    const Eigen::Vector2d along(std::cos(bearing_rad), std::sin(bearing_rad));
    double end_m = 0.0;
    for (RayWalk walk(kGrid, from_m, bearing_rad, range_m); walk.next();) {
      ASSERT_EQ(walk.enter_m(), end_m);
      ASSERT_GE(walk.exit_m(), walk.enter_m());
      const Eigen::Vector2d middle_m =
          from_m + 0.5 * (walk.enter_m() + walk.exit_m()) * along - kGrid.centre_m(walk.cell());
      ASSERT_LE(middle_m.cwiseAbs().maxCoeff(), 0.125 + 1e-9);
      end_m = walk.exit_m();
    }
    const Eigen::Vector2d beyond_m = from_m + (end_m + 1e-6) * along;
    ASSERT_TRUE(end_m == range_m || kGrid.index_of(beyond_m) < 0);
  }
}

TEST(RayWalk, IsEmptyOutsideTheGridOrWithZeroRange) {
  EXPECT_FALSE(RayWalk(kGrid, {-1.1, 3.0}, 0.0, 1.0).next());
  EXPECT_FALSE(RayWalk(kGrid, {0.0, 3.0}, 0.0, 0.0).next());
  EXPECT_FALSE(RayWalk(kGrid, {0.0, 3.0}, std::nan(""), 1.0).next());
}

}  // namespace
}  // namespace vantage::models
