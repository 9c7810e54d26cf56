#include "sim/world/linear_targets.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage::sim {
namespace {

constexpr double kStep_s = 0.5;
const models::Rectangle kBounds{{0.0, 0.0}, {10.0, 10.0}};

models::TargetModel double_integrator(double q_m2ps3) {
  return {models::TargetKind::kDoubleIntegrator, 2, q_m2ps3};
}

TEST(LinearTargets, MoveStraightAndReflectAtWalls) {
  const models::StateVector start = Eigen::Vector4d(9.0, 5.0, 1.0, -0.5);
  LinearTargets targets(double_integrator(0.0), kStep_s, kBounds, {start}, std::mt19937_64(1));
  for (int step = 0; step < 4; ++step) {
    targets.move();
  }
  EXPECT_LT((targets.states()[0] - Eigen::Vector4d(9.0, 4.0, -1.0, -0.5)).norm(), 1e-12);
}

TEST(LinearTargets, HaveModelCovariance) {
  constexpr int kTargets = 4'000;
  constexpr double kSteps = 8.0;
  const models::TargetModel model = double_integrator(0.001);
  const models::StateVector start = Eigen::Vector4d(5.0, 5.0, 0.0, 0.0);
  LinearTargets targets(model, kStep_s, kBounds, std::vector(kTargets, start), std::mt19937_64(2));
  for (int step = 0; step < static_cast<int>(kSteps); ++step) {
    targets.move();
  }
  models::StateMatrix sample = models::StateMatrix::Zero(4, 4);
  for (const models::StateVector& state : targets.states()) {
    sample += (state - start) * (state - start).transpose() / kTargets;
  }
  // With this number of samples, the standard deviation of a variance is 2.2 %.
  const models::StateMatrix expected = model.process_noise(kSteps * kStep_s);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(sample(i, i) / expected(i, i), 1.0, 0.1);
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(sample(i, j) / scale, expected(i, j) / scale, 0.1);
    }
  }
}

TEST(LinearTargets, NeverLeaveTheWorld) {
  const models::StateVector start = Eigen::Vector4d(1.0, 9.0, -0.5, 0.5);
  LinearTargets targets(double_integrator(0.1), kStep_s, kBounds, {start, start},
                        std::mt19937_64(3));
  for (int step = 0; step < 200; ++step) {
    targets.move();
    for (const models::StateVector& state : targets.states()) {
      EXPECT_TRUE(kBounds.contains(state.head<2>())) << state.transpose();
    }
  }
  EXPECT_NE(targets.states()[0], targets.states()[1]) << "separate noise for each target";
}

TEST(LinearTargets, RefuseAModelWithoutVelocities) {
  EXPECT_THROW(LinearTargets({models::TargetKind::kStatic, 2, 0.0}, kStep_s, kBounds, {},
                             std::mt19937_64(1)),
               UsageError);
}

}  // namespace
}  // namespace vantage::sim
