#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "models/target/target_model.hpp"
#include "test/support/near.hpp"
#include "test/support/own_target.hpp"

namespace vantage::models {
namespace {

// Underdamped (γ² < 4 σ_v²/σ_p²) on one axis, overdamped on the other.
const DampedOscillator kSwings{{1.0, -2.0}, {1.8, 0.8}, {0.4, 0.25}, {0.3, 0.9}};
const DampedOscillator kOnTheEdge{{0.0, 0.0}, {2.0, 1.0}, {0.5, 0.25}, {0.5, 0.5 + 1e-6}};

const TargetModel kModels[] = {
    {TargetKind::kStatic, 2, 0.3},
    {TargetKind::kStatic, 3, 0.3},
    {TargetKind::kRandomWalk, 2, 0.3},
    {TargetKind::kRandomWalk, 3, 0.3},
    {TargetKind::kDoubleIntegrator, 2, 0.3},
    {TargetKind::kGrowingUncertainty, 3, 0.3},
    {TargetKind::kDampedOscillator, 2, 0.0, kSwings},
    {TargetKind::kDampedOscillator, 2, 0.0, kOnTheEdge},
    {test::drag(), 2, 0.3},
};

// Returns the stationary covariance of an oscillator; position and velocity have the distributions
// N(c, σ_p²) and N(0, σ_v²).
StateMatrix stationary(const DampedOscillator& around) {
  Eigen::Vector4d variances;
  variances << around.position_sigma_m.cwiseAbs2(), around.velocity_sigma_mps.cwiseAbs2();
  return variances.asDiagonal();
}

TEST(TargetModel, HasTheDimensionOfItsState) {
  const int expected[] = {2, 3, 2, 3, 4, 3, 4, 4, 4};
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(kModels[i].dim(), expected[i]);
    EXPECT_EQ(kModels[i].transition(0.5).rows(), expected[i]);
    EXPECT_EQ(kModels[i].process_noise(0.5).cols(), expected[i]);
  }
}

// A(s + t) = A(t) A(s) and W(s + t) = A(t) W(s) A(t)ᵀ + W(t): two short steps equal one long step.
TEST(TargetModel, IsIndependentOfStepPartition) {
  for (const TargetModel& model : kModels) {
    if (model.kind == TargetKind::kGrowingUncertainty) {
      continue;  // its noise depends on the number of steps
    }
    const StateMatrix A = model.transition(0.7);
    EXPECT_TRUE(test::is_near((A * model.transition(0.3)).eval(), model.transition(1.0), 1e-14));
    const StateMatrix W = A * model.process_noise(0.3) * A.transpose() + model.process_noise(0.7);
    EXPECT_TRUE(test::is_near(W, model.process_noise(1.0), 1e-14));
  }
}

// W = ∫ e^{Fs} G q Gᵀ e^{Fᵀs} ds by the midpoint rule.
TEST(DoubleIntegrator, HasTheNoiseOfWhiteAcceleration) {
  const TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.3};
  constexpr int kSteps = 4000;
  const double step_s = 0.5 / kSteps;
  Eigen::Matrix4d W = Eigen::Matrix4d::Zero();
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) * step_s;
    Eigen::Matrix<double, 4, 2> G;
    G << s, 0, 0, s, 1, 0, 0, 1;
    W += 0.3 * step_s * G * G.transpose();
  }
  EXPECT_TRUE(test::is_near(model.process_noise(0.5), W, 1e-8));
}

TEST(DoubleIntegrator, MovesAtItsVelocity) {
  const TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.0};
  const StateVector y = model.transition(0.5) * Eigen::Vector4d(1.0, 2.0, 4.0, -8.0);
  EXPECT_TRUE(test::is_near(y, Eigen::Vector4d(3.0, -2.0, 4.0, -8.0), 0.0));
}

TEST(DampedOscillator, KeepsItsStationaryDistribution) {
  for (const DampedOscillator& around : {kSwings, kOnTheEdge}) {
    const TargetModel model{TargetKind::kDampedOscillator, 2, 0.0, around};
    const StateMatrix P = stationary(around);
    for (const double dt_s : {1e-3, 0.5, 3.0, 60.0}) {
      const StateMatrix A = model.transition(dt_s);
      EXPECT_TRUE(
          test::is_near((A * P * A.transpose() + model.process_noise(dt_s)).eval(), P, 1e-14));
    }
    EXPECT_TRUE(test::is_near(model.process_noise(300.0), P, 1e-12));
    EXPECT_TRUE(test::is_near(model.expected(Eigen::Vector4d(3.0, 1.0, 1.0, -1.0), 300.0).head(2),
                              around.center_m, 1e-9));
  }
}

// The reference is ẏ = F y by short Euler steps, and W = ∫ e^{Fs} G q Gᵀ e^{Fᵀs} ds with q = 2 γ
// σ_v².
TEST(DampedOscillator, SolvesItsDifferentialEquation) {
  const TargetModel model{TargetKind::kDampedOscillator, 2, 0.0, kSwings};
  constexpr int kSteps = 200'000;
  constexpr double kStep_s = 2.0 / kSteps;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double omega = kSwings.velocity_sigma_mps(i) / kSwings.position_sigma_m(i);
    Eigen::Matrix2d F;
    F << 0.0, 1.0, -omega * omega, -kSwings.damping_per_s(i);
    const double q = 2.0 * kSwings.damping_per_s(i) * kSwings.velocity_sigma_mps(i) *
                     kSwings.velocity_sigma_mps(i);
    Eigen::Matrix2d A = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d W = Eigen::Matrix2d::Zero();
    for (int k = 0; k < kSteps; ++k) {
      W += q * kStep_s * A.col(1) * A.col(1).transpose();
      A += kStep_s * F * A;
    }
    const StateMatrix whole = model.transition(2.0);
    const StateMatrix noise = model.process_noise(2.0);
    for (Eigen::Index r = 0; r < 2; ++r) {
      for (Eigen::Index c = 0; c < 2; ++c) {
        EXPECT_NEAR(whole(i + 2 * r, i + 2 * c), A(r, c), 3e-5);
        EXPECT_NEAR(noise(i + 2 * r, i + 2 * c), W(r, c), 3e-5);
      }
    }
  }
}

// A wide, slowly damped oscillator approaches a double integrator with the same q = 2 γ σ_v².
TEST(DampedOscillator, TendsToADoubleIntegrator) {
  constexpr double kDamping_per_s = 1e-5;
  const double sigma_mps = std::sqrt(0.3 / (2.0 * kDamping_per_s));
  const TargetModel free{TargetKind::kDoubleIntegrator, 2, 0.3};
  TargetModel bound{TargetKind::kDampedOscillator};
  bound.oscillator.position_sigma_m.setConstant(1e5 * sigma_mps);
  bound.oscillator.velocity_sigma_mps.setConstant(sigma_mps);
  bound.oscillator.damping_per_s.setConstant(kDamping_per_s);
  EXPECT_TRUE(test::is_near(bound.transition(0.5), free.transition(0.5), 1e-4));
  const StateMatrix W = bound.process_noise(0.5);
  EXPECT_NEAR(W(2, 2), 0.15, 1e-4);
  EXPECT_NEAR(W(0, 2), 0.3 * 0.5 * 0.5 / 2.0, 1e-4);
}

TEST(DampedOscillator, MovesFreelyAtFirstAndLaterTendsToTheCentre) {
  const TargetModel model{TargetKind::kDampedOscillator, 2, 0.0, kSwings};
  const Eigen::Vector4d y(3.0, -2.0, 0.4, 0.2);
  EXPECT_TRUE(
      test::is_near(model.expected(y, 1e-3).head(2), Eigen::Vector2d(3.0004, -1.9998), 1e-6));
  const double away_m = (model.expected(y, 20.0).head<2>() - kSwings.center_m).norm();
  EXPECT_LT(away_m, (y.head<2>() - kSwings.center_m).norm());
}

TEST(TargetModel, NoiseIsSymmetricAndPositiveSemidefinite) {
  for (const TargetModel& model : kModels) {
    const Eigen::MatrixXd W = model.process_noise(0.5, 3);
    EXPECT_TRUE(test::is_near(W, W.transpose(), 0.0));
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(W).eigenvalues().minCoeff(), -1e-15);
  }
}

TEST(StaticTarget, HasNoNoise) { EXPECT_TRUE(kModels[0].process_noise(10.0).isZero(0.0)); }

TEST(RandomWalk, GrowsByQPerSecond) {
  EXPECT_TRUE(test::is_near(kModels[3].process_noise(2.0), 0.6 * Eigen::Matrix3d::Identity(), 0.0));
}

TEST(GrowingUncertainty, GrowsIndependentlyOfStepGrouping) {
  const TargetModel& model = kModels[5];
  double sum = 0.0;
  for (int k = 0; k < 6; ++k) {
    sum += model.process_noise(0.5, k)(0, 0);
    EXPECT_NEAR(model.grown_noise(0.0, k + 1)(0, 0), sum, 1e-12);
  }
  const double cut = model.grown_noise(0.3, 2.7)(0, 0) + model.grown_noise(2.7, 6.0)(0, 0);
  EXPECT_NEAR(cut, sum, 1e-12);
}

TEST(GrowingUncertainty, IsPlannedWithTheNoiseOfTheNextStep) {
  const TargetModel planned = kModels[5].as_planned(4.0, 0.5);
  EXPECT_EQ(planned.kind, TargetKind::kRandomWalk);
  EXPECT_TRUE(test::is_near(planned.process_noise(0.5), kModels[5].process_noise(0.5, 4), 1e-12));
  EXPECT_EQ(kModels[6].as_planned(4.0, 0.5).kind, TargetKind::kDampedOscillator);
}

TEST(GrowingUncertainty, GrowsWithUnseenStepsNotWithTime) {
  const TargetModel& model = kModels[5];
  EXPECT_TRUE(test::is_near(model.process_noise(0.1, 4), 1.2 * Eigen::Matrix3d::Identity(), 0.0));
  EXPECT_EQ(model.process_noise(0.1, 4), model.process_noise(9.0, 4));
}

// Near critical damping the implementation uses a series instead of cosh and sinh. The arguments x
// are on both sides of the switch between the two formulas.
TEST(DampedOscillator, IsExactNearCriticalDamping) {
  for (const double x : {-9.9e-4, -1.01e-3, -3e-4, 3e-4, 9.9e-4, 1.01e-3}) {
    constexpr long double kT = 0.5L;
    constexpr long double kH = 0.8L;
    const long double D = static_cast<long double>(x) / (kT * kT);
    const long double k = kH * kH - D;
    TargetModel model{TargetKind::kDampedOscillator, 2};
    model.oscillator.damping_per_s.setConstant(2.0 * static_cast<double>(kH));
    model.oscillator.position_sigma_m.setConstant(2.0);
    model.oscillator.velocity_sigma_mps.setConstant(2.0 * std::sqrt(static_cast<double>(k)));
    const long double root = std::sqrt(std::abs(D));
    const long double even = D > 0.0L ? std::cosh(root * kT) : std::cos(root * kT);
    const long double odd = (D > 0.0L ? std::sinh(root * kT) : std::sin(root * kT)) / root;
    const long double e = std::exp(-kH * kT);
    const StateMatrix A = model.transition(static_cast<double>(kT));
    for (Eigen::Index i = 0; i < 2; ++i) {
      EXPECT_NEAR(A(i, i), static_cast<double>(e * (even + kH * odd)), 3e-15) << x;
      EXPECT_NEAR(A(i, i + 2), static_cast<double>(e * odd), 3e-15) << x;
      EXPECT_NEAR(A(i + 2, i), static_cast<double>(-k * e * odd), 3e-15) << x;
      EXPECT_NEAR(A(i + 2, i + 2), static_cast<double>(e * (even - kH * odd)), 3e-15) << x;
      EXPECT_EQ(A(i, 1 - i), 0.0);
    }
  }
}

TEST(GrowingUncertainty, RoundsToWholeSteps) {
  const TargetModel& model = kModels[5];
  EXPECT_NEAR(model.as_planned(3.0 - 1e-7, 0.5).q, 3.0 * 0.3 / 0.5, 1e-12);
  EXPECT_NEAR(model.as_planned(3.0 - 1e-5, 0.5).q, 2.0 * 0.3 / 0.5, 1e-12);
  EXPECT_NEAR(model.as_planned(3.9, 0.25).q, 3.0 * 0.3 / 0.25, 1e-12);
  for (const int i : {1, 3, 4}) {
    EXPECT_EQ(kModels[i].as_planned(3.0, 0.5).q, kModels[i].q);
  }
}

}  // namespace
}  // namespace vantage::models
