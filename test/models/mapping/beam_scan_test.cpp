#include "models/mapping/beam_scan.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/support/random.hpp"

namespace vantage::models {
namespace {

const models::World kWorld{{{0.0, 0.0}, {8.0, 6.0}},
                           3.0,
                           {{{{2.0, 2.0}, {3.0, 4.0}}, 3.0}, {{{5.0, 1.0}, {7.0, 2.0}}, 3.0}},
                           {}};

TEST(RayDistance, EqualsTheGeometricDistance) {
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {1.0, 3.0}, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {1.0, 3.0}, kPi), 1.0);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {1.0, 1.0}, kPi / 4.0), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {4.0, 5.0}, 0.0), 4.0);
  EXPECT_EQ(ray_distance_m(kWorld, {2.5, 3.0}, 1.0), 0.0) << "inside an obstacle";
  EXPECT_EQ(ray_distance_m(kWorld, {-1.0, 3.0}, 0.0), 0.0) << "outside";
}

TEST(RayDistance, AgreesWithLineOfSight) {
  test::Random random(4901);
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector2d from_m(random.uniform(0.0, 8.0), random.uniform(0.0, 6.0));
    if (models::clearance_m(kWorld, from_m) < 1e-6) {
      continue;
    }
    const double bearing_rad = random.uniform(-kPi, kPi);
    const Eigen::Vector2d along(std::cos(bearing_rad), std::sin(bearing_rad));
    const double distance_m = ray_distance_m(kWorld, from_m, bearing_rad);
    const Eigen::Vector2d short_m = from_m + (distance_m - 1e-9) * along;
    const Eigen::Vector2d beyond_m = from_m + (distance_m + 1e-4) * along;
    ASSERT_TRUE(models::line_of_sight(kWorld, from_m, short_m));
    ASSERT_NEAR(models::clearance_m(kWorld, short_m), 0.0, 1e-6);
    // The point beyond the hit is inside an obstacle, unless the ray only touches a corner.
    if (models::clearance_m(kWorld, beyond_m) > 0.0) {
      ASSERT_FALSE(models::line_of_sight(kWorld, from_m, beyond_m));
    }
  }
}

TEST(BeamScan, ClampsDistancesToTheSensorsRange) {
  test::Random random(4902);
  const models::BeamSensor sensor{360, 2.0 * kPi, 0.8, 2.5, 0.01};
  const Pose2 at{1.5, 3.0, 0.7};
  double squares = 0.0;
  for (int repeat = 0; repeat < 20; ++repeat) {
    const std::vector<double> ranges_m = beam_scan(kWorld, sensor, at, random.engine());
    ASSERT_EQ(ranges_m.size(), 360U);
    for (int beam = 0; beam < 360; ++beam) {
      const double d_m =
          ray_distance_m(kWorld, at.position_m(), at.yaw_rad + sensor.bearing_rad(beam));
      const double mean_m = d_m < 0.8 ? 0.0 : d_m > 2.5 ? 2.5 : d_m;
      squares += std::pow((ranges_m[static_cast<std::size_t>(beam)] - mean_m) / 0.01, 2);
    }
  }
  EXPECT_NEAR(squares / 7'200, 1.0, 0.07);  // tolerance: 4 σ of a mean of 7200 χ²₁ values
}

// Tests rays parallel to an axis, in both directions. They pass a box, follow its edge or hit it.
TEST(RayDistance, IsExactAlongAxes) {
  const double up = kPi / 2.0;
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {2.5, 1.0}, up), 1.0);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {2.5, 5.0}, -up), 1.0);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {1.9, 1.0}, up), 5.0) << "passes on the left";
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {3.1, 5.5}, -up), 5.5) << "passes on the right";
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {4.0, 1.9}, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {4.0, 2.1}, 0.0), 4.0);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {4.0, 0.9}, 0.0), 4.0);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {7.5, 1.5}, kPi), 0.5);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {7.5, 1.5}, 0.0), 0.5) << "no obstacle is behind";
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {6.0, 0.5}, up), 0.5);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {6.0, 0.5}, -up), 0.5);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {6.0, 5.5}, up), 0.5);
  EXPECT_DOUBLE_EQ(ray_distance_m(kWorld, {0.0, 0.0}, 0.0), 8.0) << "along the wall";
  EXPECT_EQ(ray_distance_m(kWorld, {8.1, 3.0}, kPi), 0.0);
  EXPECT_EQ(ray_distance_m(kWorld, {4.0, 6.1}, -up), 0.0);
  EXPECT_EQ(ray_distance_m(kWorld, {4.0, -0.1}, up), 0.0);
}

}  // namespace
}  // namespace vantage::models
