#include "estimator/tracks/samples/target_collisions.hpp"

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace)
using vantage::test::is_near;
using State = Eigen::Vector4d;

constexpr double kDistance_m = 0.4;
const models::TargetModel kNoiseless{TargetKind::kDoubleIntegrator, 2, 0.0};
const models::TargetModel kModel{TargetKind::kDoubleIntegrator, 2, 0.001};

Gaussian around(const State& mean, double position_sigma_m, double velocity_sigma_mps) {
  Gaussian belief{mean, Eigen::Matrix4d::Zero()};
  belief.covariance.diagonal() << State(position_sigma_m, position_sigma_m, velocity_sigma_mps,
                                        velocity_sigma_mps)
                                      .cwiseAbs2();
  return belief;
}

/// Returns a belief with negligible standard deviations.
Gaussian exactly(const State& state) { return around(state, 1e-4, 1e-4); }

struct Pair {
  State one = State::Zero();
  State other = State::Zero();
};

/// Beliefs of two targets after dt_s without measurements, and whether each of them had a meeting.
struct Met {
  bool one_has = false;
  bool other_has = false;
  Gaussian one;
  Gaussian other;
};
Met after(const Samples& one, const Samples& other, double dt_s, std::uint64_t key = 1) {
  Samples a = one;
  Samples b = other;
  const bool one_has = a.collide_with(other, kDistance_m, dt_s, key);
  const bool other_has = b.collide_with(one, kDistance_m, dt_s, ~key);
  a.predict(kNoiseless, dt_s, 0);
  b.predict(kNoiseless, dt_s, 0);
  return {one_has, other_has, a.moments(), b.moments()};
}
Samples samples_of(const Gaussian& belief) {
  Samples samples;
  samples.spread(belief);
  return samples;
}
Met after(const Gaussian& one, const Gaussian& other, double dt_s, std::uint64_t key = 1) {
  return after(samples_of(one), samples_of(other), dt_s, key);
}

State turned(const State& x, double by_rad, bool mirrored) {
  Eigen::Matrix2d R = Eigen::Rotation2Dd(by_rad).toRotationMatrix();
  R.col(1) *= mirrored ? -1.0 : 1.0;
  State out;
  out << R * x.head<2>(), R * x.tail<2>();
  return out;
}

TEST(Samples, CollisionReversesBothVelocitiesAtTheMeetingPoint) {
  // The targets are 2 m apart and approach at 2 m/s, so they meet after 0.8 s, in every direction
  // and mirrored.
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (const bool mirrored : {false, true}) {
      const auto t = [&](const State& x) { return turned(x, quarter * 0.5 * kPi, mirrored); };
      const Met met =
          after(exactly(t({0.0, 0.0, 1.0, 0.0})), exactly(t({2.0, 0.0, -1.0, 0.0})), 2.0);
      EXPECT_TRUE(met.one_has);
      EXPECT_TRUE(met.other_has);
      EXPECT_TRUE(is_near(met.one.mean, t({0.8 - 1.2, 0.0, -1.0, 0.0}), 1e-3)) << quarter;
      EXPECT_TRUE(is_near(met.other.mean, t({1.2 + 1.2, 0.0, 1.0, 0.0}), 1e-3)) << quarter;
    }
  }
}

TEST(Samples, CollisionKeepsVelocityOfTheOvertakenTarget) {
  // The second target is 1 m behind and 0.8 m/s faster, so they meet after 0.75 s.
  const Met met = after(exactly({0.0, 0.0, 0.2, 0.0}), exactly({-1.0, 0.0, 1.0, 0.0}), 1.0);
  EXPECT_FALSE(met.one_has);
  EXPECT_TRUE(is_near(met.one.mean, State(0.2, 0.0, 0.2, 0.0), 1e-3));
  EXPECT_TRUE(is_near(met.other.mean, State(-0.25 - 0.25, 0.0, -1.0, 0.0), 1e-3));
}

TEST(Samples, CollisionKeepsAStationaryTargetStationary) {
  const Met met = after(exactly({0.0, 1.0, 0.0, 0.0}), exactly({0.0, -1.0, 0.0, 1.0}), 2.0);
  EXPECT_TRUE(is_near(met.one.mean, State(0.0, 1.0, 0.0, 0.0), 1e-3));
  EXPECT_TRUE(is_near(met.other.mean, State(0.0, 0.6 - 0.4, 0.0, -1.0), 1e-3));
}

TEST(Samples, CollisionReversesTheApproachingComponent) {
  // The first target approaches from below, almost along y, and then from the left, almost along x.
  const Met y = after(exactly({0.05, -1.0, 0.3, 1.0}), exactly({0.2, 0.0, 0.0, 0.0}), 1.0);
  EXPECT_TRUE(is_near(y.one.mean.tail<2>(), Eigen::Vector2d(0.3, -1.0), 1e-3));
  const Met x = after(exactly({-1.0, 0.05, 1.0, 0.3}), exactly({0.0, 0.2, 0.0, 0.0}), 1.0);
  EXPECT_TRUE(is_near(x.one.mean.tail<2>(), Eigen::Vector2d(-1.0, 0.3), 1e-3));
}

TEST(Meet, HappensWithinTheTimeAndDistanceOnly) {
  const State from_left(0.0, 0.0, 1.0, 0.0);
  const auto is_met = [&](double aside_m, double dt_s) {
    return after(exactly(from_left), exactly({2.0, aside_m, -1.0, 0.0}), dt_s).one_has;
  };
  EXPECT_TRUE(is_met(0.0, 0.801));
  EXPECT_FALSE(is_met(0.0, 0.799));
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(is_met(side * (kDistance_m - 0.002), 2.0));
    EXPECT_FALSE(is_met(side * (kDistance_m + 0.002), 2.0));
  }
}

TEST(Samples, CollisionChangesNothingIfTheTargetsMoveApart) {
  Samples one = samples_of(around({0.0, 0.0, -1.0, 0.0}, 0.1, 0.05));
  const Samples other = samples_of(around({2.0, 0.0, 1.0, 0.0}, 0.1, 0.05));
  const Gaussian before = one.moments();
  EXPECT_FALSE(one.collide_with(other, kDistance_m, 10.0, 1));
  EXPECT_EQ(one.moments().mean, before.mean);
  EXPECT_EQ(one.moments().covariance, before.covariance);
}

TEST(Meet, IsIndependentOfTheStepLength) {
  // One target moves and one is stationary. Their uncertain positions overlap; samples that start
  // within the minimum distance do not count as a meeting.
  const Gaussian walks = around({0.0, 0.0, 0.5, 0.0}, 1.0, 0.02);
  const Gaussian stands = around({0.0, 0.0, 0.0, 0.0}, 1.0, 0.02);
  const auto slower_mps = [&](int parts) {
    constexpr int kKeys = 400;
    double sum = 0.0;
    for (std::uint64_t key = 0; key < kKeys; ++key) {
      Samples samples = samples_of(walks);
      for (int part = 0; part < parts; ++part) {
        samples.collide_with(samples_of(stands), kDistance_m, 0.5 / parts,
                             1000 * key + static_cast<std::uint64_t>(part));
        samples.predict(kNoiseless, 0.5 / parts, 0);
      }
      sum += 0.5 - samples.moments().mean(2);
    }
    return sum / kKeys;
  };
  // Share of meetings: the area swept by a disc times the density of the position difference, σ² =
  // 2 m².
  const double swept_m2 = 2.0 * kDistance_m * 0.5 * 0.5;
  const double share = swept_m2 / (2.0 * kPi * 2.0);
  EXPECT_LT(slower_mps(1), 1.15 * share * 2.0 * 0.5);
  EXPECT_GT(slower_mps(1), 0.5 * share * 2.0 * 0.5);  // lateral contacts reverse vy instead of vx
  EXPECT_NEAR(slower_mps(5) / slower_mps(1), 1.0, 0.15);
}

TEST(Samples, CollisionWeightsMeetingsBySampleWeight) {
  // The other target is equally likely to be on the left or on the right. An empty scan of the left
  // almost excludes it there, so a target that moves on the left rarely meets it.
  const models::SensorModel sensor = [] {
    models::SensorModel near;
    near.range_max_m = 1.5;
    return near;
  }();
  const models::World open{{{-20.0, -20.0}, {20.0, 20.0}}, 10.0, {}, {}};
  Gaussian either = around({0.0, 0.0, 0.0, 0.0}, 0.1, 0.01);
  either.covariance(0, 0) = 1.0;
  const Gaussian walks = around({-1.0, -1.0, 0.0, 1.0}, 0.02, 0.01);
  Samples other = samples_of(either);
  const double before = after(samples_of(walks), other, 1.0).one.mean(3);
  ASSERT_TRUE(other.miss(sensor, at(-1.5, 0.0), open, 0.95));
  const double since = after(samples_of(walks), other, 1.0).one.mean(3);
  EXPECT_LT(before, 0.85);
  EXPECT_NEAR(1.0 - since, 0.1 * (1.0 - before), 0.1 * (1.0 - before));
}

/// Moves the pair in 500 small steps by brute force. A target is reflected if its step would end
/// closer than kDistance_m to the other.
Pair stepped(Pair pair, double dt_s, std::mt19937_64& rng) {
  constexpr int kSteps = 500;
  for (int i = 0; i < kSteps; ++i) {
    const double h = dt_s / kSteps;
    const auto go = [&](State& x, const State& y) {
      const auto is_free = [&](const Eigen::Vector2d& v) {
        const Eigen::Vector2d now = x.head<2>() - y.head<2>();
        const double then_m = (now + v * h).norm();
        return then_m >= kDistance_m || then_m >= now.norm();
      };
      Eigen::Vector2d v = x.tail<2>();
      if (!is_free(v)) {
        const int axis = std::bernoulli_distribution()(rng) ? 1 : 0;
        Eigen::Vector2d mirrored[2] = {{-v.x(), v.y()}, {v.x(), -v.y()}};
        v = is_free(mirrored[axis])       ? mirrored[axis]
            : is_free(mirrored[1 - axis]) ? mirrored[1 - axis]
                                          : Eigen::Vector2d(-v);
      }
      x.tail<2>() = v;
      x.head<2>() += v * h;
    };
    const State before = pair.one;
    go(pair.one, pair.other);
    go(pair.other, before);
  }
  return pair;
}

State drawn(const Gaussian& belief, std::mt19937_64& rng) {
  const Eigen::Matrix4d L = Eigen::LLT<Eigen::Matrix4d>(belief.covariance).matrixL();
  return State(belief.mean) + L * test::normal_vector(4, rng);
}

TEST(Samples, CollisionAgreesWithBruteForce) {
  // The targets probably meet within 2 s, but may miss each other.
  const Gaussian one = around({0.0, 0.0, 0.8, 0.1}, 0.25, 0.15);
  const Gaussian other = around({1.6, 0.3, -0.5, 0.0}, 0.25, 0.15);
  std::mt19937_64 rng(3);
  constexpr int kDraws = 8000;
  State sum = State::Zero();
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const State x = stepped({drawn(one, rng), drawn(other, rng)}, 2.0, rng).one;
    sum += x;
    squares += x * x.transpose();
  }
  const State right = sum / kDraws;
  const Eigen::Matrix4d right_covariance = squares / kDraws - right * right.transpose();
  constexpr int kKeys = 64;
  State mean = State::Zero();
  State spread = State::Zero();
  for (std::uint64_t key = 0; key < kKeys; ++key) {
    const Met met = after(one, other, 2.0, key);
    mean += State(met.one.mean) / kKeys;
    spread += State(met.one.covariance.diagonal()) / kKeys;
  }
  const State sigma = right_covariance.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(mean(i), right(i), 0.1 * sigma(i)) << i;
    EXPECT_NEAR(std::sqrt(spread(i)), sigma(i), 0.1 * sigma(i)) << i;
  }
  EXPECT_LT(right(2), 0.2);  // 0.8 without meetings
}

FilterSpec spec_of_two(double radius_m) {
  models::SensorModel sensor = test::far_sighted(models::SensorKind::kPosition);
  FilterSpec spec = open_spec(kModel, sensor, 2);
  spec.estimator.samples = true;
  spec.target_radius_m = radius_m;
  spec.communication_range_m = 100.0;
  return spec;
}

const std::vector<Gaussian> kTowardsEachOther = {around({0.0, 0.0, 0.6, 0.1}, 0.08, 0.05),
                                                 around({1.8, 0.2, -0.5, 0.0}, 0.08, 0.05)};

DistributedFilter knows_two(double radius_m) {
  DistributedFilter filter(spec_of_two(radius_m));
  filter.rebase(test::prior(instant(0), kTowardsEachOther));
  return filter;
}

TEST(DistributedFilter, IsConsistentAfterUnobservedMeetings) {
  test::MeanNees with;
  test::MeanNees without;
  std::mt19937_64 rng(11);
  DistributedFilter meets = knows_two(0.2);
  DistributedFilter passes = knows_two(0.0);
  for (int step = 1; step <= 8; ++step) {
    take_step(meets, instant(step), at(0, 0), {});
    take_step(passes, instant(step), at(0, 0), {});
  }
  const auto place = [](const DistributedFilter& filter) {
    const Gaussian belief = known(filter, 0);
    return Gaussian{belief.mean.head<2>(), belief.covariance.topLeftCorner<2, 2>()};
  };
  for (int i = 0; i < 3000; ++i) {
    // The velocity noise over 4 s, 0.06 m/s, is drawn once at the start. The velocity has a σ of
    // 0.05 m/s.
    Pair pair{drawn(kTowardsEachOther[0], rng), drawn(kTowardsEachOther[1], rng)};
    std::normal_distribution<double> noise(0.0, std::sqrt(kModel.q * 4.0 / 3.0));
    for (State* x : {&pair.one, &pair.other}) {
      (*x)(2) += noise(rng);
      (*x)(3) += noise(rng);
    }
    const Eigen::Vector2d truth_m = stepped(pair, 4.0, rng).one.head<2>();
    with.add(place(meets), truth_m);
    without.add(place(passes), truth_m);
  }
  EXPECT_NEAR(with.mean(), 2.0, 0.3);
  EXPECT_GT(without.mean(), 20.0);
}

TEST(TargetCollisionsOfAFilter, ApplyToATeammatesBeliefOfTheLastStep) {
  // A belief that is sent before the meeting and predicted without it would be too certain and
  // would dominate the fusion.
  DistributedFilter alone = knows_two(0.2);
  DistributedFilter informed = knows_two(0.2);
  for (int step = 1; step <= 4; ++step) {
    models::RobotBelief of_before = informed.belief();
    of_before.robot = "Q2";
    models::RobotBelief of_now = test::prior(instant(step), {});
    of_now.robot = "Q3";
    take_step(alone, instant(step), at(0, 0), {});
    take_step(informed, instant(step), at(0, 0), {}, {of_before, of_now});
  }
  EXPECT_GT(known(alone, 0).covariance(2, 2), 0.1);
  for (const int target : {0, 1}) {
    EXPECT_EQ(known(informed, target).mean, known(alone, target).mean);
    EXPECT_EQ(known(informed, target).covariance, known(alone, target).covariance);
  }
}

TEST(TargetCollisionsOfAFilter, AreIndependentOfTheArrivalOrder) {
  const auto look = [](int step) {
    models::RobotMeasurement set;
    set.stamp.time = instant(step);
    set.robot = "Q2";
    set.viewpoint = at(0, 0);
    const models::PositionVector seen_m = Eigen::Vector2d(0.28, 0.05);
    const models::SensorModel sensor = spec_of_two(0.2).sensor;
    set.detections.push_back({0, {seen_m, models::noise_covariance(sensor, at(0, 0), seen_m)}});
    return set;
  };
  const auto knows_as = [](const std::string& robot) {
    FilterSpec spec = spec_of_two(0.2);
    spec.robot = robot;
    spec.team = {{"Q1", spec.sensor}, {"Q2", spec.sensor}};
    DistributedFilter filter(spec);
    filter.rebase(test::prior(instant(0), kTowardsEachOther));
    return filter;
  };
  DistributedFilter timely = knows_as("Q1");
  DistributedFilter other = knows_as("Q2");
  DistributedFilter late = knows_as("Q1");
  for (int step = 1; step <= 6; ++step) {
    const std::vector<models::RobotMeasurement> none;
    const std::vector<models::RobotMeasurement> seen = {look(1)};
    take_step(timely, instant(step), at(0, 0), step == 1 ? seen : none);
    take_step(other, instant(step), at(0, 0), step == 1 ? seen : none);
    take_step(late, instant(step), at(0, 0), step == 5 ? seen : none);
  }
  EXPECT_EQ(late.counters().late_measurements, 1);
  EXPECT_GT(known(timely, 0).covariance(2, 2), 0.05);
  for (const int target : {0, 1}) {
    for (const DistributedFilter* filter : {&other, &late}) {
      EXPECT_EQ(known(*filter, target).mean, known(timely, target).mean);
      EXPECT_EQ(known(*filter, target).covariance, known(timely, target).covariance);
    }
  }
}

TEST(DistributedFilter, PredictsAsUsualWithoutMeetings) {
  DistributedFilter filter(spec_of_two(0.2));
  const std::vector<Gaussian> apart = {around({0.0, 0.0, -0.6, 0.1}, 0.08, 0.05),
                                       around({9.0, 0.2, 0.5, 0.0}, 0.08, 0.05)};
  filter.rebase(test::prior(instant(0), apart));
  for (int step = 1; step <= 8; ++step) {
    take_step(filter, instant(step), at(0, 0), {});
  }
  const Gaussian alone = models::predict(apart[0], kModel, 4.0);
  EXPECT_TRUE(is_near(known(filter, 0).mean, alone.mean, 1e-9));
  EXPECT_TRUE(is_near(known(filter, 0).covariance, alone.covariance, 1e-9));
}

TEST(TargetCollisionsOfAFilter, AllocateNothing) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  DistributedFilter filter = knows_two(0.2);
  for (int step = 1; step <= 8; ++step) {
    const StepInput input{instant(step), at(0, 0), {}, {}};
    const vantage::test::AllocationCounter counter;
    filter.advance(input);
    EXPECT_EQ(counter.count(), 0U) << step;
  }
}

// Both targets are reflected, for any ids and table positions. A target far from both gets no
// samples.
TEST(TargetCollisions, ReverseBothTargetsForAnyIds) {
  const State from_left(0.0, 0.0, 1.0, 0.0);
  const State from_right(2.0, 0.0, -1.0, 0.0);
  const State far(0.0, 9.0, 0.0, -1.0);
  const std::vector<State> all = {from_left, from_right, far};
  constexpr double kTime_s = 1.5;
  for (const std::vector<int>& ids :
       {std::vector{0, 1, 2}, std::vector{1, 0, 2}, std::vector{0, 2, 1}, std::vector{2, 1, 0}}) {
    TrackTable tracks(3);
    for (std::size_t i = 0; i < 3; ++i) {
      tracks.put({ids[i], {true, *models::to_information(exactly(all[i])), instant(0)}});
    }
    TargetCollisions collisions(3, kDistance_m);
    SampleTable sampled(3);
    collisions.apply(tracks, sampled, kTime_s, 9);
    ASSERT_NE(sampled.find(ids[0]), nullptr);
    ASSERT_NE(sampled.find(ids[1]), nullptr);
    EXPECT_EQ(sampled.find(ids[2]), nullptr);
    const auto then = [&](std::size_t i) {
      Samples samples = sampled.find(ids[i])->samples;
      samples.predict(kNoiseless, kTime_s, 0);
      return samples.moments().mean;
    };
    EXPECT_TRUE(is_near(then(0), State(0.8 - 0.7, 0.0, -1.0, 0.0), 1e-3));
    EXPECT_TRUE(is_near(then(1), State(1.2 + 0.7, 0.0, 1.0, 0.0), 1e-3));
  }
}

// Collisions are computed exactly up to the distance at which two targets can meet within the time.
TEST(TargetCollisions, IncludeTargetsThatCanJustReachEachOther) {
  constexpr double kTime_s = 1.5;
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (const double share :
         {0.0, 0.3, 1.0}) {  // share of the first target in the closing speed of 6 m/s
      for (const bool is_first : {true, false}) {
        const auto meet = [&](double apart_m) {
          const auto t = [&](const State& x) { return turned(x, quarter * 0.5 * kPi, false); };
          TrackTable tracks(2);
          const Gaussian one = exactly(t({0.0, 0.0, 6.0 * share, 0.0}));
          const Gaussian other = exactly(t({apart_m, 0.0, -6.0 * (1.0 - share), 0.0}));
          tracks.put({is_first ? 3 : 5, {true, *models::to_information(one), instant(0)}});
          tracks.put({is_first ? 5 : 3, {true, *models::to_information(other), instant(0)}});
          TargetCollisions collisions(2, kDistance_m);
          SampleTable sampled(2);
          collisions.apply(tracks, sampled, kTime_s, 9);
          return sampled.begin() != sampled.end();
        };
        EXPECT_TRUE(meet(9.0 + kDistance_m - 0.01));
        EXPECT_FALSE(meet(9.0 + kDistance_m + 0.01));
      }
    }
  }
}

}  // namespace
}  // namespace vantage::estimator
