#include "estimator/posterior/posterior_moments.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "test/estimator/filter_support.hpp"
#include "test/estimator/posterior/dense_posterior.hpp"
#include "test/support/own_sensor.hpp"
#include "test/support/random.hpp"

// Tests edge cases of the posterior moments; track_test compares ordinary cases with brute force.

namespace vantage::estimator {
namespace {

using test::at;
using test::far_sighted;

models::Measurement one(double z, double sigma) {
  return {Eigen::Matrix<double, 1, 1>(z), Eigen::Matrix<double, 1, 1>(sigma * sigma)};
}

// The posterior density falls with the distance from the robot in every direction, so the posterior
// is near the robot although the prior is wide.
TEST(PosteriorMoments, AreNearTheRobotForANegativeRange) {
  const double prior_sigma_m = 0.5;
  const double sigma_m = 0.1;
  const double z_m = -0.8;
  const auto found = posterior_moments(
      {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity() / (prior_sigma_m * prior_sigma_m)},
      far_sighted(models::SensorKind::kRange), at(0.0, 0.0), one(z_m, sigma_m));
  ASSERT_TRUE(found);
  double mass = 0.0;
  double squares = 0.0;
  for (double r = 5e-6; r < 1.0; r += 1e-5) {
    const double off_m = (z_m - r) / sigma_m;
    const double p =
        r * std::exp(-0.5 * (r * r / (prior_sigma_m * prior_sigma_m) + off_m * off_m) + 32.0);
    mass += p;
    squares += p * r * r;
  }
  EXPECT_LT(found->mean_m.norm(), 1e-9);
  EXPECT_NEAR(found->covariance_m2.trace(), squares / mass, 0.003 * squares / mass);
}

// The noise exceeds a full turn, so all directions must have equal weight.
TEST(PosteriorMoments, EqualThePriorForAnUninformativeBearing) {
  const Eigen::Vector2d mean_m(2.0, 0.5);
  const Eigen::Matrix2d P = Eigen::Vector2d(0.16, 0.04).asDiagonal();
  for (const double sigma_rad : {20.0, 200.0}) {
    const auto found =
        posterior_moments({mean_m, P.inverse()}, far_sighted(models::SensorKind::kBearing),
                          at(0.0, 0.0), one(1.0, sigma_rad));
    ASSERT_TRUE(found);
    EXPECT_LT((found->mean_m - mean_m).norm(), 2e-3) << sigma_rad;
    EXPECT_LT((found->covariance_m2 - P).norm(), 1e-3) << sigma_rad;
  }
}

// With a prior σ of 10⁸⁰ m the mean is finite but its square overflows.
TEST(PosteriorMoments, AreEmptyOnOverflow) {
  const auto moments = [](double information) {
    return posterior_moments({Eigen::Vector2d(2.0, 0.5), information * Eigen::Matrix2d::Identity()},
                             far_sighted(models::SensorKind::kBearing), at(0.0, 0.0),
                             one(0.2, 0.1));
  };
  EXPECT_TRUE(moments(1e-20));
  EXPECT_FALSE(moments(1e-160));
}

struct Prior {
  Eigen::VectorXd mean_m;
  Eigen::MatrixXd P_m2;
  [[nodiscard]] PositionPrior as_prior() const { return {mean_m, P_m2.inverse()}; }
};

// A position sensor gives the Kalman update, rotated by the robot's heading, in the plane and in
// space, also for correlated noise.
TEST(PosteriorMoments, EqualAKalmanUpdateForPositions) {
  vantage::test::Random random(21);
  const models::SensorModel sensor = far_sighted(models::SensorKind::kPosition);
  for (int trial = 0; trial < 24; ++trial) {
    const int n = trial % 4 == 0 ? 3 : 2;
    models::Viewpoint from =
        at(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
    from.height_m = 1.2;
    const Prior prior{random.vector<3>(-4.0, 4.0).head(n), random.spd(n, 0.2)};
    const models::PositionVector seen_m = prior.mean_m + 0.7 * random.vector<3>(-1.0, 1.0).head(n);
    const models::Measurement z{models::observe(sensor, from, seen_m), random.spd(n, 0.2)};
    const auto found = posterior_moments(prior.as_prior(), sensor, from, z);
    ASSERT_TRUE(found);
    const Eigen::MatrixXd H = models::observation_jacobian(sensor, from, seen_m);
    const Eigen::VectorXd nu =
        Eigen::VectorXd(z.z) - Eigen::VectorXd(models::observe(sensor, from, prior.mean_m));
    const Eigen::MatrixXd S = H * prior.P_m2 * H.transpose() + Eigen::MatrixXd(z.V);
    const Eigen::MatrixXd K = prior.P_m2 * H.transpose() * S.inverse();
    const Eigen::MatrixXd P = prior.P_m2 - K * H * prior.P_m2;
    const Eigen::VectorXd off = Eigen::VectorXd(found->mean_m) - prior.mean_m - K * nu;
    EXPECT_LT(Eigen::LLT<Eigen::MatrixXd>(P).matrixL().solve(off).norm(), 5e-3) << trial;
    EXPECT_LT((Eigen::MatrixXd(found->covariance_m2) - P).norm(), 0.01 * P.norm()) << trial;
    EXPECT_EQ(found->covariance_m2, found->covariance_m2.transpose());
    EXPECT_NEAR(found->mahalanobis2, nu.dot(S.inverse() * nu), n == 3 ? 0.2 : 0.1) << trial;
  }
}

// A sensor with a known scale and offset error gives the same moments as an ideal sensor, also when
// range and bearing noise are correlated.
TEST(PosteriorMoments, UseTheTrueRangeOfACalibratedSensor) {
  vantage::test::Random random(22);
  for (const auto kind : {models::SensorKind::kRange, models::SensorKind::kRangeBearing}) {
    const models::SensorModel plain = far_sighted(kind);
    models::SensorModel calibrated = plain;
    calibrated.calibration = {1.3, -0.6};
    for (int trial = 0; trial < 10; ++trial) {
      const models::Viewpoint from = at(0.5, -0.3, random.uniform(-3, 3));
      const Prior prior{random.vector<2>(-4.0, 4.0), random.spd(2, 0.2)};
      const bool has_bearing = kind == models::SensorKind::kRangeBearing;
      models::Measurement z{models::observe(plain, from, prior.mean_m), random.spd(2, 0.2)};
      z.z(0) += 0.3;
      z.V *= 0.05;
      if (!has_bearing) {
        z.V = z.V.topLeftCorner(1, 1).eval();
      }
      models::Measurement distorted = z;
      distorted.z(0) = 1.3 * z.z(0) - 0.6;
      distorted.V.row(0) *= 1.3;
      distorted.V.col(0) *= 1.3;
      const auto right = posterior_moments(prior.as_prior(), plain, from, z);
      const auto found = posterior_moments(prior.as_prior(), calibrated, from, distorted);
      ASSERT_TRUE(right && found);
      EXPECT_LT((found->mean_m - right->mean_m).norm(), 1e-9);
      EXPECT_LT((found->covariance_m2 - right->covariance_m2).norm(), 1e-9);
      EXPECT_NEAR(found->mahalanobis2, right->mahalanobis2, 1e-9);
      // Brute force gives the same moments.
      const auto oracle = test::dense_posterior(prior.mean_m, prior.P_m2.inverse(), calibrated,
                                                from, distorted, false, 160);
      ASSERT_TRUE(oracle);
      const test::Difference d = test::difference(found->mean_m, found->covariance_m2, *oracle);
      EXPECT_LT(d.mean_sigma, 0.02) << kind.name();
      EXPECT_LT(d.covariance_share, 0.03) << kind.name();
    }
  }
}

// Compares the distance with the minimum over a grid of positions.
TEST(PosteriorMoments, ReportTheDistanceOfMeasurementAndPrior) {
  vantage::test::Random random(23);
  for (const auto kind : {models::SensorKind::kRange, models::SensorKind::kBearing,
                          models::SensorKind::kRangeBearing, models::SensorKind::kCamera}) {
    models::SensorModel sensor = far_sighted(kind);
    models::Viewpoint from = at(0.5, -0.3, 0.8);
    from.height_m = 3.0;
    for (int trial = 0; trial < 4; ++trial) {
      const Prior prior{random.vector<2>(2.0, 4.0), random.spd(2, 0.2)};
      const models::PositionVector seen_m = prior.mean_m + random.vector<2>(-1.5, 1.5);
      models::Measurement z{models::observe(sensor, from, seen_m),
                            models::noise_covariance(sensor, from, seen_m)};
      z.V *= kind == models::SensorKind::kCamera ? 400.0 : 4.0;
      const auto found = posterior_moments(prior.as_prior(), sensor, from, z);
      ASSERT_TRUE(found);
      const Eigen::MatrixXd Omega = prior.P_m2.inverse();
      const Eigen::MatrixXd W = Eigen::MatrixXd(z.V).inverse();
      double least = 1e9;
      for (double x_m = -4.0; x_m < 10.0; x_m += 0.02) {
        for (double y_m = -4.0; y_m < 10.0; y_m += 0.02) {
          const models::PositionVector p_m = Eigen::Vector2d(x_m, y_m);
          const Eigen::VectorXd off = Eigen::VectorXd(p_m) - prior.mean_m;
          const double of_prior = off.dot(Omega * off);
          if (of_prior > 30.0) {
            continue;
          }
          const Eigen::VectorXd nu =
              models::innovation(sensor, z.z, models::observe(sensor, from, p_m));
          least = std::min(least, of_prior + nu.dot(W * nu));
        }
      }
      EXPECT_NEAR(found->mahalanobis2, least, 0.06 + 0.02 * least) << kind.name();
    }
  }
}

TEST(PosteriorMoments, AreEmptyForInvalidNoise) {
  models::SensorModel own = far_sighted(vantage::test::signal_strength());
  models::Viewpoint from = at(0.0, 0.0);
  from.height_m = 1.0;
  const PositionPrior in_space{Eigen::Vector3d(2.0, 1.0, 0.5), Eigen::Matrix3d::Identity()};
  const PositionPrior on_ground{Eigen::Vector2d(2.0, 1.0), Eigen::Matrix2d::Identity()};
  EXPECT_FALSE(can_integrate(own, 3));
  EXPECT_TRUE(can_integrate(own, 2));
  EXPECT_FALSE(posterior_moments(in_space, own, from, one(-6.0, 0.8)));
  EXPECT_TRUE(posterior_moments(on_ground, own, from, one(-6.0, 0.8)));
  for (const auto kind : models::all_sensor_kinds()) {
    EXPECT_TRUE(can_integrate(far_sighted(kind), 2)) << kind.name();
    EXPECT_TRUE(can_integrate(far_sighted(kind), 3)) << kind.name();
  }
  models::Measurement none = one(2.0, 0.1);
  none.V(0, 0) = -0.01;
  EXPECT_FALSE(posterior_moments(on_ground, far_sighted(models::SensorKind::kRange), from, none));
}

}  // namespace
}  // namespace vantage::estimator
