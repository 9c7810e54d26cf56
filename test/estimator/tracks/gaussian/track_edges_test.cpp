#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/filter/central_filter.hpp"
#include "estimator/posterior/missed_detection.hpp"
#include "estimator/tracks/gaussian/track.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

// Tests the limits at which a measurement update changes its method, and velocity priors.

namespace vantage::estimator {
namespace {

using models::Gaussian;
using models::TargetKind;
using test::at;
using test::far_sighted;
using test::instant;
using vantage::test::is_near;

Gaussian around(double x_m, double y_m, double sigma_m) {
  return {Eigen::Vector2d(x_m, y_m), sigma_m * sigma_m * Eigen::Matrix2d::Identity()};
}

/// True if the update equals that of an extended Kalman filter up to rounding.
bool is_linearised(const Gaussian& prior, const models::SensorModel& sensor,
                   const models::Viewpoint& from, const models::Measurement& z) {
  auto belief = models::to_information(prior).value();
  EXPECT_EQ(measure(belief, sensor, from, z, 0.0), Use::kUsed);
  const Gaussian made = models::to_gaussian(belief).value();
  const models::PositionVector mean_m = prior.mean.head<2>();
  const Gaussian right =
      models::update(prior, models::observation_jacobian(sensor, from, mean_m), z.V,
                     models::innovation(sensor, z.z, models::observe(sensor, from, mean_m)));
  return is_near(made.mean, right.mean, 1e-10) && is_near(made.covariance, right.covariance, 1e-10);
}

// A range is linearised if it deviates from its tangent by less than a fifth of its noise at the
// corners 1.5 σ from the mean.
TEST(Measure, LinearisesOnlyNearlyLinearRanges) {
  constexpr double kAway_m = 4.0;
  constexpr double kOut_m = 1.5 * 0.4;
  const double bend_m = std::hypot(kAway_m - kOut_m, kOut_m) - (kAway_m - kOut_m);  // m
  const models::SensorModel sensor = far_sighted(models::SensorKind::kRange);
  for (const double yaw_rad : {0.0, 0.5 * kPi, -0.5 * kPi, kPi}) {
    for (const auto& [share, is_linear] : {std::pair(0.199, true), std::pair(0.201, false)}) {
      const double sigma_m = bend_m / share;
      const models::Measurement z{Eigen::Matrix<double, 1, 1>(kAway_m + 0.1),
                                  Eigen::Matrix<double, 1, 1>(sigma_m * sigma_m)};
      const Eigen::Vector2d there_m =
          kAway_m * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
      EXPECT_EQ(is_linearised(around(1.0 + there_m.x(), there_m.y() - 2.0, 0.4), sensor,
                              at(1.0, -2.0, yaw_rad), z),
                is_linear)
          << yaw_rad << " " << share;
    }
  }
}

// Limits are ignored if the posterior is inside by at least the sum of 3σ of the belief and 3σ of
// the limit.
TEST(Measure, IgnoresLimitsBeyondThreeSigma) {
  constexpr double kAway_m = 5.0;
  constexpr double kNoise_m = 0.2;
  const double sigma_m = 0.2 / std::sqrt(2.0);  // m; σ of two equal beliefs after fusion
  const double clear_m = 3.0 * sigma_m + 3.0 * 0.1 * kNoise_m;
  for (const auto& [slack_m, is_clear] : {std::pair(0.002, true), std::pair(-0.002, false)}) {
    for (const double yaw_rad : {0.0, 1.0, -2.0}) {
      const Eigen::Vector2d towards(std::cos(yaw_rad), std::sin(yaw_rad));
      const models::Viewpoint from = at(0.5, 0.7, yaw_rad);
      const Eigen::Vector2d there_m = from.world_from_body.position_m() + kAway_m * towards;
      models::SensorModel far = far_sighted(models::SensorKind::kPosition);
      models::SensorModel near = far;
      models::SensorModel wide = far;
      far.range_max_m = kAway_m + clear_m + slack_m;
      near.range_min_m = kAway_m - clear_m - slack_m;
      const models::Measurement z{
          models::observe(far, from, models::PositionVector(there_m)),
          models::MeasurementMatrix(kNoise_m * kNoise_m * Eigen::Matrix2d::Identity())};
      const Gaussian prior = around(there_m.x(), there_m.y(), 0.2);
      EXPECT_EQ(is_linearised(prior, far, from, z), is_clear) << yaw_rad;
      EXPECT_EQ(is_linearised(prior, near, from, z), is_clear) << yaw_rad;
      EXPECT_TRUE(is_linearised(prior, wide, from, z));
    }
  }
}

// The gate distance is in σ of the predicted measurement, for linear and for integrated updates.
TEST(Measure, GatesAtTheStatedDistance) {
  const models::SensorModel sensor = far_sighted(models::SensorKind::kPosition);
  const double sigma_m = std::hypot(0.3, 0.4);
  for (const double side : {-1.0, 1.0}) {
    const models::Measurement z{Eigen::Vector2d(5.0, 2.0 + side * 3.0 * sigma_m),
                                models::MeasurementMatrix(0.16 * Eigen::Matrix2d::Identity())};
    for (const auto& [gate_sigma, is_used] : {std::pair(3.001, true), std::pair(2.999, false)}) {
      const auto before = models::to_information(around(5.0, 2.0, 0.3)).value();
      auto belief = before;
      EXPECT_EQ(measure(belief, sensor, at(0, 0), z, gate_sigma),
                is_used ? Use::kUsed : Use::kGated);
      EXPECT_EQ(belief.matrix == before.matrix, !is_used);
    }
  }
  // Directly above the robot a range is nonlinear: the gate uses the minimum over all positions.
  const models::SensorModel ranger = far_sighted(models::SensorKind::kRange);
  const models::Measurement z{Eigen::Matrix<double, 1, 1>(5.0), Eigen::Matrix<double, 1, 1>(0.25)};
  for (const auto& [gate_sigma, is_used] : {std::pair(4.6, true), std::pair(4.3, false)}) {
    // The residual is 5 m in any direction, with σ of 1 m and 0.5 m: 5/√1.25 = 4.47 σ.
    auto belief = models::to_information(around(0.0, 0.0, 1.0)).value();
    EXPECT_EQ(measure(belief, ranger, at(0, 0), z, gate_sigma), is_used ? Use::kUsed : Use::kGated);
  }
}

TEST(Propagate, IsExactlyTheIdentityWithoutMotionAndNoise) {
  models::Information belief{Eigen::Vector2d(1.0 / 3.0, -0.7), Eigen::Matrix2d::Identity()};
  belief.matrix(0, 1) = belief.matrix(1, 0) = 0.1;
  const models::TargetModel walk{TargetKind::kRandomWalk, 2, 0.3};
  const models::TargetModel still{TargetKind::kStatic, 2, 0.3};
  const auto at_once = propagate(walk, 0.5, belief, instant(0), instant(1), instant(1));
  const auto stood = propagate(still, 0.5, belief, instant(0), instant(1), instant(5));
  for (const auto& same : {at_once, stood}) {
    ASSERT_TRUE(same);
    EXPECT_EQ(same->matrix, belief.matrix);
    EXPECT_EQ(same->vector, belief.vector);
  }
}

// An oscillator's velocity prior is its stationary distribution; other models use the stated prior.
TEST(Discover, UsesTheConfiguredVelocityPrior) {
  scenario::EstimatorSpec spec;
  spec.prior_velocity_sigma_mps = 0.7;
  const models::SensorModel sensor = far_sighted(models::SensorKind::kRangeBearing);
  const models::Measurement z{Eigen::Vector2d(5.0, 0.3),
                              models::MeasurementMatrix(0.01 * Eigen::Matrix2d::Identity())};
  spec.target_model = {TargetKind::kDoubleIntegrator, 2, 0.1};
  const Gaussian drifting =
      models::to_gaussian(discover(spec, sensor, at(1, 2), z).value()).value();
  spec.target_model = {
      TargetKind::kDampedOscillator, 2, 0.0, {{0.5, -0.5}, {1.75, 0.83}, {0.4, 0.25}, {0.3, 0.5}}};
  const Gaussian bound = models::to_gaussian(discover(spec, sensor, at(1, 2), z).value()).value();
  spec.target_model = {TargetKind::kRandomWalk, 2, 0.1};
  const Gaussian walking = models::to_gaussian(discover(spec, sensor, at(1, 2), z).value()).value();
  EXPECT_TRUE(is_near(drifting.covariance.bottomRightCorner(2, 2),
                      0.49 * Eigen::Matrix2d::Identity(), 1e-9));
  EXPECT_NEAR(bound.covariance(2, 2), 0.16, 1e-9);
  EXPECT_NEAR(bound.covariance(3, 3), 0.0625, 1e-9);
  for (const Gaussian& found : {drifting, bound}) {
    EXPECT_TRUE(is_near(found.mean.tail(2), Eigen::Vector2d::Zero(), 1e-12));
    EXPECT_TRUE(is_near(found.mean.head(2), walking.mean, 1e-9));
    EXPECT_TRUE(is_near(found.covariance.topLeftCorner(2, 2), walking.covariance, 1e-9));
    EXPECT_TRUE(is_near(found.covariance.topRightCorner(2, 2), Eigen::Matrix2d::Zero(), 1e-12));
  }
}

TEST(Doubt, RequiresAPositionMeasurement) {
  scenario::EstimatorSpec spec;
  spec.target_model = {TargetKind::kRandomWalk, 2, 0.1};
  const models::Measurement range{Eigen::Matrix<double, 1, 1>(4.0),
                                  Eigen::Matrix<double, 1, 1>(0.01)};
  const models::Measurement place{Eigen::Vector2d(4.0, 0.1),
                                  models::MeasurementMatrix(0.01 * Eigen::Matrix2d::Identity())};
  Track track{true, models::to_information(around(1.0, 1.0, 0.2)).value(), instant(1), {}};
  const Track before = track;
  EXPECT_FALSE(
      doubt(track, spec, far_sighted(models::SensorKind::kRange), at(0, 0), range, instant(2)));
  EXPECT_EQ(track.doubted, Time{});
  EXPECT_EQ(track.information.matrix, before.information.matrix);
  EXPECT_TRUE(doubt(track, spec, far_sighted(models::SensorKind::kRangeBearing), at(0, 0), place,
                    instant(2)));
  EXPECT_EQ(track.doubted, instant(2));
  EXPECT_EQ(track.last_seen, instant(1));
  Track nothing{true, {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero()}, instant(1), {}};
  EXPECT_FALSE(doubt(nothing, spec, far_sighted(models::SensorKind::kRangeBearing), at(0, 0), place,
                     instant(2)));
}

// For each target, scans without a detection are applied before those with one, in any order of
// arrival.
TEST(CentralFilter, AppliesMissesBeforeDetections) {
  models::World world;
  world.bounds = {{-20.0, -20.0}, {20.0, 20.0}};
  models::SensorModel sensor = far_sighted(models::SensorKind::kRangeBearing);
  sensor.range_max_m = 6.0;
  const models::TargetModel model{TargetKind::kRandomWalk, 2, 0.1};
  const std::vector<Gaussian> priors = {around(5.0, 0.5, 0.6), around(-3.0, 1.0, 0.6)};
  std::mt19937_64 rng(4);
  std::vector<models::RobotMeasurement> looks(3);
  looks[0].viewpoint = at(1.0, 0.0);
  looks[0].detections = {
      {0, models::sample(sensor, looks[0].viewpoint, Eigen::Vector2d(5.2, 0.4), rng)}};
  looks[1].viewpoint = at(4.0, -5.5, 1.0);
  looks[1].detections = {
      {1, models::sample(sensor, looks[1].viewpoint, Eigen::Vector2d(-1.0, -3.0), rng)}};
  looks[2].viewpoint = at(10.5, 1.0, 2.0);
  for (const double probability : {0.0, 0.6}) {
    CentralFilter filter({model, 0.5, probability, true}, world, priors);
    filter.update(sensor, looks);
    for (std::size_t m = 0; m < 2; ++m) {
      Gaussian expected = priors[m];
      for (std::size_t i = 0; i < 3; ++i) {
        if (i != m && probability > 0.0) {
          expected = missed_detection(expected, sensor, looks[i].viewpoint, world, probability);
        }
      }
      auto information = models::to_information(expected).value();
      ASSERT_EQ(
          measure(information, sensor, looks[m].viewpoint, looks[m].detections[0].measurement, 0.0),
          Use::kUsed);
      expected = models::to_gaussian(information).value();
      EXPECT_TRUE(is_near(filter.beliefs()[m].mean, expected.mean, 1e-9));
      EXPECT_TRUE(is_near(filter.beliefs()[m].covariance, expected.covariance, 1e-9));
      EXPECT_EQ(filter.is_seen()[m], 1);
    }
    filter.update(sensor, {looks.data() + 1, 2});
    EXPECT_EQ(filter.is_seen()[0], 0) << "not seen in the last scans";
    EXPECT_EQ(filter.is_seen()[1], 1);
  }
}

}  // namespace
}  // namespace vantage::estimator
