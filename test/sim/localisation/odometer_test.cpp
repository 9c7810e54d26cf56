#include "sim/localisation/odometer.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace vantage::sim {
namespace {

constexpr double kPeriodS = 0.05;
const Pose2 kStep{0.05, 0.01, 0.02};

scenario::SimulatedOdometerSpec exact() {
  scenario::SimulatedOdometerSpec spec;
  spec.noise_scale = 0.0;
  return spec;
}

TEST(Odometer, ReportsTheTrueMotionWithoutErrors) {
  Odometer odometer(exact(), {}, "Q1", 1);
  const Eigen::Vector3d reported = odometer.report(kStep, kPeriodS);
  EXPECT_LT((reported - Eigen::Vector3d(0.05, 0.01, 0.02)).norm(), 1e-12);
}

TEST(Odometer, ScalesAndBiasesItsReports) {
  scenario::SimulatedOdometerSpec spec = exact();
  spec.speed_scale = 1.1;
  spec.turn_scale = 0.9;
  spec.turn_bias_radps = 0.2;
  Odometer odometer(spec, {}, "Q1", 1);
  const Eigen::Vector3d reported = odometer.report(kStep, kPeriodS);
  EXPECT_NEAR(reported.x(), 1.1 * 0.05, 1e-12);
  EXPECT_NEAR(reported.y(), 1.1 * 0.01, 1e-12);
  EXPECT_NEAR(reported.z(), 0.9 * 0.02 + 0.2 * kPeriodS, 1e-12);
}

// Slips begin as a Poisson process, so the share of slipping reports follows from its rate.
TEST(Odometer, SlipsWithTheStatedRate) {
  scenario::SimulatedOdometerSpec spec = exact();
  spec.slips_per_min = 6.0;
  spec.slip_s = 1.0;
  spec.slip_share = 0.5;
  Odometer odometer(spec, {}, "Q1", 7);
  constexpr int kReports = 200000;
  int slipping = 0;
  for (int i = 0; i < kReports; ++i) {
    const double forward_m = odometer.report(kStep, kPeriodS).x();
    EXPECT_NEAR(forward_m, odometer.is_slipping() ? 0.075 : 0.05, 1e-12);
    slipping += odometer.is_slipping() ? 1 : 0;
  }
  // Reports slip for 1 s after each start of a slip: their share is 1 − exp(−0.1 /s · 1 s).
  EXPECT_NEAR(static_cast<double>(slipping) / kReports, 1.0 - std::exp(-0.1), 0.01);
}

// The heading's error after time T has the variance of white noise plus drift.
TEST(Odometer, HasTheStatedNoiseOfTheHeading) {
  scenario::OdometryNoiseSpec noise;
  noise.turn_sigma_rad_per_sqrt_s = 0.02;
  noise.turn_sigma_per_sqrt_rad = 0.0;
  noise.turn_drift_radps = 0.01;
  noise.turn_drift_time_s = 1e6;  // the drift is constant during the test
  noise.slide_sigma_per_sqrt_m = 0.0;
  noise.speed_drift_share = 0.0;
  scenario::SimulatedOdometerSpec spec;
  constexpr int kRuns = 4000;
  constexpr int kReports = 20;  // 1 s in total
  double squared = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    Odometer odometer(spec, noise, "Q1", static_cast<std::uint64_t>(run));
    double error_rad = 0.0;
    for (int i = 0; i < kReports; ++i) {
      error_rad += odometer.report(kStep, kPeriodS).z() - kStep.yaw_rad;
    }
    squared += error_rad * error_rad;
  }
  const double variance = 0.02 * 0.02 + 0.01 * 0.01;  // σ of the estimate: √(2 / 4000) = 2.2 %
  EXPECT_NEAR(squared / kRuns, variance, 0.1 * variance);
}

TEST(Odometer, StatesAPositiveDefiniteCovariance) {
  Odometer odometer(exact(), {}, "Q1", 1);
  const Eigen::Matrix3d covariance = odometer.covariance(Eigen::Vector3d::Zero(), kPeriodS);
  EXPECT_GT(covariance.diagonal().minCoeff(), 0.0);
}

}  // namespace
}  // namespace vantage::sim
