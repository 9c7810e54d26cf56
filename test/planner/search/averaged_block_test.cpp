#include "planner/search/averaged_block.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "models/belief/gaussian.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/search/pointed_information.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::pick;
using test::random_spd;
using test::uniform;

// Returns the symmetries of a square. A quantity that is invariant under them is isotropic.
std::vector<Eigen::Matrix2d> symmetries() {
  std::vector<Eigen::Matrix2d> all;
  for (int turn = 0; turn < 4; ++turn) {
    Eigen::Matrix2d Q;
    const int c[] = {1, 0, -1, 0};
    const int s[] = {0, 1, 0, -1};
    Q << c[turn], -s[turn], s[turn], c[turn];
    all.push_back(Q);
    all.push_back(Q * Eigen::Vector2d(1.0, -1.0).asDiagonal());
  }
  return all;
}

// Averages the inverses of all rotated and mirrored versions of `covariance`; returns the inverse
// of the mean.
models::StateMatrix averaged_by_hand(const models::StateMatrix& covariance) {
  const Eigen::Index n = covariance.rows();
  const Eigen::MatrixXd Omega = Eigen::MatrixXd(covariance).inverse();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::Matrix2d& Q : symmetries()) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; i += 2) {
      all.block<2, 2>(i, i) = Q;
    }
    sum += all * Omega * all.transpose() / 8.0;
  }
  const Eigen::MatrixXd mean = sum.inverse();
  return 0.5 * (mean + mean.transpose());
}

models::TargetModel random_model(std::mt19937_64& rng, bool moves) {
  models::TargetModel model;
  model.q = uniform(rng, 0.0, 0.5);
  if (moves && pick(rng, 0, 1) == 0) {
    model.kind = models::TargetKind::kDampedOscillator;
    model.oscillator = test::random_oscillator(rng);
    // Both axes have the same A, but W differs by a factor.
    model.oscillator.damping_per_s.setConstant(model.oscillator.damping_per_s(0));
    model.oscillator.position_sigma_m(1) =
        (pick(rng, 0, 1) == 0 ? 2.0 : 0.5) * model.oscillator.position_sigma_m(0);
    model.oscillator.velocity_sigma_mps(1) = model.oscillator.position_sigma_m(1) /
                                             model.oscillator.position_sigma_m(0) *
                                             model.oscillator.velocity_sigma_mps(0);
  } else {
    model.kind = moves ? models::TargetKind::kDoubleIntegrator : models::TargetKind::kRandomWalk;
  }
  return model;
}

void expect_like(const AveragedBlock& block, const models::StateMatrix& covariance,
                 const char* what) {
  const double trace = covariance.trace();
  EXPECT_NEAR(block.trace(), trace, 1e-9 * trace) << what;
  EXPECT_NEAR(std::log(block.determinant()), models::log_det(covariance), 1e-8) << what;
}

// After each update, the block is the mean information over all rotations and reflections of the
// plane.
TEST(AveragedBlock, IsTheMeanOverAllPlanarSymmetries) {
  std::mt19937_64 rng(41);
  for (int i = 0; i < 300; ++i) {
    const bool moves = i % 3 != 0;
    const BlockLayout layout = moves ? BlockLayout::kMoving : BlockLayout::kPlanar;
    const models::TargetModel model = random_model(rng, moves);
    const double step_s = uniform(rng, 0.1, 1.5);
    const StepMotion motion = step_motion(model, step_s);
    ASSERT_TRUE(motion.is_isotropic());
    // The averaged block uses the axis with the smaller noise.
    models::TargetModel least = model;
    const Eigen::Index calm =
        model.oscillator.position_sigma_m(0) <= model.oscillator.position_sigma_m(1) ? 0 : 1;
    least.oscillator.position_sigma_m.setConstant(model.oscillator.position_sigma_m(calm));
    least.oscillator.velocity_sigma_mps.setConstant(model.oscillator.velocity_sigma_mps(calm));

    const models::StateMatrix prior = random_spd(rng, moves ? 4 : 2, uniform(rng, 0.1, 3.0), 1.5);
    double packed[kMaxPacked];
    pack(layout, prior, packed);
    AveragedBlock block(layout, packed);
    models::StateMatrix expected = averaged_by_hand(prior);
    expect_like(block, expected, "at first");
    for (int k = 0; k < 4; ++k) {
      block.predict(motion);
      const models::StateMatrix A = least.transition(step_s);
      expected = (A * expected * A.transpose() + least.process_noise(step_s)).eval();
      expect_like(block, expected, "predicted");
      const double strength = k == 2 ? 0.0 : std::pow(10.0, uniform(rng, -2.0, 2.0));
      block.update(strength);
      expected = models::update_covariance(expected, strength * Eigen::Matrix2d::Identity());
      expect_like(block, expected, "updated");
    }
  }
}

// The cost of the averaged block is at most that of the block, for measurements in any directions.
TEST(AveragedBlock, NeverCostsMoreThanTheBlock) {
  std::mt19937_64 rng(42);
  for (int i = 0; i < 300; ++i) {
    const bool moves = i % 3 != 0;
    const BlockLayout layout = moves ? BlockLayout::kMoving : BlockLayout::kPlanar;
    const models::TargetModel model = random_model(rng, moves);
    const StepMotion motion = step_motion(model, 0.5);
    const models::StateMatrix prior = random_spd(rng, moves ? 4 : 2, uniform(rng, 0.1, 3.0), 1.5);
    double truth[kMaxPacked];
    pack(layout, prior, truth);
    AveragedBlock block(layout, truth);
    for (int k = 0; k < 5; ++k) {
      const models::PositionMatrix M = random_spd(rng, 2, std::pow(10.0, uniform(rng, -1, 2)), 3.0);
      PackedInformation look;
      pack(BlockLayout::kPlanar, M, look.m);
      predict(layout, motion, truth, truth);
      update(layout, look.m, truth, truth);
      block.predict(motion);
      block.update(0.5 * M.trace());
      EXPECT_LE(block.trace(), trace(layout, truth) * (1.0 + 1e-9));
      EXPECT_LE(block.determinant(), determinant(layout, truth) * (1.0 + 1e-9));
    }
  }
}

Eigen::Matrix2d along(double angle_rad, double strength) {
  const Eigen::Vector2d u(std::cos(angle_rad), std::sin(angle_rad));
  return strength * u * u.transpose();
}

// Compares the result with the best of many directions of one or two measurements.
TEST(PointedInformation, EqualsInformationFromBestDirections) {
  std::mt19937_64 rng(43);
  int stretched = 0;
  int round = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix2d prior = random_spd(rng, 2, uniform(rng, 0.1, 3.0), 1.5);
    const double strength = std::pow(10.0, uniform(rng, -1.0, 1.5));
    const double all_round = pick(rng, 0, 1) == 0 ? 0.0 : uniform(rng, 0.0, 3.0);
    double packed[3];
    pack(BlockLayout::kPlanar, prior, packed);
    PointedInformation once(packed);
    EXPECT_NEAR(once.determinant(), 1.0 / prior.determinant(), 1e-9 / prior.determinant());
    EXPECT_NEAR(once.covariance_trace(), prior.trace(), 1e-9 * prior.trace());
    once.add({all_round, strength, 1});
    PointedInformation twice = once;
    twice.add({all_round, strength, 1});
    PointedInformation at_once(packed);  // two sensors that measure at the same time
    at_once.add({2.0 * all_round, 2.0 * strength, 2});

    const Eigen::Matrix2d before = prior.inverse() + all_round * Eigen::Matrix2d::Identity();
    double most_once = 0.0;
    double least_trace_once = 1e300;
    double most_twice = 0.0;
    double least_trace_twice = 1e300;
    constexpr int kAngles = 60;
    for (int a = 0; a < kAngles; ++a) {
      const Eigen::Matrix2d one = before + along(kPi * a / kAngles, strength);
      most_once = std::max(most_once, one.determinant());
      least_trace_once = std::min(least_trace_once, one.inverse().trace());
      for (int b = 0; b <= a; ++b) {
        const Eigen::Matrix2d both =
            one + all_round * Eigen::Matrix2d::Identity() + along(kPi * b / kAngles, strength);
        most_twice = std::max(most_twice, both.determinant());
        least_trace_twice = std::min(least_trace_twice, both.inverse().trace());
      }
    }
    // The result is at least that of the best tested direction. The tolerance covers the spacing of
    // the directions.
    EXPECT_GE(once.determinant(), most_once * (1.0 - 1e-9));
    EXPECT_LE(once.determinant(), most_once * 1.01);
    EXPECT_LE(once.covariance_trace(), least_trace_once * (1.0 + 1e-9));
    EXPECT_GE(once.covariance_trace(), least_trace_once * 0.99);
    EXPECT_GE(twice.determinant(), most_twice * (1.0 - 1e-9));
    EXPECT_LE(twice.determinant(), most_twice * 1.01);
    EXPECT_LE(twice.covariance_trace(), least_trace_twice * (1.0 + 1e-9));
    EXPECT_GE(twice.covariance_trace(), least_trace_twice * 0.99);
    EXPECT_NEAR(at_once.determinant() / twice.determinant(), 1.0, 1e-12);
    EXPECT_NEAR(at_once.covariance_trace() / twice.covariance_trace(), 1.0, 1e-12);
    const Eigen::Vector2d e = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(before).eigenvalues();
    (e(0) + all_round + 2.0 * strength <= e(1) + all_round ? stretched : round) += 1;
  }
  EXPECT_GT(stretched, 10);
  EXPECT_GT(round, 10);
}

TEST(ScanBound, CoversIsotropicAndDirectedInformation) {
  const LookBound look{3.0, 5.0, 2};
  EXPECT_EQ(look.strongest(), 8.0);
  EXPECT_EQ(look.average(), 5.5);
  EXPECT_EQ(LookBound{}.strongest(), 0.0);
}

}  // namespace
}  // namespace vantage::planner
