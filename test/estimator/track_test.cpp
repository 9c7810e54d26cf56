#include "estimator/track.hpp"

#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

namespace vantage::estimator {
namespace {

using models::Gaussian;
using models::TargetKind;
using test::at;
using test::instant;
using vantage::test::is_near;

TEST(Propagate, InTwoPartsIsTheSameAsInOne) {
  for (const TargetKind kind : {TargetKind::kStatic, TargetKind::kRandomWalk,
                                TargetKind::kDoubleIntegrator, TargetKind::kGrowingUncertainty}) {
    const models::TargetModel model{kind, 2, 0.3};
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

TEST(Propagate, OfGrowingUncertaintyAddsTheStepsOwnNoise) {
  const models::TargetModel model{TargetKind::kGrowingUncertainty, 3, 0.01};
  const auto belief =
      models::to_information({models::StateVector::Zero(3), models::StateMatrix::Identity(3, 3)})
          .value();
  // Seen two steps before; three more steps unseen: k = 3, 4, 5.
  const auto later = propagate(model, 0.5, belief, instant(0), instant(2), instant(5)).value();
  double variance = 1.0;
  for (int k = 3; k <= 5; ++k) {
    variance += model.process_noise(0.5, k)(0, 0);
  }
  EXPECT_TRUE(is_near(models::to_gaussian(later)->covariance,
                      variance * models::StateMatrix::Identity(3, 3), 1e-12));
}

TEST(Propagate, RefusesABeliefThatCannotBeInverted) {
  const models::Information nothing{models::StateVector::Zero(2), models::StateMatrix::Zero(2, 2)};
  EXPECT_FALSE(propagate({TargetKind::kRandomWalk, 2, 0.1}, 0.5, nothing, instant(0), instant(0),
                         instant(1)));
}

TEST(Measure, AgreesWithTheCovarianceFormForEverySensor) {
  std::mt19937_64 rng(17);
  for (const auto kind :
       {models::SensorKind::kPosition, models::SensorKind::kRange, models::SensorKind::kBearing,
        models::SensorKind::kRangeBearing, models::SensorKind::kCamera}) {
    models::SensorModel sensor;
    sensor.kind = kind;
    int narrow = 0;
    for (int trial = 0; trial < 50; ++trial) {
      models::Viewpoint from = at(0.3, -0.2, 3.0);
      from.height_m = 2.0;
      const Eigen::Matrix4d root =
          Eigen::Map<const Eigen::Matrix4d>(test::normal_vector(16, rng).eval().data());
      Gaussian belief{2.0 * test::normal_vector(4, rng), 0.01 * root * root.transpose()};
      belief.covariance += 0.001 * Eigen::Matrix4d::Identity();
      const models::PositionVector about_m = belief.mean.head(2);
      if (!models::in_view(sensor, from, about_m)) {
        continue;
      }
      const auto z = models::sample(sensor, from, about_m, rng);
      auto information = models::to_information(belief).value();
      ASSERT_EQ(measure(information, sensor, from, z, 0.0), Use::kUsed);
      if (linearisation_point(belief, sensor, from, z) != about_m) {
        continue;  // too wide to be linear about its mean
      }
      ++narrow;
      const auto by_position = models::observation_jacobian(sensor, from, about_m);
      models::MeasurementJacobian H = models::MeasurementJacobian::Zero(by_position.rows(), 4);
      H.leftCols(2) = by_position;
      const Gaussian expected = models::update(
          belief, H, z.V, models::innovation(sensor, z.z, models::observe(sensor, from, about_m)));
      const Gaussian actual = models::to_gaussian(information).value();
      EXPECT_TRUE(is_near(actual.mean, expected.mean, 1e-8));
      EXPECT_TRUE(is_near(actual.covariance, expected.covariance, 1e-8));
    }
    EXPECT_GT(narrow, 5);
  }
}

TEST(Measure, FindsTheMostLikelyPositionOfATargetItKnowsPoorly) {
  // A wide belief and a sharp look: about the belief's mean the answer would lie on a tangent,
  // metres from where the look says.
  models::SensorModel sensor;
  sensor.range_sigma_m = 0.1;
  sensor.bearing_sigma_rad = 0.05;
  auto belief =
      models::to_information({Eigen::Vector2d(1.0, 0.0), 4.0 * Eigen::Matrix2d::Identity()})
          .value();
  const Eigen::Vector2d target_m(-1.0, 2.0);
  models::Measurement z;
  z.z = models::observe(sensor, at(0, 0), target_m);
  z.V = models::noise_covariance(sensor, at(0, 0), target_m);
  ASSERT_EQ(measure(belief, sensor, at(0, 0), z, 0.0), Use::kUsed);
  const Gaussian g = models::to_gaussian(belief).value();
  EXPECT_LT((Eigen::Vector2d(g.mean) - target_m).norm(), 0.02);
  // At the answer, the gradient of the posterior's logarithm vanishes.
  const auto H = models::observation_jacobian(sensor, at(0, 0), g.mean.head(2));
  const auto nu =
      models::innovation(sensor, z.z, models::observe(sensor, at(0, 0), g.mean.head(2)));
  const Eigen::Vector2d gradient = H.transpose() * z.V.inverse() * nu -
                                   (Eigen::Vector2d(g.mean) - Eigen::Vector2d(1.0, 0.0)) / 4.0;
  EXPECT_LT(gradient.norm(), 1e-3);
}

TEST(Measure, WrapsTheBearingBehindTheRobot) {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kBearing;
  auto belief =
      models::to_information({Eigen::Vector2d(-5.0, -0.1), Eigen::Matrix2d::Identity()}).value();
  models::Measurement z;
  z.z = Eigen::Matrix<double, 1, 1>(kPi - 0.02);  // the prediction is just beyond −π
  z.V = Eigen::Matrix<double, 1, 1>(0.01);
  ASSERT_EQ(measure(belief, sensor, at(0, 0), z, 0.0), Use::kUsed);
  EXPECT_NEAR(models::to_gaussian(belief)->mean(1), 0.07, 0.05);
}

TEST(Measure, LeavesABeliefAloneBeyondTheGateOrAtTheSensor) {
  const models::SensorModel sensor;
  const auto start =
      models::to_information({Eigen::Vector2d(5.0, 0.0), 0.01 * Eigen::Matrix2d::Identity()})
          .value();
  models::Measurement z{Eigen::Vector2d(6.0, 0.0), Eigen::Matrix2d::Identity() * 0.01};
  auto belief = start;
  EXPECT_EQ(measure(belief, sensor, at(0, 0), z, 5.0), Use::kGated);  // 1 m at σ √0.02 is 7.1 σ
  EXPECT_EQ(belief.matrix, start.matrix);
  EXPECT_EQ(measure(belief, sensor, at(0, 0), z, 8.0), Use::kUsed);
  models::SensorModel ranger;
  ranger.kind = models::SensorKind::kRange;  // no direction to be told from its own place
  models::Measurement range{Eigen::Matrix<double, 1, 1>(1.0), Eigen::Matrix<double, 1, 1>(0.01)};
  auto here = start;
  EXPECT_EQ(measure(here, ranger, at(5.0, 0.0), range, 0.0), Use::kSingular);
  EXPECT_EQ(here.matrix, start.matrix);
  z.V.setZero();
  EXPECT_EQ(measure(here, sensor, at(0, 0), z, 0.0), Use::kSingular);
}

TEST(Discover, StatesThePriorWhereTheCameraIsSilent) {
  models::EstimatorSpec spec;
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
  // Straight down: one pixel at depth 4 is 4/500 m across; the depth itself is not measured.
  EXPECT_NEAR(g.covariance(0, 0), std::pow(4.0 / 500.0, 2), 1e-9);
  EXPECT_NEAR(g.covariance(2, 2), 4.0, 1e-9);
}

}  // namespace
}  // namespace vantage::estimator
