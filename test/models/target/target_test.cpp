#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "models/target/target_model.hpp"
#include "test/support/near.hpp"

namespace vantage::models {
namespace {

const TargetModel kModels[] = {
    {TargetKind::kStatic, 2, 0.3},           {TargetKind::kStatic, 3, 0.3},
    {TargetKind::kRandomWalk, 2, 0.3},       {TargetKind::kRandomWalk, 3, 0.3},
    {TargetKind::kDoubleIntegrator, 2, 0.3}, {TargetKind::kGrowingUncertainty, 3, 0.3},
};

TEST(TargetModel, HasAsManyRowsAsItsState) {
  const int expected[] = {2, 3, 2, 3, 4, 3};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(kModels[i].dim(), expected[i]);
    EXPECT_EQ(kModels[i].transition(0.5).rows(), expected[i]);
    EXPECT_EQ(kModels[i].process_noise(0.5).cols(), expected[i]);
  }
}

// A(s + t) = A(t) A(s) and W(s + t) = A(t) W(s) A(t)ᵀ + W(t): two short steps are one long one.
TEST(TargetModel, ForgetsHowTimeWasCutIntoSteps) {
  for (const TargetModel& model : kModels) {
    if (model.kind == TargetKind::kGrowingUncertainty) {
      continue;  // counted in steps, by definition
    }
    const StateMatrix A = model.transition(0.7);
    EXPECT_TRUE(test::is_near((A * model.transition(0.3)).eval(), model.transition(1.0), 1e-15));
    const StateMatrix W = A * model.process_noise(0.3) * A.transpose() + model.process_noise(0.7);
    EXPECT_TRUE(test::is_near(W, model.process_noise(1.0), 1e-15));
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

TEST(DoubleIntegrator, MovesByItsVelocity) {
  const TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.0};
  const StateVector y = model.transition(0.5) * Eigen::Vector4d(1.0, 2.0, 4.0, -8.0);
  EXPECT_TRUE(test::is_near(y, Eigen::Vector4d(3.0, -2.0, 4.0, -8.0), 0.0));
}

TEST(TargetModel, HasNoiseThatIsSymmetricAndNotNegative) {
  for (const TargetModel& model : kModels) {
    const Eigen::MatrixXd W = model.process_noise(0.5, 3);
    EXPECT_TRUE(test::is_near(W, W.transpose(), 0.0));
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(W).eigenvalues().minCoeff(), -1e-15);
  }
}

TEST(StaticTarget, KnowsNoNoise) { EXPECT_TRUE(kModels[0].process_noise(10.0).isZero(0.0)); }

TEST(RandomWalk, SpreadsByQPerSecond) {
  EXPECT_TRUE(test::is_near(kModels[3].process_noise(2.0), 0.6 * Eigen::Matrix3d::Identity(), 0.0));
}

TEST(GrowingUncertainty, GrowsWithTheStepsUnseenAndNotWithTime) {
  const TargetModel& model = kModels[5];
  EXPECT_TRUE(test::is_near(model.process_noise(0.1, 4), 1.2 * Eigen::Matrix3d::Identity(), 0.0));
  EXPECT_EQ(model.process_noise(0.1, 4), model.process_noise(9.0, 4));
}

}  // namespace
}  // namespace vantage::models
