#include "logs/motion/motion_fit.hpp"

#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/check.hpp"
#include "models/target/target_model.hpp"

namespace vantage::logs {
namespace {

Time instant(double seconds) { return from_utime(1'700'000'000'000'000) + from_seconds(seconds); }

// Simulates a target that moves by `model` and is observed every 20 ms.
TargetCourse course_of(const models::TargetModel& model, const models::StateVector& start,
                       double duration_s, std::mt19937_64& rng) {
  constexpr double kFrame_s = 0.02;
  const models::StateMatrix W = model.process_noise(kFrame_s);
  const Eigen::MatrixXd root = Eigen::MatrixXd(W).llt().matrixL();
  std::normal_distribution<double> normal;
  models::StateVector y = start;
  TargetCourse course;
  for (int k = 0; k * kFrame_s <= duration_s; ++k) {
    course.add(instant(k * kFrame_s), y.head<2>());
    Eigen::VectorXd w(y.size());
    for (Eigen::Index i = 0; i < w.size(); ++i) {
      w(i) = normal(rng);
    }
    y = (model.expected(y, kFrame_s) + root * w).eval();
  }
  return course;
}

models::TargetModel oscillator() {
  models::TargetModel model{models::TargetKind::kDampedOscillator};
  model.oscillator.center_m = {1.0, -2.0};
  model.oscillator.position_sigma_m = {1.8, 0.8};
  model.oscillator.velocity_sigma_mps = {0.4, 0.25};
  model.oscillator.damping_per_s = {0.3, 0.6};
  return model;
}

std::vector<std::vector<TargetCourse>> many(const models::TargetModel& model, int count,
                                            std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::vector<std::vector<TargetCourse>> logs(1);
  models::StateVector start = models::StateVector::Zero(model.dim());
  start.head<2>() = model.oscillator.center_m;
  for (int i = 0; i < count; ++i) {
    logs.front().push_back(course_of(model, start, 300.0, rng));
  }
  return logs;
}

TEST(TargetCourse, InterpolatesLinearly) {
  TargetCourse course;
  for (const double at_s : {0.0, 0.07, 0.21}) {
    course.add(instant(at_s), {at_s, 2.0 * at_s});
  }
  ASSERT_EQ(course.positions_m().size(), 2U);
  EXPECT_NEAR(course.positions_m().begin()->second.x(), 0.1, 1e-12);
  EXPECT_NEAR(course.positions_m().rbegin()->second.y(), 0.4, 1e-12);
}

TEST(TargetCourse, DoesNotInterpolateGaps) {
  TargetCourse course;
  for (const double at_s : {0.0, 0.1, 1.0, 1.1, 1.05}) {
    course.add(instant(at_s), {at_s, 0.0});
  }
  EXPECT_EQ(course.positions_m().size(), 2U);  // at 0.1 s and 1.1 s
}

TEST(FitMotion, FindsTheTrueOscillator) {
  const auto logs = many(oscillator(), 40, 7);
  const std::vector<FittedMotion> fits = fit_motion(logs, oscillator().oscillator.center_m);
  ASSERT_EQ(fits.size(), 3U);
  const models::DampedOscillator& found = fits[2].model.oscillator;
  const models::DampedOscillator& true_one = oscillator().oscillator;
  for (Eigen::Index i = 0; i < 2; ++i) {
    EXPECT_NEAR(found.position_sigma_m(i) / true_one.position_sigma_m(i), 1.0, 0.1);
    EXPECT_NEAR(found.velocity_sigma_mps(i) / true_one.velocity_sigma_mps(i), 1.0, 0.1);
    EXPECT_NEAR(found.damping_per_s(i) / true_one.damping_per_s(i), 1.0, 0.3);
  }
  EXPECT_GT(fits[2].held_back.nats, fits[0].held_back.nats + 0.1);
  EXPECT_GT(fits[2].held_back.nats, fits[1].held_back.nats + 0.1);
  for (const double nees : fits[2].held_back.nees) {
    EXPECT_NEAR(nees, 2.0, 0.4);
  }
  // An oscillator model predicts the reversal of a target; a double integrator does not.
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const Displacement& oscillates = fits[2].held_back.displacements[axis].back();
    const Displacement& goes_on = fits[1].held_back.displacements[axis].back();
    EXPECT_NEAR(oscillates.predicted_m2 / oscillates.observed_m2, 1.0, 0.25);
    EXPECT_GT(goes_on.predicted_m2, 2.0 * goes_on.observed_m2);
  }
}

TEST(FitMotion, FindsTheNoiseDensityOfARandomWalk) {
  const models::TargetModel walk{models::TargetKind::kRandomWalk, 2, 0.3};
  const std::vector<FittedMotion> fits = fit_motion(many(walk, 40, 8), {0.0, 0.0});
  EXPECT_NEAR(fits[0].model.q, 0.3, 0.03);
  for (const auto& of_coordinate : fits[0].held_back.displacements) {
    for (std::size_t h = 0; h < kHorizons_s.size(); ++h) {
      EXPECT_NEAR(of_coordinate[h].predicted_m2, fits[0].model.q * kHorizons_s[h], 1e-12);
      EXPECT_NEAR(of_coordinate[h].observed_m2, 0.3 * kHorizons_s[h], 0.075 * kHorizons_s[h]);
    }
  }
  for (const double nees : fits[0].held_back.nees) {
    EXPECT_NEAR(nees, 2.0, 0.3);
  }
}

TEST(FitMotion, RefusesShortRecordings) {
  std::mt19937_64 rng(1);
  const models::TargetModel walk{models::TargetKind::kRandomWalk, 2, 0.3};
  const std::vector<std::vector<TargetCourse>> logs = {
      {course_of(walk, models::StateVector::Zero(2), 20.0, rng)}};
  EXPECT_THROW(static_cast<void>(fit_motion(logs, {0.0, 0.0})), UsageError);
}

}  // namespace
}  // namespace vantage::logs
