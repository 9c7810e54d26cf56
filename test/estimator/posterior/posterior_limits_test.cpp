#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/posterior/posterior_moments.hpp"
#include "models/sensor/law.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/posterior/dense_posterior.hpp"

// Tests of the effect of each sensor limit on the posterior moments, one limit at a time.

namespace vantage::estimator {
namespace {

using models::SensorKind;
using models::SensorModel;
using test::at;

models::Viewpoint eye() {
  models::Viewpoint from = at(0.5, -0.3, 0.8);
  from.height_m = 3.0;
  return from;
}

SensorModel open_sensor(SensorKind kind) {
  SensorModel sensor = test::far_sighted(kind);
  sensor.range_min_m = 0.0;
  sensor.depth_min_m = 0.0;
  sensor.camera_tilt_rad = radians(60.0);
  return sensor;
}

/// Returns a position at horizontal distance away_m from the sensor; height_m applies when dim is
/// 3.
Eigen::VectorXd place_m(double away_m, double bearing_rad, int dim, double height_m = 0.5) {
  const double angle_rad = eye().world_from_body.yaw_rad + bearing_rad;
  Eigen::VectorXd out = Eigen::VectorXd::Constant(dim, height_m);
  out.head(2) = eye().world_from_body.position_m() +
                away_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  return out;
}

/// Returns a noise-free measurement with a stated standard deviation of noise_times the true one.
models::Measurement seen(const SensorModel& sensor, const Eigen::VectorXd& there_m,
                         double noise_times) {
  const models::PositionVector y_m = there_m;
  models::Measurement z{models::observe(sensor, eye(), y_m),
                        models::noise_covariance(sensor, eye(), y_m)};
  z.V *= noise_times * noise_times;
  return z;
}

double range_m(double away_m, int dim, double height_m = 0.5) {
  return dim == 3 ? std::hypot(away_m, 3.0 - height_m) : away_m;
}

struct Case {
  std::string limit;
  double bearing_rad;
  std::function<void(SensorModel&)> set;
};

class AtLimits : public ::testing::TestWithParam<SensorKind> {};

// If prior and measurement agree on a position far outside a stated limit, the limit is wrong and
// is ignored.
TEST_P(AtLimits, IgnoresContradictedLimits) {
  for (const int dim : {2, 3}) {
    const SensorModel open = open_sensor(GetParam());
    std::vector<Case> cases = {
        {"far", 0.4, [](SensorModel& sensor) { sensor.range_max_m = 1.5; }},
        {"near", -0.4, [](SensorModel& sensor) { sensor.range_min_m = 6.0; }},
        {"left", 0.4, [](SensorModel& sensor) { sensor.fov_rad = 0.2; }},
        {"right", -0.4, [](SensorModel& sensor) { sensor.fov_rad = 0.2; }}};
    if (GetParam() == SensorKind::kCamera) {
      cases.push_back({"depth", 0.4, [](SensorModel& sensor) { sensor.depth_min_m = 9.0; }});
    }
    for (const Case& each : cases) {
      SensorModel limited = open;
      each.set(limited);
      const Eigen::VectorXd there_m = place_m(3.0, each.bearing_rad, dim);
      const PositionPrior prior{there_m, 400.0 * Eigen::MatrixXd::Identity(dim, dim)};
      const models::Measurement z = seen(open, there_m, 0.5);
      const auto right = posterior_moments(prior, open, eye(), z);
      const auto found = posterior_moments(prior, limited, eye(), z);
      ASSERT_TRUE(right && found) << each.limit << dim;
      EXPECT_EQ(found->mean_m, right->mean_m) << each.limit << dim;
      EXPECT_EQ(found->covariance_m2, right->covariance_m2) << each.limit << dim;
      EXPECT_EQ(found->mahalanobis2, right->mahalanobis2) << each.limit << dim;
    }
  }
}

/// Compares the moments with brute force, for a limit about 0.1 m before the prior mean.
void expect_as_by_brute_force(SensorKind kind, const Case& each, int dim, double noise_times,
                              int points, double tolerance) {
  const SensorModel open = open_sensor(kind);
  SensorModel limited = open;
  each.set(limited);
  const Eigen::VectorXd there_m = place_m(3.0, each.bearing_rad, dim);
  Eigen::MatrixXd P = 0.06 * Eigen::MatrixXd::Identity(dim, dim);
  P(0, 1) = P(1, 0) = 0.02;
  const models::Measurement z = seen(open, there_m, noise_times);
  const Eigen::MatrixXd Omega = P.inverse();
  const auto found = posterior_moments({there_m, Omega}, limited, eye(), z);
  const auto without = posterior_moments({there_m, Omega}, open, eye(), z);
  const auto oracle = test::dense_posterior(there_m, Omega, limited, eye(), z, true, points);
  ASSERT_TRUE(found && without && oracle) << each.limit;
  const test::Difference d = test::difference(found->mean_m, found->covariance_m2, *oracle);
  const test::Difference much = test::difference(without->mean_m, without->covariance_m2, *oracle);
  const std::string what =
      std::string(kind.name()) + " " + each.limit + " " + std::to_string(noise_times);
  EXPECT_LT(d.mean_sigma, tolerance) << what;
  EXPECT_LT(d.covariance_share, 2.0 * tolerance) << what;
  EXPECT_GT(much.mean_sigma, 0.3) << what << ": the limit matters";
  EXPECT_EQ(found->mahalanobis2, without->mahalanobis2) << what;
}

// The test uses two noise levels. The camera's posterior is integrated on a coarse grid, so its
// tolerance is larger.
TEST_P(AtLimits, EqualsBruteForceInThePlane) {
  std::vector<Case> cases = {{"far", 0.3, [](SensorModel& sensor) { sensor.range_max_m = 2.9; }},
                             {"near", -0.3, [](SensorModel& sensor) { sensor.range_min_m = 3.1; }},
                             {"left", 0.5, [](SensorModel& sensor) { sensor.fov_rad = 0.94; }},
                             {"right", -0.5, [](SensorModel& sensor) { sensor.fov_rad = 0.94; }}};
  if (GetParam() == SensorKind::kCamera) {
    // The depth is measured along the optical axis, which is tilted by 60° below body x.
    const double depth_m = 3.0 * std::cos(0.3) * 0.5 + 3.0 * std::sqrt(0.75);
    cases.push_back(
        {"depth", 0.3, [=](SensorModel& sensor) { sensor.depth_min_m = depth_m + 0.03; }});
  }
  for (const Case& each : cases) {
    const double more = GetParam() == SensorKind::kCamera ? 12.0 : 1.0;  // pixel noise is small
    for (const double noise_times : {4.0, 8.0}) {
      expect_as_by_brute_force(GetParam(), each, 2, more * noise_times, 120,
                               GetParam() == SensorKind::kCamera ? 0.12 : 0.03);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EverySensor, AtLimits, ::testing::ValuesIn(models::all_sensor_kinds()));

// The minimum distance of a bearing sensor is horizontal and that of a range sensor is in space. A
// camera's depth is along its optical axis.
TEST(PosteriorMoments, EqualBruteForceInSpace) {
  const auto near = [](double least_m) {
    return Case{"near", 0.3, [=](SensorModel& sensor) { sensor.range_min_m = least_m; }};
  };
  expect_as_by_brute_force(SensorKind::kRangeBearing, near(3.1), 3, 2.0, 48, 0.05);
  expect_as_by_brute_force(SensorKind::kBearing, near(3.1), 3, 4.0, 48, 0.05);
  expect_as_by_brute_force(SensorKind::kRange, near(range_m(3.0, 3) + 0.1), 3, 4.0, 48, 0.05);
  const double depth_m = 3.0 * std::cos(0.3) * 0.5 + 2.5 * std::sqrt(0.75);
  expect_as_by_brute_force(
      SensorKind::kCamera,
      {"depth", 0.3, [=](SensorModel& sensor) { sensor.depth_min_m = depth_m + 0.1; }}, 3, 20.0, 48,
      0.05);
}

// For a sensor kind with exact limits, a mirrored scene gives mirrored moments.
TEST(PosteriorMoments, AreSymmetricAtExactLimits) {
  models::SensorLaw law = SensorKind(SensorKind::kRange).law();
  law.can_measure = [](const SensorModel&, const models::Viewpoint&, const models::SightLine&) {
    return true;
  };
  SensorModel sensor = open_sensor(SensorKind(law));
  sensor.fov_rad = 1.0;
  for (const double bearing_rad : {0.4, 0.5, 0.55}) {
    models::Viewpoint from;
    const Eigen::Vector2d left_m(3.0 * std::cos(bearing_rad), 3.0 * std::sin(bearing_rad));
    const Eigen::Matrix2d Omega = 16.0 * Eigen::Matrix2d::Identity();
    const models::Measurement z{Eigen::Matrix<double, 1, 1>(3.05),
                                Eigen::Matrix<double, 1, 1>(0.04)};
    const auto left = posterior_moments({left_m, Omega}, sensor, from, z);
    const auto right =
        posterior_moments({Eigen::Vector2d(left_m.x(), -left_m.y()), Omega}, sensor, from, z);
    const auto oracle = test::dense_posterior(left_m, Omega, sensor, from, z, true, 200);
    ASSERT_TRUE(left && right && oracle);
    EXPECT_NEAR(left->mean_m.x(), right->mean_m.x(), 1e-9);
    EXPECT_NEAR(left->mean_m.y(), -right->mean_m.y(), 1e-9);
    EXPECT_NEAR(left->covariance_m2(0, 1), -right->covariance_m2(0, 1), 1e-9);
    EXPECT_NEAR(left->covariance_m2(1, 1), right->covariance_m2(1, 1), 1e-9);
    const test::Difference d = test::difference(left->mean_m, left->covariance_m2, *oracle);
    EXPECT_LT(d.mean_sigma, 0.04) << bearing_rad;
    EXPECT_LT(d.covariance_share, 0.04) << bearing_rad;
  }
}

// The target's bearing and the edge of view are both normally distributed. If the target is k σ
// inside the edge, with σ of their difference, it is in view with probability Φ(k). Φ(−3.09) =
// 10⁻³, Φ(4.753) = 1 − 10⁻⁶.
TEST(PosteriorMoments, ApplyLimitsForPartialViews) {
  constexpr double kNoise_rad = 1.0;
  const double sigma_rad = std::hypot(0.1 / 5.0, kSoftShare * kNoise_rad);
  const SensorModel open = open_sensor(SensorKind::kBearing);
  for (const auto& [inside_sigma, is_limited] :
       {std::pair(-3.12, false), std::pair(-3.06, true), std::pair(0.0, true),
        std::pair(4.71, true), std::pair(4.80, false)}) {
    for (const double side : {-1.0, 1.0}) {
      SensorModel limited = open;
      limited.fov_rad = 2.0 * (0.5 + inside_sigma * sigma_rad);
      const Eigen::VectorXd there_m = place_m(5.0, side * 0.5, 2);
      const PositionPrior prior{there_m, 100.0 * Eigen::MatrixXd::Identity(2, 2)};
      const models::Measurement z{Eigen::Matrix<double, 1, 1>(side * 0.5),
                                  Eigen::Matrix<double, 1, 1>(kNoise_rad * kNoise_rad)};
      const auto right = posterior_moments(prior, open, eye(), z);
      const auto found = posterior_moments(prior, limited, eye(), z);
      ASSERT_TRUE(right && found);
      EXPECT_EQ(found->mean_m == right->mean_m, !is_limited) << inside_sigma;
    }
  }
}

// A range sensor sees only its left half-plane, so the mean of a detected target is in that
// half-plane.
TEST(PosteriorMoments, RespectLimitsOfTheSensorKind) {
  models::SensorLaw law = SensorKind(SensorKind::kRange).law();
  law.can_measure = [](const SensorModel&, const models::Viewpoint&, const models::SightLine& to) {
    return to.offset_world_m.y() > 0.0;
  };
  const SensorModel sensor = open_sensor(SensorKind(law));
  const models::Viewpoint from;
  const Eigen::Matrix2d Omega = 16.0 * Eigen::Matrix2d::Identity();
  const models::Measurement z{Eigen::Matrix<double, 1, 1>(3.05), Eigen::Matrix<double, 1, 1>(0.04)};
  for (const double y_m : {-0.1, 0.05, 0.2}) {
    const Eigen::Vector2d mean_m(3.0, y_m);
    const auto found = posterior_moments({mean_m, Omega}, sensor, from, z);
    const auto oracle = test::dense_posterior(mean_m, Omega, sensor, from, z, true, 200);
    ASSERT_TRUE(found && oracle);
    const test::Difference d = test::difference(found->mean_m, found->covariance_m2, *oracle);
    EXPECT_LT(d.mean_sigma, 0.05) << y_m;
    EXPECT_LT(d.covariance_share, 0.08) << y_m;
  }
}

}  // namespace
}  // namespace vantage::estimator
