#include "models/sensor/law.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/sensor/sensor.hpp"
#include "test/models/sensor/random_target.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

using test::kKinds;
using test::of_kind;
using test::random_target;

// The planar law, which planners use, gives the same matrix as information(). It has a part along
// the line of sight, a part across it, and an isotropic part.
TEST(SensorLaw, PlanarLawEqualsInformation) {
  test::Random random(68);
  for (const SensorKind kind : kKinds) {
    const SensorLaw& law = kind.law();
    ASSERT_EQ(law.planar_law == nullptr,
              kind == SensorKind::kCamera || law.velocity_jacobian != nullptr);
    for (int i = 0; i < 300 && law.planar_law != nullptr; ++i) {
      SensorModel sensor = of_kind(kind);
      sensor.range_sigma_m = random.uniform(0.05, 0.5);
      sensor.bearing_sigma_rad = random.uniform(0.02, 0.2);
      sensor.position_sigma_m = random.uniform(0.05, 0.5);
      sensor.calibration = {random.uniform(0.8, 1.2), random.uniform(-0.3, 0.3)};
      sensor.variance_grows_with_range = kind != SensorKind::kPosition && random.coin();
      sensor.variance_floor = 0.3;
      const Viewpoint from{random.pose2(4.0), 2.0};
      const PositionVector target = random_target(random, 2, 4.0);
      const PlanarLaw planar = law.planar_law(sensor);
      const Eigen::Vector2d d_m = target.head<2>() - from.world_from_body.position_m();
      const double r_m = d_m.norm();
      if (r_m <= sensor.range_min_m || r_m >= sensor.range_max_m) {
        continue;
      }
      const double growth =
          sensor.variance_grows_with_range ? std::max(0.3, r_m / sensor.range_max_m) : 1.0;
      const Eigen::Matrix2d along = d_m * d_m.transpose() / (r_m * r_m);
      const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
      const Eigen::Matrix2d expected =
          (planar.along_per_m2 * along + planar.across_per_rad2 / (r_m * r_m) * (I - along)) /
              growth +
          planar.isotropic_per_m2 * I;
      ASSERT_TRUE(test::is_near(information(sensor, from, target), expected,
                                1e-9 * (1.0 + expected.norm())))
          << kind.name();
    }
  }
}

// A target is in view up to a minimum depth of depth_per_m() times its distance, in all directions.
TEST(SensorLaw, CameraDepthPerMetreAgreesWithInView) {
  test::Random random(69);
  for (const SensorKind kind : kKinds) {
    if (kind != SensorKind::kCamera) {
      EXPECT_EQ(kind.law().depth_per_m, nullptr) << kind.name();
      continue;
    }
    int seen = 0;
    for (int i = 0; i < 500; ++i) {
      SensorModel camera = of_kind(kind);
      camera.range_min_m = 0.0;
      camera.range_max_m = 50.0;
      camera.camera_tilt_rad = random.uniform(0.0, kPi / 2);
      const Viewpoint from{random.pose2(3.0), 2.0};
      PositionVector target = random_target(random, 3, 4.0);
      target(2) = random.uniform(0.0, 4.0);
      const Eigen::Vector3d d_m(target(0) - from.world_from_body.x_m,
                                target(1) - from.world_from_body.y_m, target(2) - 2.0);
      const double level_m = d_m.head<2>().norm();
      const double bearing_rad = std::atan2(d_m.y(), d_m.x()) - from.world_from_body.yaw_rad;
      const double depth_m =
          d_m.norm() *
          kind.law().depth_per_m(camera, bearing_rad, level_m / d_m.norm(), d_m.z() / d_m.norm());
      camera.depth_min_m = depth_m - 1e-6;
      EXPECT_EQ(in_view(camera, from, target), depth_m > 0.0);
      camera.depth_min_m = depth_m + 1e-6;
      EXPECT_FALSE(in_view(camera, from, target));
      seen += depth_m > 0.0 ? 1 : 0;
    }
    EXPECT_GT(seen, 100);
  }
}

TEST(SensorLaw, DescribesTheMeasurementOfEachKind) {
  for (const SensorKind kind : kKinds) {
    const bool range = kind == SensorKind::kRange || kind == SensorKind::kRangeBearing ||
                       kind == SensorKind::kRangeRate;
    const bool bearing = kind == SensorKind::kBearing || kind == SensorKind::kRangeBearing;
    EXPECT_EQ(kind.law().measures_range, range) << kind.name();
    EXPECT_EQ(kind.law().measures_bearing, bearing) << kind.name();
    EXPECT_EQ(kind.law().is_linear, kind == SensorKind::kPosition) << kind.name();
    EXPECT_EQ(kind.law().velocity_jacobian != nullptr, kind == SensorKind::kRangeRate)
        << kind.name();
    const SensorModel sensor = of_kind(kind);
    for (const int dim : {2, 3}) {
      const Viewpoint from{{0.0, 0.0, 0.0}, 2.0};
      const PositionVector target = PositionVector::Constant(dim, 1.0);
      EXPECT_EQ(sensor.measurement_dim(dim), observe(sensor, from, target).rows());
      EXPECT_EQ(sensor.measurement_dim(dim), noise_covariance(sensor, from, target).rows());
    }
  }
}

TEST(Viewpoints, DistanceIncludesHeight) {
  const Viewpoint a{{1.0, 2.0, 0.3}, 1.0};
  const Viewpoint b{{3.0, 5.0, -2.0}, 7.0};
  EXPECT_NEAR(distance_m(a, b), 7.0, 1e-12);
  EXPECT_NEAR(distance_m(b, a), 7.0, 1e-12);
  EXPECT_EQ(distance_m(a, a), 0.0);
}

// Each noise variance is the square of its sigma and independent of all other parameters.
TEST(NoiseCovariance, IsTheSquareOfTheSigmas) {
  SensorModel sensor;
  sensor.range_sigma_m = 2.0;
  sensor.bearing_sigma_rad = 3.0;
  sensor.position_sigma_m = 5.0;
  sensor.pixel_sigma = 7.0;
  const Viewpoint from{{0.0, 0.0, 0.0}, 2.0};
  const auto expect = [&](SensorKind kind, int dim, const std::vector<double>& variances) {
    sensor.kind = kind;
    const MeasurementMatrix V = noise_covariance(sensor, from, PositionVector::Constant(dim, 1.0));
    ASSERT_EQ(static_cast<std::size_t>(V.rows()), variances.size());
    for (Eigen::Index row = 0; row < V.rows(); ++row) {
      EXPECT_EQ(V(row, row), variances[static_cast<std::size_t>(row)]) << kind.name();
    }
  };
  expect(SensorKind::kRange, 2, {4.0});
  expect(SensorKind::kBearing, 3, {9.0});
  expect(SensorKind::kRangeBearing, 2, {4.0, 9.0});
  expect(SensorKind::kPosition, 2, {25.0, 25.0});
  expect(SensorKind::kPosition, 3, {25.0, 25.0, 25.0});
  expect(SensorKind::kCamera, 2, {49.0, 49.0});
}

}  // namespace
}  // namespace vantage::models
