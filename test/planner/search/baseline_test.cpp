#include "planner/search/baseline.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace vantage::planner
