#include "estimator/posterior/view_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "estimator/tracks/gaussian/track.hpp"
#include "models/sensor/law.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/own_sensor.hpp"

namespace vantage::estimator {
namespace {

models::SensorModel lab_sensor(models::SensorKind kind) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 1.0;
  sensor.fov_rad = radians(94.0);
  sensor.range_sigma_m = 0.3;
  sensor.position_sigma_m = 0.3;
  sensor.pixel_sigma = 50.0;
  sensor.camera_tilt_rad = radians(80.0);
  return sensor;
}

models::Viewpoint eye() {
  models::Viewpoint from = test::at(0.3, -0.2, 0.7);
  from.height_m = 1.5;
  return from;
}

LimitSoftness softness_of(const models::SensorModel& sensor, const models::PositionVector& y_m) {
  return limit_softness(sensor, models::noise_covariance(sensor, eye(), y_m));
}

/// Returns `sensor` with each limit displaced at random, according to its softness.
models::SensorModel displaced(models::SensorModel sensor, const LimitSoftness& softness,
                              double range_m, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  sensor.range_max_m += softness.distance_m * normal(rng);
  sensor.range_min_m = std::max(0.0, sensor.range_min_m + softness.distance_m * normal(rng));
  sensor.depth_min_m += softness.distance_m * normal(rng);
  sensor.fov_rad +=
      2.0 * std::hypot(softness.angle_rad, softness.distance_m / range_m) * normal(rng);
  return sensor;
}

/// Returns a position near the maximum range or near an edge of the field of view, and within the
/// other limit.
Eigen::Vector2d place_near_a_limit(double off_m, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const bool is_far = unit(rng) > 0.0;
  const double range_m = is_far ? 1.0 + off_m * unit(rng) : 0.6 + 0.3 * unit(rng);
  const double side = unit(rng) > 0.0 ? 1.0 : -1.0;
  const double bearing_rad =
      is_far ? radians(30.0) * unit(rng) : side * radians(47.0) + off_m / range_m * unit(rng);
  const double angle_rad = eye().world_from_body.yaw_rad + bearing_rad;
  return eye().world_from_body.position_m() +
         range_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
}

TEST(ViewProbability, EqualsTheSampledFrequency) {
  std::mt19937_64 rng(3);
  constexpr int kDraws = 3000;
  for (const auto kind : models::all_sensor_kinds()) {
    const models::SensorModel sensor = lab_sensor(kind);
    for (int trial = 0; trial < 10; ++trial) {
      const models::PositionVector y_m = place_near_a_limit(0.05, rng);
      const LimitSoftness softness = softness_of(sensor, y_m);
      const double range_m = (y_m.head<2>() - eye().world_from_body.position_m()).norm();
      const double probability = view_probability(sensor, softness, eye(), y_m);
      int seen = 0;
      for (int i = 0; i < kDraws; ++i) {
        seen += models::in_view(displaced(sensor, softness, range_m, rng), eye(), y_m) ? 1 : 0;
      }
      const double slack = 4.0 * std::sqrt(0.25 / kDraws);
      EXPECT_NEAR(static_cast<double>(seen) / kDraws, probability, slack) << kind.name();
    }
  }
}

constexpr double kNoDepth_m = std::numeric_limits<double>::infinity();

double normal_below(double sigmas) { return 0.5 * std::erfc(-sigmas / std::sqrt(2.0)); }

/// Returns a sensor with limits far apart, so that only one limit at a time has an effect.
models::SensorModel wide_sensor(models::SensorKind kind) {
  models::SensorModel sensor = lab_sensor(kind);
  sensor.range_min_m = 2.0;
  sensor.range_max_m = 10.0;
  sensor.fov_rad = 2.0;
  sensor.depth_min_m = 0.5;
  return sensor;
}

TEST(LimitSoftness, IsATenthOfTheMeasurementsSigma) {
  const Eigen::Vector2d variances(0.04, 0.09);
  const models::MeasurementMatrix V = variances.asDiagonal();
  const models::MeasurementMatrix V1 = V.topLeftCorner(1, 1);
  const auto expect = [](const LimitSoftness& of, double distance_m, double angle_rad) {
    EXPECT_NEAR(of.distance_m, distance_m, 1e-15);
    EXPECT_NEAR(of.angle_rad, angle_rad, 1e-15);
  };
  using models::SensorKind;
  expect(limit_softness(wide_sensor(SensorKind::kPosition), V), 0.02, 0.0);
  expect(limit_softness(wide_sensor(SensorKind::kRange), V1), 0.02, 0.0);
  expect(limit_softness(wide_sensor(SensorKind::kBearing), V1), 0.0, 0.02);
  expect(limit_softness(wide_sensor(SensorKind::kRangeBearing), V), 0.02, 0.03);
  models::SensorModel camera = wide_sensor(SensorKind::kCamera);
  camera.focal_length_pixels = 50.0;
  expect(limit_softness(camera, V), 0.0, 0.02 / 50.0);
}

// Sensor kinds with custom limits have exact limits. If such a kind measures a bearing, only its
// angle limit is soft.
TEST(LimitSoftness, IsZeroForSensorsWithCustomLimits) {
  const models::MeasurementMatrix V1 = 0.04 * Eigen::Matrix<double, 1, 1>::Identity();
  models::SensorLaw law = vantage::test::signal_strength_law();
  models::SensorModel own;
  own.kind = models::SensorKind(law);
  for (const bool is_linear : {false, true}) {
    law.is_linear = is_linear;
    law.measures_range = !is_linear;
    EXPECT_EQ(limit_softness(own, V1).distance_m, 0.0);
    EXPECT_EQ(limit_softness(own, V1).angle_rad, 0.0);
  }
  law.measures_bearing = true;
  EXPECT_NEAR(limit_softness(own, V1).angle_rad, 0.02, 1e-15);
  law.measures_bearing = law.is_linear = false;
  law.measures_range = true;
  law.can_measure = nullptr;
  EXPECT_NEAR(limit_softness(own, V1).distance_m, 0.02, 1e-15);
}

TEST(ViewProbability, IsANormalDistributionAtEachLimit) {
  const models::SensorModel sensor = wide_sensor(models::SensorKind::kRangeBearing);
  const models::SensorModel camera = wide_sensor(models::SensorKind::kCamera);
  const LimitSoftness soft{0.1, 0.02};
  const double side_rad = std::hypot(0.02, 0.1 / 4.0);
  for (const double n : {-3.0, -1.0, 0.0, 0.5, 2.0}) {
    const double expected = normal_below(n);
    const auto is = [&](const models::SensorModel& of, double range_m, double horizontal_m,
                        double bearing_rad, double depth_m) {
      EXPECT_NEAR(view_probability(of, soft, range_m, horizontal_m, bearing_rad, depth_m), expected,
                  1e-12)
          << n;
    };
    is(sensor, 10.0 - 0.1 * n, 5.0, 0.0, kNoDepth_m);
    is(sensor, 5.0, 5.0, 0.0, 0.5 + 0.1 * n);
    is(sensor, 6.0, 2.0 + 0.1 * n, 0.0, kNoDepth_m);  // horizontal minimum distance
    is(camera, 2.0 + 0.1 * n, 1.0, 0.0, 1.5);         // distance in space
    is(camera, 6.0, 1.0, 0.0, 0.5 + 0.1 * n);
    for (const double side : {-1.0, 1.0}) {
      is(sensor, 4.0, 4.0, side * (1.0 - side_rad * n), kNoDepth_m);
      is(sensor, 4.0, 4.0, side * (1.0 - side_rad * n - 2.0 * kPi), kNoDepth_m);
    }
  }
  // With several limits, the result is the product of their probabilities.
  const double side_there_rad = std::hypot(0.02, 0.1 / 2.05);
  EXPECT_NEAR(view_probability(sensor, soft, 9.95, 2.05, 1.0 + side_there_rad, 0.7),
              normal_below(0.5) * normal_below(0.5) * normal_below(-1.0) * normal_below(2.0),
              1e-12);
}

TEST(ViewProbability, IsOneFarFromLimits) {
  models::SensorModel sensor = wide_sensor(models::SensorKind::kRangeBearing);
  const LimitSoftness soft{0.1, 0.02};
  const auto at_range = [&](double range_m) {
    return view_probability(sensor, soft, range_m, range_m, 0.0, kNoDepth_m);
  };
  EXPECT_EQ(at_range(10.0 - 0.61), 1.0);
  EXPECT_EQ(at_range(10.0 + 0.61), 0.0);
  EXPECT_GT(at_range(10.0 + 0.59), 0.0);
  EXPECT_EQ(at_range(2.0 - 0.61), 0.0);
  EXPECT_GT(at_range(2.0 - 0.59), 0.0);
  // A target at a horizontal distance of 0 or behind the image plane is not visible.
  EXPECT_NEAR(view_probability(sensor, soft, 6.0, 0.0, 0.0, kNoDepth_m), 0.0, 1e-12);
  sensor.range_min_m = 0.0;
  EXPECT_EQ(at_range(5.0), 1.0);
  EXPECT_NEAR(at_range(0.0), 0.5, 1e-6) << "at range 0 the direction is undefined";
  sensor.depth_min_m = -1.0;
  EXPECT_EQ(view_probability(sensor, soft, 5.0, 5.0, 0.0, 0.0), 0.0);
  EXPECT_EQ(view_probability(sensor, soft, 5.0, 5.0, 0.0, -0.3), 0.0);
  EXPECT_EQ(view_probability(sensor, soft, 5.0, 5.0, kPi, kNoDepth_m), 0.0);
  sensor.fov_rad = 2.0 * kPi;
  EXPECT_EQ(view_probability(sensor, soft, 5.0, 5.0, kPi, kNoDepth_m), 1.0);
  EXPECT_EQ(view_probability(sensor, soft, 0.0, 0.0, 1.0, kNoDepth_m), 1.0);
}

TEST(ViewProbability, IsAProductOverRangeBearingAndDepth) {
  const LimitSoftness soft{0.1, 0.02};
  models::Viewpoint from = test::at(101.0, -52.0, 2.5);
  from.height_m = 4.0;
  const double yaw_rad = from.world_from_body.yaw_rad;
  for (const double away_m : {0.3, 2.05, 6.0, 9.3, 10.55}) {
    for (const double bearing_rad : {-0.98, 0.0, 1.01}) {
      const double angle_rad = yaw_rad + bearing_rad;
      const Eigen::Vector2d place_m(101.0 + away_m * std::cos(angle_rad),
                                    -52.0 + away_m * std::sin(angle_rad));
      models::SensorModel sensor = wide_sensor(models::SensorKind::kRangeBearing);
      EXPECT_NEAR(view_probability(sensor, soft, from, place_m),
                  view_probability(sensor, soft, away_m, away_m, bearing_rad, kNoDepth_m), 1e-9);
      const Eigen::Vector3d in_space_m(place_m.x(), place_m.y(), 0.8);
      const double range_m = std::hypot(away_m, 3.2);
      EXPECT_NEAR(view_probability(sensor, soft, from, in_space_m),
                  view_probability(sensor, soft, range_m, away_m, bearing_rad, kNoDepth_m), 1e-9);
      sensor = wide_sensor(models::SensorKind::kCamera);
      sensor.camera_tilt_rad = 0.5 * kPi;  // rad; straight down, depth is height
      sensor.depth_min_m = 3.1;
      EXPECT_NEAR(view_probability(sensor, soft, from, in_space_m),
                  view_probability(sensor, soft, range_m, away_m, bearing_rad, 3.2), 1e-9);
      sensor.camera_tilt_rad = 0.0;  // along body x
      sensor.depth_min_m = 2.0;
      EXPECT_NEAR(view_probability(sensor, soft, from, in_space_m),
                  view_probability(sensor, soft, range_m, away_m, bearing_rad,
                                   away_m * std::cos(bearing_rad)),
                  1e-9);
    }
  }
  // At the sensor's own position, a range has no direction, but a position measurement is defined.
  models::SensorModel sensor = wide_sensor(models::SensorKind::kRange);
  sensor.range_min_m = 0.0;
  sensor.fov_rad = 2.0 * kPi;
  EXPECT_EQ(view_probability(sensor, soft, from, Eigen::Vector2d(101.0, -52.0)), 0.0);
  sensor.kind = models::SensorKind::kPosition;
  EXPECT_EQ(view_probability(sensor, soft, from, Eigen::Vector2d(101.0, -52.0)), 1.0);
}

TEST(ViewProbability, IsZeroOrOneForExactLimits) {
  std::mt19937_64 rng(4);
  for (const auto kind : models::all_sensor_kinds()) {
    const models::SensorModel sensor = lab_sensor(kind);
    for (int trial = 0; trial < 200; ++trial) {
      const models::PositionVector y_m = test::normal_vector(2, rng);
      EXPECT_EQ(view_probability(sensor, {}, eye(), y_m),
                models::in_view(sensor, eye(), y_m) ? 1.0 : 0.0);
    }
  }
}

// Truth is drawn from the prior and observed if it is within the displaced limits. If the moments
// are correct, the mean of ε' Σ⁻¹ ε is 2, for any shape of the posterior.
TEST(Measure, IsConsistentWithInaccurateLimits) {
  constexpr int kCases = 1500;
  constexpr double kSigma_m = 0.02;
  std::mt19937_64 rng(5);
  for (const auto kind : models::all_sensor_kinds()) {
    const models::SensorModel sensor = lab_sensor(kind);
    test::MeanNees nees;
    while (nees.cases() < kCases) {
      const Eigen::Vector2d mean_m = place_near_a_limit(0.03, rng);
      const Eigen::Vector2d true_m = mean_m + kSigma_m * test::normal_vector(2, rng);
      const LimitSoftness softness = softness_of(sensor, mean_m);
      const double range_m = (true_m - eye().world_from_body.position_m()).norm();
      if (!models::in_view(displaced(sensor, softness, range_m, rng), eye(), true_m)) {
        continue;
      }
      auto belief =
          models::to_information({mean_m, kSigma_m * kSigma_m * Eigen::Matrix2d::Identity()})
              .value();
      const auto z = models::sample(sensor, eye(), true_m, rng);
      ASSERT_EQ(measure(belief, sensor, eye(), z, 0.0), Use::kUsed);
      nees.add(models::to_gaussian(belief).value(), true_m);
    }
    RecordProperty(std::string(kind.name()), std::to_string(nees.mean()));
    EXPECT_NEAR(nees.mean(), 2.0, std::max(3.0 * nees.sigma(), 0.1)) << kind.name();
  }
}

}  // namespace
}  // namespace vantage::estimator
