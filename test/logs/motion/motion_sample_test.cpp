// Compares moments and likelihoods of a motion fit with closed forms.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "logs/motion/motion_fit.hpp"
#include "models/target/target_model.hpp"
#include "test/support/random.hpp"

namespace vantage::logs {
namespace {

constexpr std::int64_t kStart = 17'000'000'000;  // a step number

Time instant(std::int64_t step) { return from_utime(100'000 * step); }

/// Returns a course that is at place(k) at step kStart + k, for k from `first` to `last`.
template <class Place>
TargetCourse course_of(int first, int last, const Place& place) {
  TargetCourse course;
  for (int k = first - 1; k <= last; ++k) {
    course.add(instant(kStart + k), place(k));
  }
  return course;
}

Eigen::Vector2d wobble(int k) { return {std::sin(0.3 * k) + 0.01 * k, 2.0 * std::cos(0.17 * k)}; }

TEST(TargetCourse, InterpolatesUpToAQuarterOfASecond) {
  for (const std::int64_t gap_us : {250'000, 250'001}) {
    TargetCourse course;
    course.add(from_utime(1'000'000), {0.0, 1.0});
    course.add(from_utime(1'000'000 + gap_us), {1.0, 3.0});
    course.add(from_utime(1'000'000 + gap_us), {9.0, 9.0});  // ignored: not later
    course.add(from_utime(900'000), {9.0, 9.0});
    ASSERT_EQ(course.positions_m().size(), gap_us == 250'000 ? 2U : 0U);
    if (gap_us == 250'000) {
      EXPECT_NEAR(course.positions_m().at(11).x(), 0.4, 1e-12);
      EXPECT_NEAR(course.positions_m().at(12).y(), 1.0 + 2.0 * 0.8, 1e-12);
    }
  }
  TargetCourse whole;  // samples at whole steps are kept exactly
  whole.add(from_utime(1'000'000), {5.0, 5.0});
  whole.add(from_utime(1'100'000), {6.0, 7.0});
  EXPECT_EQ(whole.positions_m(), (std::map<std::int64_t, Eigen::Vector2d>{{11, {6.0, 7.0}}}));
}

// The expected moments are sums over each instant of the selected part, computed from its position,
// the previous position and the position h later.
TEST(MotionSample, HasTheMomentsOfTheRequestedPart) {
  const TargetCourse course = course_of(0, 400, wobble);
  for (const auto& [from, to] : {std::pair{0.0, 1.0}, {0.0, 0.3}, {0.25, 0.75}, {0.7, 1.0}}) {
    MotionSample sample;
    sample.center_m = {0.5, -1.5};
    sample.add(course, kStart, kStart + 400, from, to);
    const int first = static_cast<int>(std::lround(400 * from));
    const int last = static_cast<int>(std::lround(400 * to));
    for (std::size_t h = 0; h < kHorizons_s.size(); ++h) {
      const int ahead = static_cast<int>(std::lround(10.0 * kHorizons_s[h]));
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        std::int64_t samples = 0;
        for (int k = first + 1; k + ahead <= last; ++k) {
          const double velocity_mps = (wobble(k)(axis) - wobble(k - 1)(axis)) / 0.1;
          const Eigen::Vector3d each(wobble(k + ahead)(axis) - sample.center_m(axis),
                                     wobble(k)(axis) - sample.center_m(axis), velocity_mps);
          sum += each * each.transpose();
          ++samples;
        }
        const MotionMoments& found = sample.moments[static_cast<std::size_t>(axis)][h];
        EXPECT_EQ(found.samples, samples);
        EXPECT_LT((found.sum - sum).norm(), 1e-6 * (1.0 + sum.norm())) << h << " " << axis;
      }
    }
  }
}

TEST(MotionSample, ExcludesGaps) {
  TargetCourse course;
  for (int k = 0; k <= 100; ++k) {
    if (k != 40 && k != 41 && k != 42) {
      course.add(instant(kStart + k), wobble(k));
    }
  }
  // Steps 1 to 39 and 44 to 100 are known; a velocity needs the previous step.
  MotionSample sample;
  sample.add(course, kStart, kStart + 100, 0.0, 1.0);
  const auto expected = [](int ahead) {
    std::int64_t samples = 0;
    const auto is_known = [](int k) { return (k >= 1 && k <= 39) || (k >= 44 && k <= 100); };
    for (int k = 1; k <= 100; ++k) {
      samples += is_known(k) && is_known(k - 1) && is_known(k + ahead) ? 1 : 0;
    }
    return samples;
  };
  for (std::size_t h = 0; h < kHorizons_s.size(); ++h) {
    EXPECT_EQ(sample.moments[0][h].samples,
              expected(static_cast<int>(std::lround(10.0 * kHorizons_s[h]))));
  }
}

/// Returns a sample of one position, one velocity and one later position, the same at every
/// horizon.
MotionSample one_of_each(const Eigen::Vector2d& later, const Eigen::Vector2d& now,
                         const Eigen::Vector2d& velocity) {
  MotionSample out;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const Eigen::Vector3d each(later(i), now(i), velocity(i));
    for (MotionMoments& moments : out.moments[axis]) {
      moments.sum = 3.0 * each * each.transpose();
      moments.samples = 3;
    }
  }
  return out;
}

TEST(JudgeMotionModel, ReturnsTheLikelihood) {
  const Eigen::Vector2d later(1.5, -0.75);
  const Eigen::Vector2d now(0.5, 0.25);
  const Eigen::Vector2d velocity(0.25, -0.5);
  const MotionSample sample = one_of_each(later, now, velocity);
  constexpr double kQ = 0.4;
  for (const models::TargetKind kind :
       {models::TargetKind::kRandomWalk, models::TargetKind::kDoubleIntegrator}) {
    const bool has_velocity = kind == models::TargetKind::kDoubleIntegrator;
    const MotionScore score = judge({kind, 2, kQ}, sample);
    double nats = 0.0;
    for (std::size_t h = 0; h < kHorizons_s.size(); ++h) {
      const double ahead_s = kHorizons_s[h];
      const double variance = has_velocity ? kQ * std::pow(ahead_s, 3) / 3.0 : kQ * ahead_s;
      double nees = 0.0;
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        const double distance_m = has_velocity ? ahead_s * velocity(axis) : 0.0;
        const double error_m = later(axis) - now(axis) - distance_m;
        nees += error_m * error_m / variance;
        nats -= 0.5 * (std::log(2.0 * kPi * variance) + error_m * error_m / variance) / 5.0;
        const Displacement& each = score.displacements[static_cast<std::size_t>(axis)][h];
        EXPECT_NEAR(each.observed_m2, std::pow(later(axis) - now(axis), 2), 1e-12);
        EXPECT_NEAR(each.predicted_m2, distance_m * distance_m + variance, 1e-9);
      }
      EXPECT_NEAR(score.nees[h], nees, 1e-9);
    }
    EXPECT_NEAR(score.nats, nats, 1e-9);
    // The most likely q gives a mean NEES of two.
    double mean_nees = 0.0;
    for (const double each : score.nees) {
      mean_nees += each / 5.0;
    }
    const models::TargetModel fitted = fit_free(kind, sample);
    EXPECT_EQ(fitted.kind, kind);
    EXPECT_NEAR(fitted.q, kQ * mean_nees / 2.0, 1e-9);
  }
  EXPECT_EQ(MotionMoments{}.mean_square({1.0, 1.0, 1.0}), 0.0) << "without samples";
}

/// Returns the stationary moments of targets that move by `model`.
MotionSample in_the_long_run(const models::TargetModel& model) {
  MotionSample out;
  out.center_m = model.oscillator.center_m;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const double place_m2 = std::pow(model.oscillator.position_sigma_m(axis), 2);
    const double velocity_m2 = std::pow(model.oscillator.velocity_sigma_mps(axis), 2);
    for (std::size_t h = 0; h < kHorizons_s.size(); ++h) {
      const models::StateMatrix A = model.transition(kHorizons_s[h]);
      const models::StateMatrix W = model.process_noise(kHorizons_s[h]);
      const double a = A(axis, axis);
      const double b = A(axis, axis + 2);
      MotionMoments& moments = out.moments[static_cast<std::size_t>(axis)][h];
      moments.samples = 1'000;
      moments.sum << a * a * place_m2 + b * b * velocity_m2 + W(axis, axis), a * place_m2,
          b * velocity_m2, a * place_m2, place_m2, 0.0, b * velocity_m2, 0.0, velocity_m2;
      moments.sum *= 1'000.0;
    }
  }
  return out;
}

// With an infinite sample the most likely oscillator is the true one, in each coordinate.
TEST(FitOscillator, IsExactForAnInfiniteSample) {
  test::Random random(2);
  for (int trial = 0; trial < 10; ++trial) {
    models::TargetModel model{models::TargetKind::kDampedOscillator};
    model.oscillator.center_m = random.vector<2>(-3.0, 3.0);
    model.oscillator.position_sigma_m = random.vector<2>(0.5, 2.5);
    model.oscillator.velocity_sigma_mps = random.vector<2>(0.2, 0.6);
    model.oscillator.damping_per_s = random.vector<2>(0.2, 1.5);
    const models::TargetModel fitted = fit_oscillator(in_the_long_run(model));
    EXPECT_EQ(fitted.kind, models::TargetKind::kDampedOscillator);
    EXPECT_EQ(fitted.oscillator.center_m, model.oscillator.center_m);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const auto& found = fitted.oscillator;
      const auto& wanted = model.oscillator;
      EXPECT_NEAR(found.position_sigma_m(axis) / wanted.position_sigma_m(axis), 1.0, 1e-3);
      EXPECT_NEAR(found.velocity_sigma_mps(axis) / wanted.velocity_sigma_mps(axis), 1.0, 1e-3);
      EXPECT_NEAR(found.damping_per_s(axis) / wanted.damping_per_s(axis), 1.0, 1e-3);
    }
  }
}

std::string why_not(const std::vector<std::vector<TargetCourse>>& logs, double fitted_share) {
  try {
    static_cast<void>(fit_motion(logs, {0.0, 0.0}, fitted_share));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

// 80 steps are predicted, so each part needs 81 steps after its first one.
TEST(FitMotion, RequiresEightSecondsOfEachPart) {
  const auto logs = [](int steps) {
    return std::vector<std::vector<TargetCourse>>{{course_of(0, steps, wobble)}};
  };
  EXPECT_EQ(why_not(logs(268), 0.7),
            "fit-motion: too few target positions; the part of the log used for the fit and the "
            "rest must each be longer than 8 s");
  EXPECT_EQ(why_not(logs(269), 0.7), "") << "81 steps are held out";
  EXPECT_NE(why_not(logs(268), 0.3), "");
  EXPECT_EQ(why_not(logs(269), 0.3), "");
  EXPECT_NE(why_not({}, 0.7), "");
  EXPECT_NE(why_not({{TargetCourse()}}, 0.7), "");
}

// The time of a log runs from the first to the last position of any target. It is separate for each
// log.
TEST(FitMotion, SplitsTheLogByTime) {
  const auto slow = [](int k) { return Eigen::Vector2d(0.1 * wobble(k)); };
  const TargetCourse early = course_of(1, 150, slow);
  const TargetCourse late = course_of(251, 400, wobble);
  const std::vector<TargetCourse> log{late, TargetCourse(), early};
  const Eigen::Vector2d center_m(0.25, -0.5);
  MotionSample fitted;
  MotionSample held_back;
  fitted.center_m = held_back.center_m = center_m;
  fitted.add(early, kStart, kStart + 150, 0.0, 1.0);
  held_back.add(late, kStart + 250, kStart + 400, 0.0, 1.0);
  for (const std::size_t copies : {1U, 2U}) {
    const std::vector<std::vector<TargetCourse>> logs(copies, log);
    const auto fits = fit_motion(logs, center_m, 0.5);
    ASSERT_EQ(fits.size(), 3U);
    const models::TargetKind kinds[] = {models::TargetKind::kRandomWalk,
                                        models::TargetKind::kDoubleIntegrator,
                                        models::TargetKind::kDampedOscillator};
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(fits[i].model.kind, kinds[i]);
      EXPECT_NEAR(fits[i].fitted.nats, judge(fits[i].model, fitted).nats, 1e-9);
      EXPECT_NEAR(fits[i].held_back.nats, judge(fits[i].model, held_back).nats, 1e-6);
    }
    EXPECT_NEAR(fits[0].model.q, fit_free(kinds[0], fitted).q, 1e-12);
    EXPECT_NEAR(fits[1].model.q, fit_free(kinds[1], fitted).q, 1e-12);
  }
}

}  // namespace
}  // namespace vantage::logs
