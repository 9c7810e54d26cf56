#include "estimator/tracks/samples/samples.hpp"

#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "estimator/posterior/confinement.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/tracks/samples/field_filter.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace)
using test::beside;
using test::field_sensor;
using test::kField;
using test::kModel;
using test::kNearACorner;
using test::knows;
using test::look_of;
using test::moving;
using vantage::test::is_near;

Samples samples_of(const Gaussian& belief) {
  Samples samples;
  samples.spread(belief);
  return samples;
}

/// Reflects a state at the walls of kField, as targets do.
void turn_back(Eigen::Vector4d& x) {
  for (const Eigen::Index axis : {0, 1}) {
    if (std::abs(x(axis)) > 32.0) {
      x(axis) = std::copysign(64.0, x(axis)) - x(axis);
      x(axis + 2) = -x(axis + 2);
    }
  }
}

/// Draws `draws` states from `belief` and calls `happens` for each, which may change the state and
/// returns its weight. Returns the mean and covariance of the results.
template <class Happens>
Gaussian drawn(const Gaussian& belief, int draws, const Happens& happens) {
  std::mt19937_64 rng(7);
  const Eigen::Matrix4d L = Eigen::LLT<Eigen::Matrix4d>(belief.covariance).matrixL();
  double weight = 0.0;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
  for (int i = 0; i < draws; ++i) {
    Eigen::Vector4d x = Eigen::Vector4d(belief.mean) + L * test::normal_vector(4, rng);
    const double weighs = happens(x);
    weight += weighs;
    sum += weighs * x;
    squares += weighs * x * x.transpose();
  }
  const Eigen::Vector4d mean = sum / weight;
  return {mean, squares / weight - mean * mean.transpose()};
}

/// Expects a mean error below `mean_sigma`, in σ of `right`, and a relative covariance error below
/// `share`.
void expect_near(const Gaussian& made, const Gaussian& right, double mean_sigma, double share) {
  const Eigen::LLT<Eigen::Matrix4d> root(right.covariance);
  EXPECT_LT(root.matrixL().solve(made.mean - right.mean).norm(), mean_sigma);
  const Eigen::Matrix4d half = root.matrixL().solve(Eigen::Matrix4d(made.covariance));
  const Eigen::Matrix4d white = root.matrixL().solve(half.transpose().eval());
  EXPECT_LT((white - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff(), share);
}

TEST(Samples, HaveTheGivenMoments) {
  const Gaussian belief = moving({3.0, -4.0}, {0.2, -0.1}, 1.5, 0.4);
  const Gaussian made = samples_of(belief).moments();
  EXPECT_TRUE(is_near(made.mean, belief.mean, 1e-12));
  EXPECT_TRUE(is_near(made.covariance, belief.covariance, 1e-12));
}

TEST(Samples, AreEmptyForAnInvalidCovariance) {
  Gaussian belief = moving({3.0, -4.0}, {0.2, -0.1}, 1.5, 0.4);
  belief.covariance(0, 0) = -1.0;
  EXPECT_TRUE(samples_of(belief).empty());
}

TEST(Samples, PredictionHasTheMomentsOfAGaussian) {
  for (const models::TargetModel& model :
       {kModel, models::TargetModel{TargetKind::kDoubleIntegrator, 2, 0.3},
        models::TargetModel{
            TargetKind::kDampedOscillator, 2, 0.0, {{0.5, 1.0}, {2, 1}, {0.5, 0.3}, {0.2, 0.4}}}}) {
    const Gaussian belief = moving({3.0, -4.0}, {0.2, -0.1}, 1.5, 0.4);
    const Gaussian right = models::predict(belief, model, 2.0);
    Gaussian mean{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Zero()};
    constexpr int kKeys = 100;
    for (std::uint64_t key = 0; key < kKeys; ++key) {
      Samples samples = samples_of(belief);
      samples.predict(model, 2.0, key);
      const Gaussian made = samples.moments();
      expect_near(made, right, 1e-9, 0.5);
      mean.mean += made.mean / kKeys;
      mean.covariance += made.covariance / kKeys;
    }
    // On average over the keys, noise and state are uncorrelated; each error is 1/√(256 · 100).
    expect_near(mean, right, 1e-9, 0.025);
  }
}

TEST(Samples, NoiseDependsOnTheTime) {
  Samples one = samples_of(moving({3.0, -4.0}, {0.2, -0.1}, 1.5, 0.4));
  Samples same = one;
  Samples other = one;
  one.predict(kModel, 2.0, 5);
  same.predict(kModel, 2.0, 5);
  other.predict(kModel, 2.0, 6);
  EXPECT_EQ(one.moments().covariance, same.moments().covariance);
  EXPECT_NE(one.moments().covariance, other.moments().covariance);
}

TEST(Samples, ReflectAtWallsLikeTargets) {
  for (const Eigen::Vector2d& at_m : {Eigen::Vector2d(31.5, 0.0), Eigen::Vector2d(-33.0, 31.0)}) {
    const Gaussian belief = moving(at_m, {0.5, 0.1}, 1.5, 0.4);
    const Gaussian right = drawn(belief, 200'000, [](Eigen::Vector4d& x) {
      turn_back(x);
      return 1.0;
    });
    Samples samples = samples_of(belief);
    samples.turn_back(kField.bounds);
    expect_near(samples.moments(), right, 0.1, 0.15);
    const Gaussian once = samples.moments();
    samples.turn_back(kField.bounds);  // interior samples do not move
    EXPECT_EQ(samples.moments().covariance, once.covariance);
  }
}

TEST(Samples, LieOutsideTheViewAfterAMiss) {
  const models::SensorModel sensor = field_sensor();
  for (const double yaw_rad : {0.0, 1.0, -2.0}) {
    const models::Viewpoint from = at(1.0, 2.0, yaw_rad);
    const Gaussian belief = moving({4.0, 3.0}, {0.2, -0.1}, 4.0, 0.4);
    const Gaussian right = drawn(belief, 200'000, [&](const Eigen::Vector4d& x) {
      return models::in_view(sensor, from, models::PositionVector(x.head<2>())) ? 0.1 : 1.0;
    });
    Samples samples = samples_of(belief);
    ASSERT_TRUE(samples.miss(sensor, from, kField, 0.9));
    expect_near(samples.moments(), right, 0.15, 0.25);
  }
  Samples far = samples_of(moving({20.0, 20.0}, {0.0, 0.0}, 1.0, 0.4));
  const Gaussian before = far.moments();
  EXPECT_FALSE(far.miss(sensor, at(0, 0), kField, 0.9));
  EXPECT_EQ(far.moments().covariance, before.covariance);
}

TEST(Samples, StayBehindAnObstacleAfterAMiss) {
  models::World world = kField;
  world.obstacles = {{{{2.0, -5.0}, {2.5, 5.0}}, 10.0}};
  Samples samples = samples_of(moving({5.0, 0.0}, {0.0, 0.0}, 0.4, 0.1));
  EXPECT_FALSE(samples.miss(field_sensor(), at(0, 0), world, 0.9));
  EXPECT_TRUE(samples.miss(field_sensor(), at(0, 0), kField, 0.9));
}

TEST(Samples, AvoidObstaclesUnlessNoneWouldRemain) {
  const std::vector<models::Obstacle> half = {{{{0.0, -50.0}, {50.0, 50.0}}, 10.0}};
  const Gaussian belief = moving({0.0, 0.0}, {0.0, 0.0}, 1.0, 0.4);
  const Gaussian right =
      drawn(belief, 200'000, [](const Eigen::Vector4d& x) { return x(0) >= 0.0 ? 0.0 : 1.0; });
  Samples samples = samples_of(belief);
  ASSERT_TRUE(samples.keep_out_of(half));
  expect_near(samples.moments(), right, 0.15, 0.25);
  Samples inside = samples_of(moving({20.0, 0.0}, {0.0, 0.0}, 1.0, 0.4));
  const Gaussian before = inside.moments();
  EXPECT_FALSE(inside.keep_out_of(half));
  EXPECT_EQ(inside.moments().covariance, before.covariance);
}

TEST(Samples, AreUpdatedWhenEnoughExplainTheMeasurement) {
  const models::SensorModel sensor = field_sensor();
  const models::Viewpoint from = at(0, 0, 0.3);
  const Gaussian belief = moving({4.0, 1.0}, {0.2, -0.1}, 0.4, 0.4);
  models::Measurement z{models::observe(sensor, from, Eigen::Vector2d(4.2, 1.1)),
                        models::noise_covariance(sensor, from, Eigen::Vector2d(4.2, 1.1))};
  const Eigen::MatrixXd W = Eigen::MatrixXd(z.V).inverse();
  const Gaussian right = drawn(belief, 200'000, [&](const Eigen::Vector4d& x) {
    const Eigen::VectorXd nu = models::innovation(
        sensor, z.z, models::observe(sensor, from, models::PositionVector(x.head<2>())));
    return std::exp(-0.5 * nu.dot(W * nu));
  });
  Samples samples = samples_of(belief);
  ASSERT_TRUE(samples.measure(sensor, from, z, 0.0));
  expect_near(samples.moments(), right, 0.25, 0.5);
  Samples wide = samples_of(moving({4.0, 1.0}, {0.2, -0.1}, 8.0, 0.4));
  const Gaussian before = wide.moments();
  EXPECT_FALSE(wide.measure(sensor, from, z, 0.0));  // almost no sample fits
  EXPECT_EQ(wide.moments().covariance, before.covariance);
}

TEST(Samples, IgnoreAMeasurementFarFromAllSamples) {
  // At an error of 2 m with σ = 0.15 m, all samples fit equally badly, so the effective sample
  // count alone would not detect the error.
  const models::SensorModel sensor = field_sensor();
  const models::Viewpoint from = at(0.0, 0.0, 0.0);
  const models::Measurement z{models::observe(sensor, from, Eigen::Vector2d(6.0, 0.0)),
                              models::noise_covariance(sensor, from, Eigen::Vector2d(6.0, 0.0))};
  Samples near = samples_of(moving({4.0, 0.0}, {0.2, -0.1}, 0.01, 0.4));
  const Gaussian before = near.moments();
  EXPECT_FALSE(near.measure(sensor, from, z, 4.0));
  EXPECT_EQ(near.moments().mean, before.mean);
  EXPECT_TRUE(near.measure(sensor, from, z, 20.0));
  EXPECT_TRUE(samples_of(moving({6.0, 0.0}, {0.2, -0.1}, 0.1, 0.4)).measure(sensor, from, z, 4.0));
}

TEST(Samples, CopiesAreIndependent) {
  Samples one = samples_of(moving({3.0, -4.0}, {0.2, -0.1}, 1.5, 0.4));
  const Samples copy = one;
  const Gaussian before = one.moments();
  one.predict(kModel, 5.0, 1);
  EXPECT_EQ(copy.moments().mean, before.mean);
  one.clear();
  EXPECT_TRUE(one.empty());
  EXPECT_FALSE(copy.empty());
  one = copy;
  EXPECT_EQ(one.moments().mean, before.mean);
}

/// Belief after a search for a target that was never in view, and the target's true position.
struct Ending {
  Gaussian belief;
  Eigen::Vector2d truth_m;
};
Ending never_seen(int steps, bool samples, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  const Eigen::Matrix4d spread = Eigen::LLT<Eigen::Matrix4d>(kNearACorner.covariance).matrixL();
  const Eigen::Matrix4d noise = Eigen::LLT<Eigen::Matrix4d>(kModel.process_noise(0.5)).matrixL();
  while (true) {
    Eigen::Vector4d x = Eigen::Vector4d(kNearACorner.mean) + spread * test::normal_vector(4, rng);
    DistributedFilter filter = knows(kNearACorner, samples);
    bool is_seen = false;
    for (int k = 1; k <= steps && !is_seen; ++k) {
      x = kModel.transition(0.5) * x + noise * test::normal_vector(4, rng);
      turn_back(x);
      const models::Viewpoint from = beside(kNearACorner, k);
      is_seen = models::in_view(field_sensor(), from, models::PositionVector(x.head<2>()));
      take_step(filter, instant(k), from, {look_of("Q1", k, from)});
    }
    if (!is_seen) {
      const Gaussian end = known(filter, 0);
      return {{end.mean.head<2>(), end.covariance.topLeftCorner<2, 2>()}, x.head<2>()};
    }
  }
}

TEST(SamplesOfAFilter, AreConsistentWithWallsAndMisses) {
  // The trial lasts 40 s and starts near a corner. A Gaussian that is folded at the walls in each
  // step remains at the walls.
  test::MeanNees by_samples;
  test::MeanNees by_a_gaussian;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Ending with = never_seen(80, true, seed);
    by_samples.add(with.belief, with.truth_m);
    if (seed % 4 == 0) {
      const Ending without = never_seen(80, false, seed);
      by_a_gaussian.add(without.belief, without.truth_m);
    }
  }
  // Spreading duplicated samples makes the covariance slightly too large.
  EXPECT_LT(by_samples.mean(), 2.0 + 4.0 * by_samples.sigma());
  EXPECT_GT(by_samples.mean(), 1.6 - 4.0 * by_samples.sigma());
  EXPECT_GT(by_a_gaussian.mean(), 20.0);
}

TEST(SamplesOfAFilter, BecomeAGaussianWhenTheTargetIsSeen) {
  // Truths are near the mean and far from it. The update uses the samples that fit the measurement,
  // or the moments if too few samples fit.
  for (const Eigen::Vector2d& truth_m :
       {Eigen::Vector2d(26.0, 28.0), Eigen::Vector2d(14.0, 26.0)}) {
    DistributedFilter filter = knows(kNearACorner);
    for (int k = 1; k <= 12; ++k) {
      take_step(filter, instant(k), beside(kNearACorner, k),
                {look_of("Q1", k, beside(kNearACorner, k))});
    }
    ASSERT_GT(known(filter, 0).covariance(0, 0), 1.0);
    const models::Viewpoint from = at(truth_m.x() - 5.0, truth_m.y(), 0.0);
    models::RobotMeasurement look = look_of("Q1", 13, from);
    look.detections.push_back({0, test::seen(from, truth_m)});
    take_step(filter, instant(13), from, {look});
    const Gaussian seen = known(filter, 0);
    // The error is within 3σ of a measurement at 5 m: 0.15 m in range and 5° in bearing.
    EXPECT_LT((seen.mean.head<2>() - truth_m).norm(), 3.0 * std::hypot(0.15, 0.44));
    EXPECT_LT(seen.covariance(0, 0), 0.3 * 0.3);
    EXPECT_EQ(filter.track(0).last_seen, instant(13));
    // Afterwards the prediction is that of a Gaussian.
    take_step(filter, instant(14), at(-20.0, -20.0), {});
    const Gaussian later = known(filter, 0);
    EXPECT_TRUE(is_near(later.covariance, models::predict(seen, kModel, 0.5).covariance, 1e-9));
  }
}

TEST(SamplesOfAFilter, AreIndependentOfLateArrival) {
  DistributedFilter timely = knows(kNearACorner);
  DistributedFilter late = knows(kNearACorner);
  for (int k = 1; k <= 6; ++k) {
    const models::Viewpoint from = beside(kNearACorner, k);
    const auto of_teammate = [&](int step) {
      return look_of("Q2", step, at(kNearACorner.mean(0) + 1.0, kNearACorner.mean(1) - 6.0, 1.6));
    };
    take_step(timely, instant(k), from, {look_of("Q1", k, from), of_teammate(k)});
    std::vector<models::RobotMeasurement> received = {look_of("Q1", k, from)};
    if (k > 2) {
      received.push_back(of_teammate(k - 2));
    }
    if (k == 6) {
      received.push_back(of_teammate(5));
      received.push_back(of_teammate(6));
    }
    take_step(late, instant(k), from, received);
  }
  EXPECT_GT(late.counters().late_measurements, 0);
  EXPECT_EQ(late.track(0).information.matrix, timely.track(0).information.matrix);
  EXPECT_EQ(late.track(0).information.vector, timely.track(0).information.vector);
}

TEST(SamplesOfAFilter, AreReplacedOnlyByATeammatesNewerObservation) {
  const auto after_hearing = [](const std::optional<Gaussian>& theirs, Time last_seen) {
    DistributedFilter filter = knows(kNearACorner);
    for (int k = 1; k <= 12; ++k) {
      const models::Viewpoint from = beside(kNearACorner, k);
      std::vector<models::RobotBelief> received;
      if (k == 12 && theirs) {
        received.push_back(test::prior(instant(12), {*theirs}));
        received.back().robot = "Q2";
        received.back().viewpoint = from;
        received.back().targets[0].last_seen = last_seen;
      }
      take_step(filter, instant(k), from, {look_of("Q1", k, from)}, received);
    }
    return known(filter, 0);
  };
  const Gaussian alone = after_hearing({}, {});
  Gaussian surer = alone;
  surer.covariance *= 0.25;
  // The filter's own belief was last observed at instant(0).
  EXPECT_EQ(after_hearing(surer, instant(0)).covariance, alone.covariance);
  EXPECT_TRUE(is_near(after_hearing(surer, instant(1)).covariance, surer.covariance, 1e-9));
  Gaussian modest = alone;  // newer but less certain: not used
  modest.covariance *= 4.0;
  EXPECT_TRUE(is_near(after_hearing(modest, instant(1)).covariance, alone.covariance, 1e-9));
}

TEST(SamplesOfAFilter, AllocateNothing) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  DistributedFilter filter = knows(kNearACorner);
  const models::RobotMeasurement* looks[1] = {nullptr};
  std::size_t allocations = 0;
  for (int k = 1; k <= 40; ++k) {
    const models::RobotMeasurement look = look_of("Q1", k, beside(kNearACorner, k));
    looks[0] = &look;
    const StepInput input{instant(k), look.viewpoint, looks, {}};
    const vantage::test::AllocationCounter counter;
    filter.advance(input);
    allocations += k > 1 ? counter.count() : 0;
  }
  EXPECT_EQ(allocations, 0U);
  EXPECT_GT(filter.counters().missed_detections, 0);
}

// An empty scan changes the published moments immediately and is counted once. A scan of a
// different area is not counted.
TEST(SamplesOfAFilter, UpdateTheBeliefAfterEachMeasurement) {
  DistributedFilter filter = knows(kNearACorner);
  const models::Viewpoint from = at(20.0, 24.0, 0.3);
  take_step(filter, instant(1), from, {look_of("Q1", 1, from)});
  Samples samples = samples_of(models::predict(kNearACorner, kModel, 0.5));
  ASSERT_TRUE(samples.miss(field_sensor(), from, kField, 0.99));
  EXPECT_TRUE(is_near(known(filter, 0).mean, samples.moments().mean, 1e-6));
  EXPECT_TRUE(is_near(known(filter, 0).covariance, samples.moments().covariance, 1e-6));
  EXPECT_EQ(filter.counters().missed_detections, 1);
  const models::Viewpoint away = at(-20.0, -24.0, 0.3);
  take_step(filter, instant(2), away, {look_of("Q1", 2, away)});
  EXPECT_EQ(filter.counters().missed_detections, 1);
  take_step(filter, instant(3), from, {look_of("Q1", 3, from)});
  EXPECT_EQ(filter.counters().missed_detections, 2);
}

// Samples are drawn in opposite pairs. A cut through the centre therefore keeps the variance of all
// coordinates along the cut. If fewer than half of the samples remain, they are duplicated and
// spread by 0.3σ, which increases the variance by a factor of 1.09.
TEST(Samples, DuplicatesWhenLessThanHalfAreEffective) {
  Gaussian belief{Eigen::Vector4d(1.0, -2.0, 0.3, 0.1), Eigen::Matrix4d::Zero()};
  belief.covariance.diagonal() << 1.0, 4.0, 0.25, 0.09;
  for (const bool is_half_left : {true, false}) {
    double sum = 0.0;
    int cases = 0;
    for (const double off_sigma : {0.05, 0.1, 0.15, 0.2, 0.25, 0.3}) {
      for (const Eigen::Index axis : {0, 1}) {
        for (const double side : {-1.0, 1.0}) {
          const double sigma_m = std::sqrt(belief.covariance(axis, axis));
          const double off_m = (is_half_left ? off_sigma : -off_sigma) * side * sigma_m;
          models::Rectangle beyond{{-90.0, -90.0}, {90.0, 90.0}};
          (side > 0.0 ? beyond.min_m : beyond.max_m)(axis) = belief.mean(axis) + off_m;
          Samples samples = samples_of(belief);
          ASSERT_TRUE(samples.keep_out_of({{beyond, 10.0}}));
          const Gaussian left = samples.moments();
          for (Eigen::Index other = 0; other < 4; ++other) {
            if (other != axis) {
              sum += left.covariance(other, other) / belief.covariance(other, other);
              ++cases;
            }
          }
        }
      }
    }
    // The tolerance covers chance correlation between displacements and positions.
    EXPECT_NEAR(sum / cases, is_half_left ? 1.0 : 1.09, is_half_left ? 0.02 : 0.06);
  }
}

// For N(0, 1) in the plane, a likelihood of variance x leaves n (1 − 1/(x + 1)²) of n samples
// effective. The two cases have 1.4 times and 1/1.4 times the required number.
TEST(Samples, AreUpdatedFromThirtyTwoSupportingSamples) {
  const models::SensorModel sensor = test::far_sighted(models::SensorKind::kPosition);
  Gaussian belief{Eigen::Vector4d(3.0, -4.0, 0.2, -0.1), Eigen::Matrix4d::Identity()};
  for (const auto& [supporting, is_used] :
       {std::pair(32.0 * 1.4, true), std::pair(32.0 / 1.4, false)}) {
    const double x_m2 = 1.0 / std::sqrt(1.0 - supporting / Samples::kCount) - 1.0;
    for (int k = 0; k < 8; ++k) {
      const double angle_rad = 0.25 * kPi * k;
      const Eigen::Vector2d z_m(3.0 + 0.1 * std::cos(angle_rad), -4.0 + 0.1 * std::sin(angle_rad));
      Samples samples = samples_of(belief);
      EXPECT_EQ(samples.measure(sensor, at(0, 0), {z_m, x_m2 * Eigen::Matrix2d::Identity()}, 0.0),
                is_used)
          << supporting << " " << k;
    }
  }
}

}  // namespace
}  // namespace vantage::estimator
