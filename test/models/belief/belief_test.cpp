#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "models/belief/gaussian.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

struct Shape {
  int state;
  int position;
};
constexpr Shape kShapes[] = {{2, 2}, {3, 3}, {4, 2}, {3, 2}, {4, 3}};

Gaussian random_belief(test::Random& random, int n) {
  Gaussian belief;
  belief.mean = Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(-5.0, 5.0); });
  belief.covariance = random.spd(n, 0.05);
  return belief;
}

// Returns a random p × p position information matrix of the given rank.
Eigen::MatrixXd random_information(test::Random& random, int p, int rank) {
  const Eigen::MatrixXd B = Eigen::MatrixXd::NullaryExpr(p, rank, [&] { return random.normal(); });
  return B * B.transpose() * std::pow(10.0, random.uniform(-3.0, 3.0));
}

Eigen::MatrixXd embedded(const Eigen::MatrixXd& M, int n) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n, n);
  whole.topLeftCorner(M.rows(), M.cols()) = M;
  return whole;
}

TEST(UpdateCovariance, EqualsTheInverseOfSummedInformation) {
  test::Random random(21);
  for (const Shape& shape : kShapes) {
    for (int i = 0; i < 2000; ++i) {
      const Gaussian belief = random_belief(random, shape.state);
      const Eigen::MatrixXd M =
          random_information(random, shape.position, i % (shape.position + 1));
      const Eigen::MatrixXd Sigma = belief.covariance;
      const Eigen::MatrixXd expected = (Sigma.inverse() + embedded(M, shape.state)).inverse();
      ASSERT_TRUE(test::is_near(update_covariance(belief.covariance, M), expected, 1e-10));
    }
  }
}

TEST(UpdateCovariance, KeepsTheCovarianceWithoutInformation) {
  test::Random random(22);
  for (const Shape& shape : kShapes) {
    const Gaussian belief = random_belief(random, shape.state);
    const PositionMatrix none = PositionMatrix::Zero(shape.position, shape.position);
    EXPECT_TRUE(test::is_near(update_covariance(belief.covariance, none), belief.covariance, 0.0));
  }
}

TEST(UpdateCovariance, AcceptsASingularCovariance) {
  StateMatrix certain = StateMatrix::Zero(4, 4);
  certain(0, 0) = 1.0;
  const StateMatrix updated = update_covariance(certain, PositionMatrix::Identity(2, 2));
  StateMatrix expected = certain;
  expected(0, 0) = 0.5;
  EXPECT_TRUE(test::is_near(updated, expected, 1e-15));
}

TEST(UpdateCovariance, IsExactlySymmetricAndNeverGrows) {
  test::Random random(23);
  for (const Shape& shape : kShapes) {
    for (int i = 0; i < 500; ++i) {
      const Gaussian belief = random_belief(random, shape.state);
      const Eigen::MatrixXd M = random_information(random, shape.position, 1);
      const Eigen::MatrixXd updated = update_covariance(belief.covariance, M);
      ASSERT_EQ(updated, updated.transpose());
      const Eigen::MatrixXd gain = belief.covariance - updated;
      ASSERT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gain).eigenvalues().minCoeff(),
                -1e-10);
    }
  }
}

// update() must give the mean and covariance of the information form: Ω + Hᵀ V⁻¹ H and ω + Hᵀ V⁻¹
// z̃.
TEST(Update, EqualsTheInformationForm) {
  test::Random random(24);
  for (const int n : {2, 3, 4}) {
    for (int i = 0; i < 2000; ++i) {
      const int z_dim = random.integer(1, 3);
      const Gaussian belief = random_belief(random, n);
      const Eigen::MatrixXd H =
          Eigen::MatrixXd::NullaryExpr(z_dim, n, [&] { return random.uniform(-2.0, 2.0); });
      const Eigen::MatrixXd V = random.spd(z_dim, 0.1);
      const Eigen::VectorXd innovation =
          Eigen::VectorXd::NullaryExpr(z_dim, [&] { return random.uniform(-1.0, 1.0); });
      const Eigen::MatrixXd Sigma = belief.covariance;
      const Eigen::MatrixXd Omega = Sigma.inverse() + H.transpose() * V.inverse() * H;
      const Eigen::VectorXd z_tilde = innovation + H * belief.mean;
      const Eigen::VectorXd omega =
          Sigma.inverse() * belief.mean + H.transpose() * V.inverse() * z_tilde;
      const Gaussian updated = update(belief, H, V, innovation);
      ASSERT_TRUE(test::is_near(updated.covariance, Omega.inverse(), 1e-9));
      ASSERT_TRUE(test::is_near(updated.mean, (Omega.inverse() * omega).eval(), 1e-8));
      ASSERT_EQ(updated.covariance, updated.covariance.transpose());
    }
  }
}

TEST(Update, IsEqualInFilterAndPlanner) {
  test::Random random(25);
  const SensorModel sensor;
  for (int i = 0; i < 1000; ++i) {
    const Gaussian belief = random_belief(random, 4);
    const Viewpoint from{random.pose2(5.0), 1.0};
    const PositionVector target = belief.mean.head(2);
    const PositionMatrix M = information(sensor, from, target);
    if (M.isZero(0.0)) {
      continue;
    }
    MeasurementJacobian H = MeasurementJacobian::Zero(2, 4);
    H.leftCols(2) = observation_jacobian(sensor, from, target);
    const Gaussian updated =
        update(belief, H, noise_covariance(sensor, from, target), MeasurementVector::Zero(2));
    ASSERT_TRUE(test::is_near(updated.covariance, update_covariance(belief.covariance, M), 1e-10));
  }
}

TEST(ToGaussian, InvertsToInformation) {
  test::Random random(26);
  for (const int n : {2, 3, 4}) {
    for (int i = 0; i < 500; ++i) {
      const Gaussian belief = random_belief(random, n);
      const std::optional<Information> information = to_information(belief);
      ASSERT_TRUE(information);
      const std::optional<Gaussian> back = to_gaussian(*information);
      ASSERT_TRUE(back);
      ASSERT_TRUE(test::is_near(back->mean, belief.mean, 1e-9));
      ASSERT_TRUE(test::is_near(back->covariance, belief.covariance, 1e-9));
    }
  }
}

TEST(ToGaussian, RefusesInvalidInformation) {
  const StateVector zero = StateVector::Zero(4);
  EXPECT_FALSE(to_gaussian({zero, StateMatrix::Zero(4, 4)}));
  StateMatrix rank_two = StateMatrix::Identity(4, 4);
  rank_two(2, 2) = rank_two(3, 3) = 0.0;
  EXPECT_FALSE(to_gaussian({zero, rank_two}));
  EXPECT_FALSE(to_gaussian({zero, -StateMatrix::Identity(4, 4)}));
  EXPECT_FALSE(to_gaussian({zero, StateMatrix::Constant(4, 4, std::nan(""))}));
  EXPECT_FALSE(to_information({zero, rank_two}));
}

TEST(Predict, PropagatesMeanAndCovariance) {
  test::Random random(27);
  for (const int n : {2, 3, 4}) {
    const Gaussian belief = random_belief(random, n);
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.normal(); });
    const Eigen::MatrixXd W = random.spd(n, 0.0);
    const Eigen::MatrixXd Sigma = belief.covariance;
    const Gaussian predicted = predict(belief, A, W);
    EXPECT_TRUE(test::is_near(predicted.mean, (A * belief.mean).eval(), 1e-12));
    EXPECT_TRUE(test::is_near(predicted.covariance, (A * Sigma * A.transpose() + W).eval(), 1e-12));
  }
}

TEST(Predict, EqualsTheInformationForm) {
  test::Random random(28);
  const TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.1};
  const StateMatrix A = model.transition(0.5);
  const StateMatrix W = model.process_noise(0.5);
  for (int i = 0; i < 500; ++i) {
    const Gaussian belief = random_belief(random, 4);
    const std::optional<Information> predicted = predict(*to_information(belief), A, W);
    ASSERT_TRUE(predicted);
    const Gaussian expected = predict(belief, A, W);
    const std::optional<Gaussian> back = to_gaussian(*predicted);
    ASSERT_TRUE(back);
    ASSERT_TRUE(test::is_near(back->covariance, expected.covariance, 1e-9));
    ASSERT_TRUE(test::is_near(back->mean, expected.mean, 1e-8));
  }
  EXPECT_FALSE(predict(Information{StateVector::Zero(4), StateMatrix::Zero(4, 4)}, A, W));
}

TEST(LogDet, IsTheLogarithmOfTheDeterminant) {
  test::Random random(29);
  for (const int n : {2, 3, 4}) {
    for (int i = 0; i < 500; ++i) {
      const Eigen::MatrixXd Sigma = random.spd(n, 0.05);
      ASSERT_NEAR(log_det(Sigma), std::log(Sigma.determinant()), 1e-9);
    }
  }
}

TEST(LogDet, IsFiniteWhenTheDeterminantOverflows) {
  const StateMatrix tiny = 1e-150 * StateMatrix::Identity(4, 4);
  EXPECT_NEAR(log_det(tiny), -600.0 * std::log(10.0), 1e-9);
}

TEST(LogDet, IsMinusInfinityForASingularCovariance) {
  EXPECT_EQ(log_det(StateMatrix::Zero(3, 3)), -INFINITY);
  EXPECT_EQ(log_det(-StateMatrix::Identity(2, 2)), -INFINITY);
}

TEST(Entropy, EqualsTheFormulaForAUnitGaussian) {
  const Gaussian unit{StateVector::Zero(1), StateMatrix::Identity(1, 1)};
  EXPECT_NEAR(entropy_nats(unit), 1.4189385332046727, 1e-15);  // ½ ln(2πe)
}

TEST(Entropy, DecreasesByTheMutualInformation) {
  const Gaussian belief{StateVector::Zero(2), StateMatrix::Identity(2, 2)};
  const Gaussian seen{belief.mean,
                      update_covariance(belief.covariance, 3.0 * PositionMatrix::Identity(2, 2))};
  EXPECT_NEAR(entropy_nats(belief) - entropy_nats(seen), 0.5 * std::log(16.0), 1e-14);
}

TEST(Belief, AllocatesNothing) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "allocations are not counted under a sanitizer";
  }
  test::Random random(30);
  const SensorModel sensor;
  for (const Shape& shape : kShapes) {
    const Gaussian belief = random_belief(random, shape.state);
    const PositionMatrix M = random_information(random, shape.position, 1);
    const StateMatrix A = StateMatrix::Identity(shape.state, shape.state);
    const StateMatrix W = 0.1 * A;
    const MeasurementJacobian H = MeasurementJacobian::Ones(2, shape.state);
    const MeasurementMatrix V = MeasurementMatrix::Identity(2, 2);
    const MeasurementVector innovation = MeasurementVector::Ones(2);
    const test::AllocationCounter allocations;
    const Gaussian predicted = predict(belief, A, W);
    const Gaussian updated = update(predicted, H, V, innovation);
    const StateMatrix covariance = update_covariance(updated.covariance, M);
    const std::optional<Information> information = to_information(updated);
    const std::optional<Information> next = predict(*information, A, W);
    const std::optional<Gaussian> back = to_gaussian(*next);
    const double sum = log_det(covariance) + entropy_nats(*back);
    EXPECT_EQ(allocations.count(), 0u);
    EXPECT_TRUE(std::isfinite(sum));
  }
}

// The prediction uses the model's transition matrix A and noise W. An oscillator's mean is
// predicted relative to its centre.
TEST(Predict, UsesTheTargetsModel) {
  TargetModel swings{TargetKind::kDampedOscillator, 2};
  swings.oscillator.center_m = {3.0, -2.0};
  const TargetModel models[] = {{TargetKind::kStatic, 2, 0.1},
                                {TargetKind::kRandomWalk, 3, 0.1},
                                {TargetKind::kDoubleIntegrator, 2, 0.1},
                                swings};
  test::Random random(31);
  for (const TargetModel& model : models) {
    const Gaussian belief = random_belief(random, model.dim());
    const Gaussian predicted = predict(belief, model, 0.7);
    const Gaussian expected = predict(belief, model.transition(0.7), model.process_noise(0.7));
    EXPECT_EQ(predicted.covariance, expected.covariance);
    EXPECT_TRUE(test::is_near(predicted.mean, model.expected(belief.mean, 0.7), 1e-12));
    // The time without observation has no effect on these models.
    const Gaussian unseen = predict_unseen(belief, model, 0.7, 5.0, 0.5);
    EXPECT_EQ(unseen.covariance, predicted.covariance);
    EXPECT_EQ(unseen.mean, predicted.mean);
  }
}

// The noise is q Σ j over the numbers j of the unseen steps. A prediction in two parts equals one
// prediction.
TEST(PredictUnseen, GrowsSinceTheLastObservation) {
  const TargetModel model{TargetKind::kGrowingUncertainty, 2, 0.3};
  test::Random random(32);
  const Gaussian belief = random_belief(random, 2);
  const Gaussian once = predict_unseen(belief, model, 2.0, 1.0, 0.5);  // unseen steps 2, 3, 4 and 5
  const double grown = 0.3 * (2.0 + 3.0 + 4.0 + 5.0);
  EXPECT_TRUE(test::is_near(
      once.covariance, (belief.covariance + grown * Eigen::Matrix2d::Identity()).eval(), 1e-12));
  EXPECT_EQ(once.mean, belief.mean);
  const Gaussian twice =
      predict_unseen(predict_unseen(belief, model, 0.6, 1.0, 0.5), model, 1.4, 1.6, 0.5);
  EXPECT_TRUE(test::is_near(twice.covariance, once.covariance, 1e-12));
}

}  // namespace
}  // namespace vantage::models
