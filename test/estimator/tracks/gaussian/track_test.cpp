#include "estimator/tracks/gaussian/track.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/posterior/posterior_moments.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/posterior/dense_posterior.hpp"
#include "test/support/near.hpp"
#include "test/support/own_sensor.hpp"
#include "test/support/own_target.hpp"

namespace vantage::estimator {
namespace {

using models::Gaussian;
using models::TargetKind;
using test::at;
using test::instant;
using vantage::test::is_near;

const models::DampedOscillator kLabOscillator{{0.5, -0.5}, {1.75, 0.83}, {0.4, 0.25}, {0.3, 0.5}};

TEST(Propagate, TwoIntervalsEqualOneLongInterval) {
  const auto all = models::all_target_kinds();
  std::vector<TargetKind> kinds(all.begin(), all.end());
  kinds.push_back(vantage::test::drag());
  for (const TargetKind kind : kinds) {
    const models::TargetModel model{kind, 2, 0.3, kLabOscillator};
    const Eigen::Index n = model.dim();
    const auto belief = models::to_information({models::StateVector::LinSpaced(n, -1.0, 2.0),
                                                models::StateMatrix::Identity(n, n)})
                            .value();
    const Time seen = instant(0) - from_seconds(1.0);
    const Time between = instant(0) + from_seconds(0.7);
    const auto once = propagate(model, 0.5, belief, seen, instant(0), instant(3)).value();
    const auto half = propagate(model, 0.5, belief, seen, instant(0), between).value();
    const auto twice = propagate(model, 0.5, half, seen, between, instant(3)).value();
    EXPECT_TRUE(is_near(twice.matrix, once.matrix, 1e-12));
    EXPECT_TRUE(is_near(twice.vector, once.vector, 1e-12));
  }
}

// The belief is propagated step by step, as in the filter.
TEST(Propagate, TendsToTheStationaryDistributionForADampedOscillator) {
  const models::TargetModel model{TargetKind::kDampedOscillator, 2, 0.0, kLabOscillator};
  const models::StateMatrix sharp = 1e-4 * models::StateMatrix::Identity(4, 4);
  models::Information belief =
      models::to_information({Eigen::Vector4d(4.0, 2.0, -0.3, 0.2), sharp}).value();
  double entropy_nats = -1e9;
  for (int k = 0; k < 400; ++k) {
    belief = propagate(model, 0.5, belief, instant(0), instant(k), instant(k + 1)).value();
    const models::Gaussian now = models::to_gaussian(belief).value();
    EXPECT_LE(now.covariance(0, 0), 1.75 * 1.75 + 1e-9);
    EXPECT_LE(now.covariance(1, 1), 0.83 * 0.83 + 1e-9);
    EXPECT_GE(models::entropy_nats(now), entropy_nats - 1e-9);
    entropy_nats = models::entropy_nats(now);
  }
  const models::Gaussian last = models::to_gaussian(belief).value();
  EXPECT_TRUE(is_near(last.mean, Eigen::Vector4d(0.5, -0.5, 0.0, 0.0), 1e-6));
  EXPECT_TRUE(is_near(last.covariance.diagonal(),
                      Eigen::Vector4d(1.75 * 1.75, 0.83 * 0.83, 0.4 * 0.4, 0.25 * 0.25), 1e-6));
}

TEST(Propagate, AddsNoiseByNumberOfUnseenSteps) {
  const models::TargetModel model{TargetKind::kGrowingUncertainty, 3, 0.01};
  const auto belief =
      models::to_information({models::StateVector::Zero(3), models::StateMatrix::Identity(3, 3)})
          .value();
  // The target was observed two steps earlier and is not observed for three more: k = 2, 3, 4.
  const auto later = propagate(model, 0.5, belief, instant(0), instant(2), instant(5)).value();
  double variance = 1.0;
  for (int k = 2; k <= 4; ++k) {
    variance += model.process_noise(0.5, k)(0, 0);
  }
  EXPECT_TRUE(is_near(models::to_gaussian(later)->covariance,
                      variance * models::StateMatrix::Identity(3, 3), 1e-12));
}

TEST(Propagate, RefusesASingularBelief) {
  const models::Information nothing{models::StateVector::Zero(2), models::StateMatrix::Zero(2, 2)};
  EXPECT_FALSE(propagate({TargetKind::kRandomWalk, 2, 0.1}, 0.5, nothing, instant(0), instant(0),
                         instant(1)));
}

/// An observation of a target in view, and the prior. The cases include near and far targets,
/// targets under the robot, and the limits of range and view.
struct LookCase {
  models::SensorModel sensor;
  models::Viewpoint from;
  Gaussian belief;
  models::Measurement z;
};

LookCase draw_case(models::SensorKind kind, double range_max_m, double fov_deg, double sigma_share,
                   std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit;
  LookCase out;
  out.sensor.kind = kind;
  out.sensor.range_max_m = range_max_m;
  out.sensor.range_min_m = 0.1;
  out.sensor.fov_rad = radians(fov_deg);
  out.sensor.range_sigma_m = 0.03 * range_max_m;
  out.sensor.position_sigma_m = 0.03 * range_max_m;
  out.sensor.pixel_sigma = 20.0;
  out.sensor.camera_tilt_rad = radians(70.0);
  // In statements, because compilers evaluate the arguments of a call in different orders.
  const double yaw_rad = 6.0 * unit(rng);
  const double y_m = -2.0 * unit(rng);
  const double x_m = 3.0 * unit(rng);
  out.from = at(x_m, y_m, yaw_rad);
  out.from.height_m = 1.5;
  Eigen::Vector2d truth_m;
  do {
    const double angle_rad = 2.0 * kPi * unit(rng);
    const double r_m = range_max_m * unit(rng);
    truth_m = out.from.world_from_body.position_m() +
              r_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  } while (!models::in_view(out.sensor, out.from, truth_m));
  // The prior is an ellipse at any angle, up to six times longer than wide.
  const double sigma_m = sigma_share * range_max_m;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(kPi * unit(rng)).toRotationMatrix();
  const Eigen::Matrix2d root =
      turn * Eigen::Vector2d(sigma_m, sigma_m / (1.0 + 5.0 * unit(rng))).asDiagonal();
  out.belief = {truth_m + root * test::normal_vector(2, rng), root * root.transpose()};
  out.z = models::sample(out.sensor, out.from, truth_m, rng);
  return out;
}

const auto kEverySensor = models::all_sensor_kinds();

TEST(Measure, EqualsTheCovarianceFormForLinearSensors) {
  std::mt19937_64 rng(17);
  for (const auto kind : kEverySensor) {
    int alike = 0;
    for (int trial = 0; trial < 50; ++trial) {
      const LookCase c = draw_case(kind, 10.0, 360.0, 0.003, rng);
      Gaussian belief{models::StateVector::Zero(4), 0.3 * models::StateMatrix::Identity(4, 4)};
      belief.mean.head(2) = c.belief.mean;
      belief.covariance.topLeftCorner(2, 2) = c.belief.covariance;
      belief.covariance(0, 2) = belief.covariance(2, 0) = 0.1 * c.belief.covariance(0, 0);
      auto information = models::to_information(belief).value();
      ASSERT_EQ(measure(information, c.sensor, c.from, c.z, 0.0), Use::kUsed);
      const Gaussian expected =
          models::update(belief, models::state_jacobian(c.sensor, c.from, belief.mean), c.z.V,
                         models::innovation(c.sensor, c.z.z,
                                            models::observe_state(c.sensor, c.from, belief.mean)));
      const Gaussian actual = models::to_gaussian(information).value();
      alike += is_near(actual.mean, expected.mean, 1e-8) &&
                       is_near(actual.covariance, expected.covariance, 1e-8)
                   ? 1
                   : 0;
    }
    EXPECT_GT(alike, 25) << kind.name();
  }
}

/// Returns the posterior after the observation; fails if the observation is not used.
Gaussian after_its_look(const LookCase& c) {
  auto information = models::to_information(c.belief).value();
  EXPECT_EQ(measure(information, c.sensor, c.from, c.z, 0.0), Use::kUsed);
  return models::to_gaussian(information).value();
}

TEST(Measure, UsesACustomSensor) {
  std::mt19937_64 rng(5);
  for (int trial = 0; trial < 20; ++trial) {
    const LookCase c =
        draw_case(vantage::test::signal_strength(), 10.0, trial % 2 == 0 ? 360.0 : 94.0, 0.02, rng);
    const Gaussian actual = after_its_look(c);
    const Eigen::MatrixXd Omega = Eigen::MatrixXd(c.belief.covariance).inverse();
    const auto oracle =
        test::dense_posterior(c.belief.mean, Omega, c.sensor, c.from, c.z, true, 160);
    ASSERT_TRUE(oracle);
    const test::Difference d = test::difference(actual.mean, actual.covariance, *oracle);
    EXPECT_LT(d.mean_sigma, 0.15) << trial;
    EXPECT_LT(d.covariance_share, 0.25) << trial;
  }
}

TEST(Measure, LinearisesACustomSensorInSpace) {
  models::SensorModel sensor;
  sensor.kind = vantage::test::signal_strength();
  models::Viewpoint from = at(0.0, 0.0);
  from.height_m = 1.0;
  const Gaussian prior{Eigen::Vector3d(2.0, 1.0, 0.5), 0.01 * Eigen::Matrix3d::Identity()};
  auto belief = models::to_information(prior).value();
  const models::PositionVector there_m = Eigen::Vector3d(2.1, 1.0, 0.5);
  const models::Measurement z{models::observe(sensor, from, there_m),
                              models::noise_covariance(sensor, from, there_m)};
  ASSERT_FALSE(can_integrate(sensor, 3));
  ASSERT_EQ(measure(belief, sensor, from, z, 0.0), Use::kUsed);
  EXPECT_GT(models::to_gaussian(belief)->mean(0), 2.0);
  EXPECT_LT(models::to_gaussian(belief)->covariance(0, 0), 0.01);
}

/// Compares updates with brute force. The prior σ is 2 % or 20 % of the range; the field of view is
/// a full circle or 94°.
class MeasureAgainstBruteForce : public ::testing::TestWithParam<models::SensorKind> {};

TEST_P(MeasureAgainstBruteForce, HasThePosteriorsMoments) {
  std::mt19937_64 rng(2026);
  double worst_mean = 0.0;
  double worst_covariance = 0.0;
  int at_limits = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const LookCase c = draw_case(GetParam(), trial % 2 == 0 ? 1.0 : 10.0,
                                 trial % 4 < 2 ? 360.0 : 94.0, trial % 8 < 4 ? 0.02 : 0.2, rng);
    const Gaussian actual = after_its_look(c);
    const Eigen::MatrixXd Omega = Eigen::MatrixXd(c.belief.covariance).inverse();
    const auto open =
        test::dense_posterior(c.belief.mean, Omega, c.sensor, c.from, c.z, false, 160);
    ASSERT_TRUE(open);
    at_limits += open->share_in_view < 0.99 ? 1 : 0;
    const auto oracle =
        open->share_in_view < 1e-3
            ? open
            : test::dense_posterior(c.belief.mean, Omega, c.sensor, c.from, c.z, true, 160);
    ASSERT_TRUE(oracle);
    const test::Difference d = test::difference(actual.mean, actual.covariance, *oracle);
    worst_mean = std::max(worst_mean, d.mean_sigma);
    worst_covariance = std::max(worst_covariance, d.covariance_share);
  }
  RecordProperty("worst_mean_sigma", std::to_string(worst_mean));
  RecordProperty("worst_covariance_share", std::to_string(worst_covariance));
  EXPECT_GE(at_limits, 3);
  EXPECT_LT(worst_mean, 0.15);  // in σ of the posterior
  EXPECT_LT(worst_covariance, 0.25);
}

INSTANTIATE_TEST_SUITE_P(EverySensor, MeasureAgainstBruteForce, ::testing::ValuesIn(kEverySensor));

TEST(Measure, IsCorrectForATargetUnderTheRobot) {
  // The lab's sensor is above a lost target, so the range z_r is only noise. A linearised posterior
  // would be 0.4 mm wide and 0.5 m off.
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 1.0;
  sensor.range_sigma_m = 0.3;
  for (const double z_m : {-0.2, 0.0, 0.05, 0.3}) {
    models::Measurement z;
    z.z = Eigen::Vector2d(z_m, 0.7);
    z.V = Eigen::Vector2d(0.09, radians(5.0) * radians(5.0)).asDiagonal();
    const Gaussian prior{Eigen::Vector2d(0.1, 0.2), 0.5 * Eigen::Matrix2d::Identity()};
    auto belief = models::to_information(prior).value();
    ASSERT_EQ(measure(belief, sensor, at(0, 0), z, 0.0), Use::kUsed);
    const auto oracle = test::dense_posterior(prior.mean, 2.0 * Eigen::Matrix2d::Identity(), sensor,
                                              at(0, 0), z, true, 400);
    const Gaussian g = models::to_gaussian(belief).value();
    const test::Difference d = test::difference(g.mean, g.covariance, *oracle);
    EXPECT_LT(d.mean_sigma, 0.02) << z_m;
    EXPECT_LT(d.covariance_share, 0.03) << z_m;
    EXPECT_GT(g.mean.head(2).norm(), sensor.range_min_m);
  }
}

TEST(Measure, IsConsistentNearTheRobot) {
  // Truth is drawn from the prior and observed if it is in view. If the moments are those of the
  // posterior, the mean of e = ε' Σ⁻¹ ε is 2, for any shape of the posterior.
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 1.0;
  sensor.range_sigma_m = 0.3;
  std::mt19937_64 rng(9);
  constexpr int kCases = 3000;
  test::MeanNees nees;
  while (nees.cases() < kCases) {
    const Eigen::Vector2d mean_m = 0.4 * test::normal_vector(2, rng);
    const Eigen::Vector2d truth_m = mean_m + 0.5 * test::normal_vector(2, rng);
    if (!models::in_view(sensor, at(0, 0), truth_m)) {
      continue;
    }
    auto belief = models::to_information({mean_m, 0.25 * Eigen::Matrix2d::Identity()}).value();
    const auto z = models::sample(sensor, at(0, 0), truth_m, rng);
    ASSERT_EQ(measure(belief, sensor, at(0, 0), z, 0.0), Use::kUsed);
    nees.add(models::to_gaussian(belief).value(), truth_m);
  }
  EXPECT_NEAR(nees.mean(), 2.0, std::max(1.96 * nees.sigma(), 0.1));
}

TEST(Measure, IsInvariantToRotationAndReflection) {
  std::mt19937_64 rng(31);
  for (const auto kind : kEverySensor) {
    for (int trial = 0; trial < 10; ++trial) {
      const LookCase c = draw_case(kind, 1.0, 94.0, 0.2, rng);
      const auto posterior = [&](const models::Viewpoint& from, const Gaussian& prior,
                                 const models::Measurement& z) {
        auto information = models::to_information(prior).value();
        EXPECT_EQ(measure(information, c.sensor, from, z, 0.0), Use::kUsed);
        return models::to_gaussian(information).value();
      };
      const Gaussian plain = posterior(c.from, c.belief, c.z);
      const double sigma_m = std::sqrt(plain.covariance.trace());
      // The scene is rotated by 2 rad about the origin.
      const Eigen::Matrix2d R = Eigen::Rotation2Dd(2.0).toRotationMatrix();
      models::Viewpoint turned = c.from;
      const Eigen::Vector2d eye_m = R * c.from.world_from_body.position_m();
      turned.world_from_body = {eye_m.x(), eye_m.y(), c.from.world_from_body.yaw_rad + 2.0};
      const Gaussian of_turned =
          posterior(turned, {R * c.belief.mean, R * c.belief.covariance * R.transpose()}, c.z);
      EXPECT_LT((of_turned.mean - R * plain.mean).norm(), 1e-6 * sigma_m);
      // Mirrors left and right.
      const Eigen::Matrix2d F = Eigen::Vector2d(1.0, -1.0).asDiagonal();
      models::Viewpoint mirrored = c.from;
      mirrored.world_from_body = {c.from.world_from_body.x_m, -c.from.world_from_body.y_m,
                                  -c.from.world_from_body.yaw_rad};
      models::Measurement z = c.z;
      if (kind == models::SensorKind::kCamera) {
        z.z(0) = -z.z(0);
      } else if (kind != models::SensorKind::kRange) {
        z.z(z.z.rows() - 1) = -z.z(z.z.rows() - 1);
      }
      const Gaussian of_mirrored =
          posterior(mirrored, {F * c.belief.mean, F * c.belief.covariance * F}, z);
      EXPECT_LT((of_mirrored.mean - F * plain.mean).norm(), 1e-6 * sigma_m);
    }
  }
}

TEST(Measure, IgnoresLimitsThatTheSensorViolates) {
  // The prior is precise at 1.3 m. A sensor with a stated range of 1 m detects the target there.
  models::SensorModel sensor;
  sensor.range_max_m = 1.0;
  sensor.range_sigma_m = 0.1;
  const Gaussian prior{Eigen::Vector2d(1.3, 0.0), 4e-4 * Eigen::Matrix2d::Identity()};
  auto belief = models::to_information(prior).value();
  const models::Measurement z{Eigen::Vector2d(1.31, 0.0), 0.01 * Eigen::Matrix2d::Identity()};
  ASSERT_EQ(measure(belief, sensor, at(0, 0), z, 0.0), Use::kUsed);
  EXPECT_NEAR(models::to_gaussian(belief)->mean(0), 1.3, 0.01);
}

TEST(PosteriorMoments, EqualBruteForceForSpatialTargets) {
  std::mt19937_64 rng(8);
  for (const auto kind : kEverySensor) {
    models::SensorModel sensor;
    sensor.kind = kind;
    sensor.range_max_m = 4.0;
    sensor.range_sigma_m = 0.2;
    sensor.bearing_sigma_rad = 0.2;
    sensor.pixel_sigma = 40.0;
    models::Viewpoint from = at(0.2, 0.1, 0.5);
    from.height_m = 2.0;
    for (int trial = 0; trial < 3; ++trial) {
      const models::PositionVector truth_m = Eigen::Vector3d(0.9, 0.5 * trial, 0.4);
      const Eigen::Vector3d mean_m = truth_m + 0.3 * test::normal_vector(3, rng);
      const Eigen::Matrix3d Omega = Eigen::Vector3d(9.0, 12.0, 20.0).asDiagonal();
      const auto z = models::sample(sensor, from, truth_m, rng);
      const auto found = posterior_moments({mean_m, Omega}, sensor, from, z);
      const auto oracle = test::dense_posterior(mean_m, Omega, sensor, from, z, true, 60);
      ASSERT_TRUE(found && oracle);
      const test::Difference d = test::difference(found->mean_m, found->covariance_m2, *oracle);
      EXPECT_LT(d.mean_sigma, 0.05) << kind.name();
      EXPECT_LT(d.covariance_share, 0.08) << kind.name();
    }
  }
}

TEST(Measure, WrapsTheBearingBehindTheRobot) {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kBearing;
  auto belief =
      models::to_information({Eigen::Vector2d(-5.0, -0.1), Eigen::Matrix2d::Identity()}).value();
  models::Measurement z;
  z.z = Eigen::Matrix<double, 1, 1>(kPi - 0.02);  // rad; the prediction is just above −π
  z.V = Eigen::Matrix<double, 1, 1>(0.01);
  ASSERT_EQ(measure(belief, sensor, at(0, 0), z, 0.0), Use::kUsed);
  EXPECT_NEAR(models::to_gaussian(belief)->mean(1), 0.07, 0.05);
}

TEST(Measure, KeepsABeliefBeyondTheGate) {
  const models::SensorModel sensor;
  const auto start =
      models::to_information({Eigen::Vector2d(5.0, 0.0), 0.01 * Eigen::Matrix2d::Identity()})
          .value();
  models::Measurement z{Eigen::Vector2d(6.0, 0.0), Eigen::Matrix2d::Identity() * 0.01};
  auto belief = start;
  EXPECT_EQ(measure(belief, sensor, at(0, 0), z, 5.0), Use::kGated);  // 1 m at σ = √0.02 m is 7.1 σ
  EXPECT_EQ(belief.matrix, start.matrix);
  EXPECT_EQ(measure(belief, sensor, at(0, 0), z, 8.0), Use::kUsed);
  models::SensorModel ranger;
  ranger.kind = models::SensorKind::kRange;
  models::Measurement range{Eigen::Matrix<double, 1, 1>(1.0), Eigen::Matrix<double, 1, 1>(0.01)};
  auto here = start;
  EXPECT_EQ(measure(here, ranger, at(5.0, 0.0), range, 0.0), Use::kUsed);
  EXPECT_NEAR(models::to_gaussian(here)->mean(0), 5.0, 1e-3);  // symmetric around the robot
  EXPECT_GT(models::to_gaussian(here)->covariance(0, 0), 0.02);
  z.V.setZero();
  EXPECT_EQ(measure(here, sensor, at(0, 0), z, 0.0), Use::kSingular);
}

TEST(Discover, RefusesAMeasurementWithoutNoise) {
  scenario::EstimatorSpec spec;
  spec.target_model = {TargetKind::kRandomWalk, 2, 0.1};
  const models::SensorModel sensor;
  models::Measurement z{Eigen::Vector2d(3.0, 0.2), 0.01 * Eigen::Matrix2d::Identity()};
  EXPECT_TRUE(discover(spec, sensor, at(0.0, 0.0), z));
  z.V.setZero();
  EXPECT_FALSE(discover(spec, sensor, at(0.0, 0.0), z));
}

TEST(Discover, UsesThePriorInUnobservedDirections) {
  scenario::EstimatorSpec spec;
  spec.target_model = {TargetKind::kRandomWalk, 3, 0.1};
  spec.prior_position_sigma_m = 2.0;
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kCamera;
  models::Viewpoint from = at(0.0, 0.0);
  from.height_m = 4.0;
  const models::Measurement z{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()};
  const auto found = discover(spec, sensor, from, z);
  ASSERT_TRUE(found);
  const Gaussian g = models::to_gaussian(*found).value();
  // The camera faces straight down, so a pixel at depth d has a width of d/500 m. Depths of 4 ± 2 m
  // are weighted by the ray's area, d², and limited by the minimum depth and the range.
  double mass = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  double across = 0.0;
  for (double d = 0.0501; d < 10.0; d += 1e-4) {
    const double p = d * d * std::exp(-0.5 * (d - 4.0) * (d - 4.0) / 4.0);
    mass += p;
    sum += p * d;
    squares += p * d * d;
    across += p * d * d / (500.0 * 500.0);
  }
  EXPECT_NEAR(g.mean(2), 4.0 - sum / mass, 1e-2);
  EXPECT_NEAR(g.covariance(2, 2), squares / mass - sum * sum / (mass * mass), 2e-2);
  EXPECT_NEAR(g.covariance(0, 0), across / mass, 0.02 * across / mass);
}

TEST(Discover, HasTheMomentsOfThePosteriorAfterOneMeasurement) {
  scenario::EstimatorSpec spec;
  spec.target_model = {TargetKind::kRandomWalk, 2, 0.1};
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 1.0;
  sensor.range_sigma_m = 0.3;
  for (const double z_m : {-0.1, 0.05, 0.5, 1.2}) {
    const models::Measurement z{
        Eigen::Vector2d(z_m, -2.0),
        Eigen::Matrix2d(Eigen::Vector2d(0.09, radians(5.0) * radians(5.0)).asDiagonal())};
    const auto found = discover(spec, sensor, at(1.0, 0.5, 0.3), z);
    ASSERT_TRUE(found) << z_m;
    const auto oracle = test::dense_posterior(Eigen::Vector2d(1.0, 0.5), Eigen::Matrix2d::Zero(),
                                              sensor, at(1.0, 0.5, 0.3), z, true, 400);
    const Gaussian g = models::to_gaussian(*found).value();
    const test::Difference d = test::difference(g.mean, g.covariance, *oracle);
    EXPECT_LT(d.mean_sigma, 0.04) << z_m;  // coarse quadrature at the soft limit
    EXPECT_LT(d.covariance_share, 0.03) << z_m;
  }
}

}  // namespace
}  // namespace vantage::estimator
