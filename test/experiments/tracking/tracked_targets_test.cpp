#include "experiments/tracking/tracked_targets.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

constexpr double kSide_m = 64.0;
constexpr int kSteps = 300;

models::World square_world() {
  models::World world;
  world.bounds = {{0.0, 0.0}, {kSide_m, kSide_m}};
  return world;
}

models::SensorModel range_bearing(double range_max_m, double fov_rad) {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRangeBearing;
  sensor.range_max_m = range_max_m;
  sensor.fov_rad = fov_rad;
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = radians(5.0);
  sensor.variance_grows_with_range = range_max_m < kSide_m;
  return sensor;
}

// Returns the poses of stationary robots on a 16 m grid that turn by 3° per step. Each target is in
// view at some times.
std::vector<Pose2> sentries(int step) {
  std::vector<Pose2> poses;
  for (int i = 0; i < 16; ++i) {
    poses.push_back({8.0 + 16.0 * (i % 4),
                     8.0 + 16.0 * (i / 4),  // NOLINT(bugprone-integer-division)
                     wrap_to_pi(radians(3.0 * step + 77.0 * i))});
  }
  return poses;
}

// Mean values over targets, steps and seeds.
struct Consistency {
  double nees_seen = 0.0;
  double nees_unseen = 0.0;
  double share_seen = 0.0;
};

Consistency consistency_of_sentries(const TargetSetting& setting, int seeds) {
  const models::World world = square_world();
  const models::SensorModel sensor = range_bearing(10.0, radians(94.0));
  Consistency mean;
  double seen = 0.0;
  double unseen = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    TrackedTargets targets(setting, world, static_cast<std::uint64_t>(seed));
    for (int step = 0; step < kSteps; ++step) {
      targets.move();
      targets.observe(sensor, sentries(step), std::vector<char>(16, 0));
      for (const TargetStep& target : targets.steps()) {
        (target.is_seen ? seen : unseen) += 1.0;
        (target.is_seen ? mean.nees_seen : mean.nees_unseen) += target.nees;
      }
    }
  }
  mean.nees_seen /= seen;
  mean.nees_unseen /= unseen;
  mean.share_seen = seen / (seen + unseen);
  return mean;
}

TEST(TrackedTargets, ErrorsMatchTheFiltersCovariance) {
  const Consistency mean = consistency_of_sentries({}, 20);
  EXPECT_GT(mean.share_seen, 0.05);
  EXPECT_LT(mean.share_seen, 0.6);
  EXPECT_NEAR(mean.nees_seen, 4.0, 0.5);
  EXPECT_NEAR(mean.nees_unseen, 4.0, 0.5);
}

// Successive empty scans are not independent. The sensor's true detection probability would count
// them too strongly, so the setting is lower.
TEST(TrackedTargets, BeliefsAreOverconfidentWithTheSensorsDetectionProbability) {
  TargetSetting setting;
  setting.detection_probability = 0.9;
  EXPECT_GT(consistency_of_sentries(setting, 5).nees_unseen, 8.0);
}

TEST(TrackedTargets, HaveSmallErrorsWithUnlimitedView) {
  const models::World world = square_world();
  const models::SensorModel sensor = range_bearing(100.0, 2.0 * kPi);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    TrackedTargets targets({}, world, seed);
    double squared_m2 = 0.0;
    for (int step = 0; step < kSteps; ++step) {
      targets.move();
      targets.observe(sensor, sentries(step), std::vector<char>(16, 0));
      for (const TargetStep& target : targets.steps()) {
        EXPECT_TRUE(target.is_seen);
        squared_m2 += target.error_m * target.error_m;
      }
    }
    EXPECT_LT(std::sqrt(squared_m2 / (10.0 * kSteps)), 0.1);
  }
}

// Without measurements, a belief that may leave the world equals the predicted prior. Some beliefs
// then leave the world.
TEST(TrackedTargets, MayBeEstimatedBeyondWallsIfAllowed) {
  const models::World world = square_world();
  TargetSetting setting;
  setting.prior_velocity_sigma_mps = 1.0;
  setting.beliefs_stay_inside = false;
  TrackedTargets free(setting, world, 3);
  setting.beliefs_stay_inside = true;
  TrackedTargets kept(setting, world, 3);
  const std::vector<models::Gaussian> before = free.beliefs();
  constexpr int kUnseenSteps = 120;
  for (int step = 0; step < kUnseenSteps; ++step) {
    free.move();
    kept.move();
  }
  const double gone_s = kUnseenSteps * setting.step_s;
  int outside = 0;
  for (std::size_t m = 0; m < before.size(); ++m) {
    const models::Gaussian expected = models::predict(before[m], free.model(), gone_s);
    EXPECT_LT((free.beliefs()[m].mean - expected.mean).norm(), 1e-9);
    EXPECT_LT((free.beliefs()[m].covariance - expected.covariance).norm(),
              1e-9 * expected.covariance.norm());
    const Eigen::Array2d free_m = free.beliefs()[m].mean.head<2>();
    outside += (free_m < 0.0).any() || (free_m > kSide_m).any() ? 1 : 0;
    const Eigen::Array2d kept_m = kept.beliefs()[m].mean.head<2>();
    EXPECT_TRUE((kept_m >= 0.0).all() && (kept_m <= kSide_m).all());
  }
  EXPECT_GT(outside, 0);
}

TEST(TrackedTargets, AreOnlyPredictedByABlindTeam) {
  const models::World world = square_world();
  const models::SensorModel sensor = range_bearing(100.0, 2.0 * kPi);
  TargetSetting certain;
  certain.prior_position_sigma_m = 1e-6;
  certain.prior_velocity_sigma_mps = 1e-6;
  constexpr int kBlindSteps = 40;
  const double drift_sigma_m =
      std::sqrt(certain.q_m2ps3 * std::pow(kBlindSteps * certain.step_s, 3) / 3.0);
  double squared_m2 = 0.0;
  double watched_m2 = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    TrackedTargets watched(certain, world, seed);
    TrackedTargets alone(certain, world, seed);
    for (int step = 0; step < kBlindSteps; ++step) {
      watched.move();
      alone.move();
      watched.observe(sensor, sentries(step), std::vector<char>(16, 0));
      alone.observe(sensor, sentries(step), std::vector<char>(16, 1));
    }
    for (std::size_t m = 0; m < 10; ++m) {
      EXPECT_FALSE(alone.steps()[m].is_seen);
      squared_m2 += std::pow(alone.steps()[m].error_m, 2);
      watched_m2 += std::pow(watched.steps()[m].error_m, 2);
    }
  }
  // 400 coordinates of variance q t³/3: the root mean square has a relative standard error of 3.5
  // %.
  EXPECT_NEAR(std::sqrt(squared_m2 / 400.0), drift_sigma_m, 0.15 * drift_sigma_m);
  EXPECT_LT(std::sqrt(watched_m2 / 400.0), 0.1 * drift_sigma_m);
}

}  // namespace
}  // namespace vantage::experiments
