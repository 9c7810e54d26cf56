#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/posterior/unscented.hpp"
#include "estimator/tracks/gaussian/track.hpp"
#include "models/belief/gaussian.hpp"
#include "models/sensor/law.hpp"
#include "test/support/near.hpp"

// Tests of measure() with a sensor that measures the velocity of its targets.

namespace vantage::estimator {
namespace {

using models::Gaussian;
using models::SensorKind;
using models::SensorModel;
using models::StateMatrix;
using models::StateVector;
using models::Viewpoint;
using test::is_near;

SensorModel range_rate() {
  SensorModel sensor;
  sensor.kind = SensorKind::kRangeRate;
  sensor.range_min_m = 0.1;
  return sensor;
}

Gaussian belief_at(double x_m, double y_m, double position_sigma_m, double velocity_sigma_mps) {
  Gaussian belief{StateVector::Zero(4), StateMatrix::Zero(4, 4)};
  belief.mean << x_m, y_m, 0.3, -0.4;
  belief.covariance.diagonal() << std::pow(position_sigma_m, 2), std::pow(position_sigma_m, 2),
      std::pow(velocity_sigma_mps, 2), std::pow(velocity_sigma_mps, 2);
  belief.covariance(0, 2) = belief.covariance(2, 0) = 0.3 * position_sigma_m * velocity_sigma_mps;
  return belief;
}

/// Returns a draw of the belief.
StateVector draw(const Gaussian& belief, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  StateVector u(4);
  for (Eigen::Index i = 0; i < 4; ++i) {
    u(i) = normal(rng);
  }
  return belief.mean + belief.covariance.llt().matrixL() * u;
}

models::Measurement measured(const SensorModel& sensor, const Viewpoint& from,
                             const StateVector& truth, std::mt19937_64& rng) {
  return models::sample(sensor, from, models::PositionVector(truth.head<2>()), rng,
                        models::velocity_of(truth));
}

TEST(MeasureVelocity, EqualsTheCovarianceFormForANarrowBelief) {
  std::mt19937_64 rng(1);
  const SensorModel sensor = range_rate();
  for (int trial = 0; trial < 50; ++trial) {
    const Viewpoint from{{0.1 * trial - 2.0, 0.5, 0.2 * trial}, 1.0};
    const Gaussian prior = belief_at(3.0, 2.0, 0.02, 0.05);
    const models::Measurement z = measured(sensor, from, draw(prior, rng), rng);
    auto information = models::to_information(prior).value();
    ASSERT_EQ(measure(information, sensor, from, z, 0.0), Use::kUsed);
    const Gaussian actual = models::to_gaussian(information).value();
    const Gaussian expected = models::update(
        prior, models::state_jacobian(sensor, from, prior.mean), z.V,
        models::innovation(sensor, z.z, models::observe_state(sensor, from, prior.mean)));
    EXPECT_TRUE(is_near(actual.mean, expected.mean, 1e-9));
    EXPECT_TRUE(is_near(actual.covariance, expected.covariance, 1e-9));
  }
}

// The reference is the posterior of weighted samples of the prior.
TEST(MeasureVelocity, IsNearThePosteriorOfSamplesForAWideBelief) {
  constexpr int kSamples = 100'000;
  std::mt19937_64 rng(2);
  const SensorModel sensor = range_rate();
  const Viewpoint from{{0.0, 0.0, 0.0}, 1.0};
  double worst_mean_sigma = 0.0;
  for (int trial = 0; trial < 10; ++trial) {
    const Gaussian prior = belief_at(4.0, 1.0, 0.4, 0.5);
    const models::Measurement z = measured(sensor, from, draw(prior, rng), rng);
    auto information = models::to_information(prior).value();
    ASSERT_EQ(measure(information, sensor, from, z, 0.0), Use::kUsed);
    const Gaussian actual = models::to_gaussian(information).value();
    double sum = 0.0;
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();
    Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
    for (int i = 0; i < kSamples; ++i) {
      const StateVector y = draw(prior, rng);
      const Eigen::VectorXd nu =
          models::innovation(sensor, z.z, models::observe_state(sensor, from, y));
      const double weight = std::exp(-0.5 * nu.dot(z.V.llt().solve(nu)));
      sum += weight;
      mean += weight * y;
      squares += weight * y * y.transpose();
    }
    mean /= sum;
    const Eigen::Matrix4d covariance = squares / sum - mean * mean.transpose();
    const Eigen::Vector4d off = Eigen::Vector4d(actual.mean) - mean;
    worst_mean_sigma =
        std::max(worst_mean_sigma, std::sqrt(off.dot(covariance.llt().solve(off)) / 4.0));
    for (Eigen::Index i = 0; i < 4; ++i) {
      EXPECT_NEAR(actual.covariance(i, i) / covariance(i, i), 1.0, 0.35) << trial << ' ' << i;
    }
  }
  EXPECT_LT(worst_mean_sigma, 0.4);
}

TEST(MeasureVelocity, RejectsMeasurementsBeyondTheGate) {
  std::mt19937_64 rng(3);
  const SensorModel sensor = range_rate();
  const Gaussian prior = belief_at(3.0, 2.0, 0.02, 0.05);
  models::Measurement z = measured(sensor, {}, prior.mean, rng);
  z.z(1) += 2.0;  // m/s; 20 σ of the rate
  auto information = models::to_information(prior).value();
  const auto before = information;
  EXPECT_EQ(measure(information, sensor, {}, z, 5.0), Use::kGated);
  EXPECT_EQ(information.matrix, before.matrix);
  EXPECT_EQ(information.vector, before.vector);
  EXPECT_EQ(measure(information, sensor, {}, z, 0.0), Use::kUsed);
}

/// Result of tracking with one sensor kind.
struct Tracked {
  double nees = 0.0;                ///< mean over steps; 4 for a consistent filter
  double velocity_sigma_mps = 0.0;  ///< mean of the stated 1σ of a velocity component
};

// Simulates a robot that circles a target and measures it at each step. The target moves by its
// model.
Tracked track_with(SensorKind kind, std::uint64_t seeds) {
  constexpr int kSteps = 40;
  constexpr double kStep_s = 0.5;
  SensorModel sensor = range_rate();
  sensor.kind = kind;
  const models::TargetModel model{models::TargetKind::kDoubleIntegrator, 2, 0.02};
  const StateMatrix A = model.transition(kStep_s);
  const StateMatrix W_root = model.process_noise(kStep_s).llt().matrixL();
  Tracked out;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> normal;
    Gaussian belief = belief_at(0.0, 0.0, 0.3, 0.3);
    StateVector truth = draw(belief, rng);
    for (int step = 0; step < kSteps; ++step) {
      StateVector noise(4);
      for (Eigen::Index i = 0; i < 4; ++i) {
        noise(i) = normal(rng);
      }
      truth = A * truth + W_root * noise;
      belief = models::predict(belief, model, kStep_s);
      const double angle_rad = 0.4 * step;
      const Viewpoint from{
          {truth(0) + 3.0 * std::cos(angle_rad), truth(1) + 3.0 * std::sin(angle_rad), 0.0}, 1.0};
      auto information = models::to_information(belief).value();
      EXPECT_EQ(measure(information, sensor, from, measured(sensor, from, truth, rng), 0.0),
                Use::kUsed);
      belief = models::to_gaussian(information).value();
      const Eigen::Vector4d error = belief.mean - truth;
      out.nees += error.dot(Eigen::Matrix4d(belief.covariance).llt().solve(error));
      out.velocity_sigma_mps +=
          std::sqrt(0.5 * (belief.covariance(2, 2) + belief.covariance(3, 3)));
    }
  }
  out.nees /= static_cast<double>(seeds) * kSteps;
  out.velocity_sigma_mps /= static_cast<double>(seeds) * kSteps;
  return out;
}

TEST(MeasureVelocity, IsConsistentAndKnowsTheVelocityBetterThanWithRangesAlone) {
  const Tracked with_rate = track_with(SensorKind::kRangeRate, 50);
  const Tracked by_range = track_with(SensorKind::kRange, 50);
  EXPECT_GT(with_rate.nees, 3.4);
  EXPECT_LT(with_rate.nees, 4.6);
  EXPECT_LT(with_rate.velocity_sigma_mps, 0.9 * by_range.velocity_sigma_mps);
}

}  // namespace
}  // namespace vantage::estimator
