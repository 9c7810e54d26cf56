#include "models/sensor/clutter.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/angle.hpp"

namespace vantage::models {
namespace {

SensorModel sensor_of(SensorKind kind) {
  SensorModel sensor;
  sensor.kind = kind;
  sensor.range_min_m = 0.5;
  sensor.range_max_m = 3.0;
  sensor.fov_rad = 1.5;
  return sensor;
}

TEST(ViewArea, EqualsSectorAreaForRangeAndBearing) {
  const SensorModel sensor = sensor_of(SensorKind::kRangeBearing);
  EXPECT_DOUBLE_EQ(view_area_m2(sensor, {}), 0.75 * (9.0 - 0.25));
}

TEST(ViewArea, EqualsGridCountForCamera) {
  SensorModel sensor = sensor_of(SensorKind::kCamera);
  sensor.range_min_m = 0.0;
  sensor.fov_rad = 2.0 * kPi;
  sensor.camera_tilt_rad = radians(40.0);
  const Viewpoint from{{0.3, -0.2, 0.7}, 1.2};
  constexpr int kSide = 1200;
  int seen = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      PositionVector y_m = PositionVector::Zero(2);
      y_m << 0.3 + 3.0 * (2.0 * (i + 0.5) / kSide - 1.0),
          -0.2 + 3.0 * (2.0 * (j + 0.5) / kSide - 1.0);
      seen += in_view(sensor, from, y_m) ? 1 : 0;
    }
  }
  const double area_m2 = 36.0 * seen / (kSide * kSide);
  ASSERT_GT(area_m2, 1.0);
  EXPECT_NEAR(view_area_m2(sensor, from), area_m2, 0.03 * area_m2);
}

TEST(SampleClutter, IsPoissonAndUniformOverTheAreaInView) {
  SensorModel sensor = sensor_of(SensorKind::kPosition);
  sensor.position_sigma_m = 1e-9;
  const Viewpoint from{{1.0, 2.0, 0.4}, 0.0};
  std::mt19937_64 rng(1);
  constexpr int kLooks = 20'000;
  double count = 0.0;
  double square = 0.0;
  double near_half = 0.0;  // false alarms in the nearer half of the area
  for (int i = 0; i < kLooks; ++i) {
    const auto alarms = sample_clutter(sensor, from, 1.7, rng);
    count += static_cast<double>(alarms.size());
    square += std::pow(static_cast<double>(alarms.size()), 2);
    for (const Measurement& z : alarms) {
      const auto y_m = position_from(sensor, from, z.z, 2);
      ASSERT_TRUE(y_m && in_view(sensor, from, *y_m));
      const double range_m = (*y_m - Eigen::Vector2d(1.0, 2.0)).norm();
      near_half += range_m * range_m < 0.5 * (9.0 + 0.25) ? 1.0 : 0.0;
    }
  }
  EXPECT_NEAR(count / kLooks, 1.7, 4.0 * std::sqrt(1.7 / kLooks));
  EXPECT_NEAR(square / kLooks - std::pow(count / kLooks, 2), 1.7, 0.08);
  EXPECT_NEAR(near_half / count, 0.5, 4.0 * 0.5 / std::sqrt(count));
}

TEST(SampleClutter, IsPoissonAtHighRates) {
  const SensorModel sensor = sensor_of(SensorKind::kPosition);
  std::mt19937_64 rng(2);
  constexpr int kLooks = 300;
  constexpr double kMean = 1200.0;
  double count = 0.0;
  double square = 0.0;
  for (int i = 0; i < kLooks; ++i) {
    const auto alarms = static_cast<double>(sample_clutter(sensor, {}, kMean, rng).size());
    count += alarms;
    square += (alarms - kMean) * (alarms - kMean);
  }
  EXPECT_NEAR(count / kLooks, kMean, 4.0 * std::sqrt(kMean / kLooks));
  EXPECT_NEAR(square / kLooks, kMean, 4.0 * kMean * std::sqrt(2.0 / kLooks));
}

TEST(SampleClutter, IsEmptyAtRateZero) {
  std::mt19937_64 rng(1);
  EXPECT_TRUE(sample_clutter(sensor_of(SensorKind::kBearing), {}, 0.0, rng).empty());
}

// False alarms are equally frequent in each quarter of the field of view, also for a sensor that
// sees a full circle.
TEST(SampleClutter, CoversBothSidesOfTheHeading) {
  SensorModel sensor = sensor_of(SensorKind::kPosition);
  sensor.position_sigma_m = 1e-9;
  for (const double fov_rad : {1.5, 2.0 * kPi}) {
    sensor.fov_rad = fov_rad;
    const Viewpoint from{{1.0, 2.0, 2.9}, 0.0};
    std::mt19937_64 rng(3);
    double count = 0.0;
    double sides[4] = {};  // false alarms per quarter of the field of view
    for (int i = 0; i < 3'000; ++i) {
      for (const Measurement& z : sample_clutter(sensor, from, 2.0, rng)) {
        const double bearing_rad = std::atan2(z.z(1), z.z(0));
        ++count;
        ++sides[std::clamp(static_cast<int>(4.0 * (bearing_rad / fov_rad + 0.5)), 0, 3)];
      }
    }
    for (const double side : sides) {
      EXPECT_NEAR(side / count, 0.25, 4.0 * std::sqrt(0.1875 / count)) << fov_rad;
    }
  }
}

// The area lies between the minimum and the maximum range, within the field of view. A camera also
// needs a minimum depth.
TEST(ViewArea, IsTheRingSectorInView) {
  SensorModel sensor = sensor_of(SensorKind::kRange);
  sensor.fov_rad = 2.0 * kPi;
  EXPECT_NEAR(view_area_m2(sensor, {}), kPi * (9.0 - 0.25), 1e-12);
  sensor.fov_rad = 7.0;  // rad; more than a full turn counts as a full turn
  EXPECT_NEAR(view_area_m2(sensor, {}), kPi * (9.0 - 0.25), 1e-12);
  sensor.kind = SensorKind::kCamera;
  sensor.camera_tilt_rad = kPi / 2.0;
  sensor.fov_rad = 1.5;
  EXPECT_NEAR(view_area_m2(sensor, {{}, 1.0}), 0.75 * (9.0 - 0.25), 1e-9);
  sensor.camera_tilt_rad = 0.0;  // rad; horizontal: sees only points at least 1 m ahead
  sensor.depth_min_m = 1.0;
  sensor.fov_rad = 2.0 * kPi;
  const double cap_m2 = 9.0 * std::acos(1.0 / 3.0) - std::sqrt(8.0);
  EXPECT_NEAR(view_area_m2(sensor, {{}, 1.0}), cap_m2, 0.02 * cap_m2);
  EXPECT_NEAR(view_area_m2(sensor, {{1.0, 1.0, 2.0}, 1.0}), cap_m2, 0.02 * cap_m2);
}

}  // namespace
}  // namespace vantage::models
