#include "estimator/view_limits.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "estimator/track.hpp"
#include "test/estimator/filter_support.hpp"

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

/// `sensor` with each limit where it may have been.
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

/// A place near the far limit or an edge of view, and inside the other.
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

TEST(ViewProbability, IsHowOftenATargetIsInViewOfLimitsThatAreOff) {
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

TEST(ViewProbability, OfLimitsThatAreExactIsWhetherItIsInView) {
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

// Truth from the belief, and a look if the limits as they were let it through: where the moments
// are those of what is possible the mean of ε' Σ⁻¹ ε is 2, whatever the posterior's shape.
TEST(Measure, IsConsistentWhereTheLimitsAreALittleOff) {
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
