#include "planner/search/crossing_index.hpp"

#include <gtest/gtest.h>

namespace vantage::planner {
namespace {

TEST(PoseMetric, CountsTheShorterTurnEitherWay) {
  const PoseMetric metric{2.0};
  for (const double yaw_rad : {-3.1, -2.0, -0.2, 0.0, 0.4, 2.5, kPi}) {
    for (const double turn_rad : {-3.0, -0.1, 0.0, 0.1, 3.0}) {
      const Pose2 a{0.0, 0.0, yaw_rad};
      const Pose2 b{3.0, -4.0, wrap_to_pi(yaw_rad + turn_rad)};
      const double expected_m2 = 25.0 + 4.0 * turn_rad * turn_rad;
      EXPECT_NEAR(metric.squared(a, b), expected_m2, 1e-12) << yaw_rad << " and " << turn_rad;
      EXPECT_NEAR(metric.squared(b, a), expected_m2, 1e-12) << yaw_rad << " and " << turn_rad;
    }
  }
}

}  // namespace
}  // namespace vantage::planner
