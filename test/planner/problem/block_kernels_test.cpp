#include "planner/problem/block_kernels.hpp"

#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "models/belief/gaussian.hpp"
#include "planner/problem/belief_table.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/support/near.hpp"
#include "test/support/own_target.hpp"

namespace vantage::planner {
namespace {

using test::is_near;
using test::pick;
using test::random_spd;
using test::uniform;

constexpr BlockLayout kLayouts[] = {BlockLayout::kPlanar, BlockLayout::kSpatial,
                                    BlockLayout::kMoving};

int state_dim(BlockLayout layout) {
  return layout == BlockLayout::kPlanar ? 2 : layout == BlockLayout::kSpatial ? 3 : 4;
}
int position_dim(BlockLayout layout) { return layout == BlockLayout::kSpatial ? 3 : 2; }
BlockLayout position_layout(BlockLayout layout) {
  return layout == BlockLayout::kSpatial ? BlockLayout::kSpatial : BlockLayout::kPlanar;
}

// Returns random information of rank 0 to p, with 10^-2 to 10^most in each rank.
models::PositionMatrix random_information(std::mt19937_64& rng, int p, double most = 2.0) {
  models::PositionMatrix M = models::PositionMatrix::Zero(p, p);
  const int rank = pick(rng, 0, p);
  for (int i = 0; i < rank; ++i) {
    Eigen::VectorXd h(p);
    for (int j = 0; j < p; ++j) {
      h(j) = uniform(rng, -1.0, 1.0);
    }
    M += std::pow(10.0, uniform(rng, -2.0, most)) * h * h.transpose();
  }
  return M;
}

struct Case {
  BlockLayout layout;
  models::StateMatrix covariance;
  models::PositionMatrix information;
  double block[kMaxPacked];
  PackedInformation packed_information;
};

template <class Check>
void for_random_blocks(const Check& check) {
  std::mt19937_64 rng(20);
  for (const BlockLayout layout : kLayouts) {
    for (int i = 0; i < 400; ++i) {
      Case c{layout,
             random_spd(rng, state_dim(layout), uniform(rng, 0.01, 10.0), 2.0),
             random_information(rng, position_dim(layout)),
             {},
             {}};
      pack(layout, c.covariance, c.block);
      pack(position_layout(layout), c.information, c.packed_information.m);
      check(c, rng);
    }
  }
}

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(b), 1e-300); }

TEST(BlockKernels, UnpackInvertsPack) {
  for_random_blocks([](const Case& c, std::mt19937_64&) {
    EXPECT_TRUE(is_near(unpack(c.layout, c.block), c.covariance, 0.0));
  });
}

TEST(BlockKernels, AddInformationAboutTheStateLikeMatrixInversion) {
  std::mt19937_64 rng(23);
  for (int i = 0; i < 400; ++i) {
    const Eigen::Matrix4d S = random_spd(rng, 4, uniform(rng, 0.01, 10.0), 2.0);
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    for (int rank = pick(rng, 0, 3); rank > 0; --rank) {
      const Eigen::Vector4d h(uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0),
                              uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0));
      M += std::pow(10.0, uniform(rng, -2.0, 2.0)) * h * h.transpose();
    }
    double block[kMaxPacked];
    PackedInformation information;
    information.is_of_state = true;
    pack(BlockLayout::kMoving, models::StateMatrix(S), block);
    pack(BlockLayout::kMoving, models::StateMatrix(M), information.m);
    const Eigen::Matrix4d expected = (S.inverse() + M).inverse();
    double after[kMaxPacked];
    update(BlockLayout::kMoving, information, block, after);
    EXPECT_TRUE(is_near(unpack(BlockLayout::kMoving, after), expected, 1e-8 * S.norm()));
    const double gained = (Eigen::Matrix4d::Identity() + M * S).determinant();
    EXPECT_NEAR(gain(BlockLayout::kMoving, information, block) / gained, 1.0, 1e-9);
    EXPECT_NEAR(trace_reduction(BlockLayout::kMoving, information, block),
                S.trace() - expected.trace(), 1e-8 * S.trace());
    update(BlockLayout::kMoving, information, block, block);  // in place
    EXPECT_TRUE(is_near(unpack(BlockLayout::kMoving, block), expected, 1e-8 * S.norm()));
  }
}

TEST(BlockKernels, PredictLikeTheModels) {
  for_random_blocks([](const Case& c, std::mt19937_64& rng) {
    models::TargetModel model;
    model.kind = c.layout != BlockLayout::kMoving ? models::TargetKind::kRandomWalk
                 : pick(rng, 0, 2) == 0           ? models::TargetKind::kDoubleIntegrator
                 : pick(rng, 0, 1) == 0           ? models::TargetKind::kDampedOscillator
                                                  : test::drag();
    model.oscillator = test::random_oscillator(rng);
    model.position_dim = position_dim(c.layout);
    model.q = uniform(rng, 0.0, 1.0);
    const double step_s = uniform(rng, 0.1, 2.0);
    const models::StateMatrix A = model.transition(step_s);
    const models::StateMatrix W = model.process_noise(step_s);
    const models::StateMatrix expected =
        models::predict(models::Gaussian{models::StateVector::Zero(model.dim()), c.covariance}, A,
                        W)
            .covariance;
    const StepMotion motion = step_motion(model, step_s);
    double out[kMaxPacked];
    predict(c.layout, motion, c.block, out);
    EXPECT_TRUE(is_near(unpack(c.layout, out), expected, 1e-12 * expected.norm()));
    double in_place[kMaxPacked];
    std::copy_n(c.block, kMaxPacked, in_place);
    predict(c.layout, motion, in_place, in_place);
    EXPECT_TRUE(is_near(unpack(c.layout, in_place), unpack(c.layout, out), 0.0));
  });
}

// Blocks of targets are contiguous in memory, so a kernel must not write beyond its block.
TEST(BlockKernels, WriteOnlyTheirOwnBlock) {
  for_random_blocks([](const Case& c, std::mt19937_64&) {
    constexpr double kUntouched = -12345.0;
    double out[2 * kMaxPacked];
    const auto expect_own = [&](const char* what) {
      for (int i = packed_size(c.layout); i < 2 * kMaxPacked; ++i) {
        EXPECT_EQ(out[i], kUntouched) << what << ", number " << i;
      }
    };
    models::TargetModel model;
    model.kind = c.layout == BlockLayout::kMoving ? models::TargetKind::kDoubleIntegrator
                                                  : models::TargetKind::kRandomWalk;
    model.position_dim = position_dim(c.layout);
    std::fill_n(out, 2 * kMaxPacked, kUntouched);
    predict(c.layout, step_motion(model, 0.5), c.block, out);
    expect_own("predict");
    std::fill_n(out, 2 * kMaxPacked, kUntouched);
    update(c.layout, c.packed_information.m, c.block, out);
    expect_own("update");
    std::fill_n(out, 2 * kMaxPacked, kUntouched);
    pack(c.layout, c.covariance, out);
    expect_own("pack");
  });
}

TEST(BlockKernels, UpdateLikeTheModels) {
  for_random_blocks([](const Case& c, std::mt19937_64&) {
    const models::StateMatrix expected = models::update_covariance(c.covariance, c.information);
    double out[kMaxPacked];
    update(c.layout, c.packed_information.m, c.block, out);
    EXPECT_TRUE(is_near(unpack(c.layout, out), expected, 1e-9 * expected.norm()));
    double in_place[kMaxPacked];
    std::copy_n(c.block, kMaxPacked, in_place);
    update(c.layout, c.packed_information.m, in_place, in_place);
    EXPECT_TRUE(is_near(unpack(c.layout, in_place), unpack(c.layout, out), 0.0));
  });
}

TEST(BlockKernels, MeasureLikeTheModels) {
  for_random_blocks([](const Case& c, std::mt19937_64&) {
    EXPECT_NEAR(std::log(determinant(c.layout, c.block)), models::log_det(c.covariance), 1e-9);
    EXPECT_LT(relative(trace(c.layout, c.block), c.covariance.trace()), 1e-14);
  });
}

// These identities give the cost of a child node without its covariance.
TEST(BlockKernels, ComputeCostWithoutUpdate) {
  for_random_blocks([](const Case& c, std::mt19937_64&) {
    const models::StateMatrix after = models::update_covariance(c.covariance, c.information);
    const double log_gain = std::log(gain(c.layout, c.packed_information.m, c.block));
    const double expected = models::log_det(c.covariance) - models::log_det(after);
    EXPECT_NEAR(log_gain, expected, 1e-9 * std::max(1.0, expected));
    EXPECT_NEAR(trace_reduction(c.layout, c.packed_information.m, c.block),
                c.covariance.trace() - after.trace(), 1e-9 * c.covariance.trace());
  });
}

// If the information greatly exceeds that of the prior, as from a near camera, the result must
// equal (Σ⁻¹ + M)⁻¹ in long double.
TEST(BlockKernels, StayExactForSharpestMeasurements) {
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  std::mt19937_64 rng(24);
  for (const BlockLayout layout : kLayouts) {
    const int n = state_dim(layout);
    const int p = position_dim(layout);
    for (int i = 0; i < 300; ++i) {
      const models::StateMatrix covariance = random_spd(rng, n, 2.0, 1.0);
      const models::PositionMatrix M = random_information(rng, p, 6.0);
      double block[kMaxPacked];
      PackedInformation packed;
      pack(layout, covariance, block);
      pack(position_layout(layout), M, packed.m);
      const Long Sigma = covariance.cast<long double>();
      Long Omega = Sigma.inverse();
      Omega.topLeftCorner(p, p) += M.cast<long double>();
      const Long after = Omega.inverse();
      double out[kMaxPacked];
      update(layout, packed.m, block, out);
      const Eigen::MatrixXd expected = after.cast<double>();
      EXPECT_TRUE(is_near(unpack(layout, out), expected, 1e-9 * covariance.norm()));
      const double log_det_after = static_cast<double>(std::log(after.determinant()));
      EXPECT_NEAR(std::log(determinant(layout, out)), log_det_after, 1e-6);
      EXPECT_NEAR(std::log(gain(layout, packed.m, block)),
                  static_cast<double>(std::log(Sigma.determinant())) - log_det_after, 1e-7);
    }
  }
}

double least_eigenvalue(const models::StateMatrix& a, double epsilon,
                        const models::StateMatrix& b) {
  const Eigen::MatrixXd difference =
      a + epsilon * models::StateMatrix::Identity(a.rows(), a.cols()) - b;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(difference).eigenvalues()(0);
}

TEST(Dominates, IsFalseForAnIndefiniteDifference) {
  std::mt19937_64 rng(21);
  int said_true = 0;
  int said_false = 0;
  for (const BlockLayout layout : kLayouts) {
    const int n = state_dim(layout);
    for (int i = 0; i < 4000; ++i) {
      const models::StateMatrix b = random_spd(rng, n, 1.0, 1.0);
      // Draws differences that are singular up to rounding, with either sign.
      const Eigen::MatrixXd Q = random_spd(rng, n, 1.0, 0.5);
      const double size = std::pow(10.0, uniform(rng, -15.0, 0.0));
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> frame(Q);
      Eigen::VectorXd eigenvalues = Eigen::VectorXd::Zero(n);
      for (int j = 0; j < n; ++j) {
        eigenvalues(j) = size * uniform(rng, 0.0, 1.0);
      }
      eigenvalues(0) *= pick(rng, -1, 1);
      const Eigen::MatrixXd D =
          frame.eigenvectors() * eigenvalues.asDiagonal() * frame.eigenvectors().transpose();
      const models::StateMatrix a = b + 0.5 * (D + D.transpose());
      const double epsilon = pick(rng, 0, 1) == 0 ? 0.0 : uniform(rng, 0.0, size);
      double packed_a[kMaxPacked];
      double packed_b[kMaxPacked];
      pack(layout, a, packed_a);
      pack(layout, b, packed_b);
      const double scale = a.norm() + b.norm() + epsilon;
      const double least = least_eigenvalue(a, epsilon, b);
      if (dominates(layout, packed_a, epsilon, packed_b)) {
        ++said_true;
        EXPECT_GE(least, -1e-12 * scale);
      } else {
        ++said_false;
        EXPECT_LE(least, 1e-12 * scale) << "too conservative";
      }
    }
  }
  EXPECT_GT(said_true, 1000);
  EXPECT_GT(said_false, 1000);
}

TEST(Dominates, IsTrueInBothDirectionsForEqualBlocks) {
  for_random_blocks([](const Case& c, std::mt19937_64&) {
    EXPECT_TRUE(dominates(c.layout, c.block, 0.0, c.block));
  });
}

TEST(Dominates, IsFalseIfOnlyTheDiagonalIsLarger) {
  // [2 1.9; 1.9 2] has a larger diagonal than I but does not dominate it.
  const double a[] = {2.0, 1.9, 2.0};
  const double b[] = {1.0, 0.0, 1.0};
  EXPECT_FALSE(dominates(BlockLayout::kPlanar, a, 0.0, b));
  EXPECT_TRUE(dominates(BlockLayout::kPlanar, a, 0.91, b));
}

}  // namespace
}  // namespace vantage::planner
