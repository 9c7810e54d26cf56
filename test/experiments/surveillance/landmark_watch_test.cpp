#include "experiments/surveillance/landmark_watch.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "experiments/surveillance/camp_world.hpp"
#include "experiments/surveillance/surveillance_trial.hpp"
#include "experiments/surveillance/two_targets_trial.hpp"

namespace vantage::experiments {
namespace {

WatchSetting short_setting(int attacks) {
  WatchSetting setting = surveillance_setting(5, attacks);
  setting.task_steps = 30;
  setting.delta_m = 4.0;
  return setting;
}

// One landmark is seen at steps 2, 3 and 7 of 10, the other never.
TEST(Revisits, CountIntervalsWithAndWithoutTheEnds) {
  std::vector<std::vector<char>> seen(10, {0, 0});
  seen[1][0] = seen[2][0] = seen[6][0] = 1;
  const Revisits result = revisits(seen);
  EXPECT_DOUBLE_EQ(result.interval, 2.5);                     // mean of 1 and 4 steps
  EXPECT_DOUBLE_EQ(result.interval_with_ends, 20.0 / 5.0);    // mean of 2, 1, 4, 3 and 10
  EXPECT_DOUBLE_EQ(result.interval_by_landmark, 0.5 * 12.5);  // mean of 2.5 and 10
  EXPECT_DOUBLE_EQ(result.age, (13.0 + 55.0) / 20.0);
  EXPECT_DOUBLE_EQ(result.absence, 4.0);
  EXPECT_EQ(result.longest, 10);
  EXPECT_EQ(result.never_seen, 1);
}

// For each landmark, the intervals including both ends sum to the duration, for any observations.
TEST(Revisits, IntervalsWithEndsSumToTheDuration) {
  std::mt19937_64 rng(7);
  for (int i = 0; i < 200; ++i) {
    const std::size_t landmarks = 1 + rng() % 5;
    const std::size_t steps = 1 + rng() % 40;
    std::vector<std::vector<char>> seen(steps, std::vector<char>(landmarks, 0));
    double intervals = 0.0;
    for (std::size_t m = 0; m < landmarks; ++m) {
      for (std::size_t t = 0; t < steps; ++t) {
        seen[t][m] = rng() % 4 == 0 ? 1 : 0;
        intervals += seen[t][m];
      }
      intervals += seen[steps - 1][m] == 0 ? 1.0 : 0.0;
    }
    EXPECT_NEAR(revisits(seen).interval_with_ends * intervals,
                static_cast<double>(landmarks * steps), 1e-9);
  }
}

TEST(Camp, HasAReachableLandmarkPerRoof) {
  const WatchSetting setting = surveillance_setting(1, 0);
  const auto landmarks_m = camp_landmarks_m();
  for (std::size_t m = 0; m < landmarks_m.size(); ++m) {
    const models::Obstacle& building = setting.world.obstacles[m];
    EXPECT_TRUE(building.footprint.contains(landmarks_m[m].head<2>()));
    EXPECT_GT(landmarks_m[m].z(), building.height_m);
  }
  for (int robot = 0; robot < 5; ++robot) {
    const double height_m = camp_height_m(robot);
    const models::World world = world_at(setting, height_m);
    for (const models::PositionVector& landmark_m : landmarks_m) {
      int places = 0;
      for (double angle_rad = 0.0; angle_rad < 2.0 * kPi; angle_rad += 0.1) {
        for (double away_m = 0.5; away_m < 10.0; away_m += 0.5) {
          const Pose2 at{landmark_m.x() + away_m * std::cos(angle_rad),
                         landmark_m.y() + away_m * std::sin(angle_rad), 0.0};
          places += models::clearance_m(world, at.position_m()) > setting.clearance_m &&
                            models::in_view(setting.sensor, {at, height_m}, landmark_m)
                        ? 1
                        : 0;
        }
      }
      EXPECT_GT(places, 50) << "robot " << robot << ", landmark " << landmark_m.transpose();
    }
  }
}

TEST(Watch, OmitsObstaclesBelowTheFlightHeight) {
  const WatchSetting setting = surveillance_setting(1, 0);
  const models::World high = world_at(setting, 9.5);
  EXPECT_LT(high.obstacles.size(), world_at(setting, 5.5).obstacles.size());
  for (const models::Obstacle& obstacle : high.obstacles) {
    EXPECT_GT(obstacle.height_m, 9.5 - setting.overfly_m);
  }
}

TEST(Watch, IsEqualForBothPlannersWithoutAttack) {
  const WatchSetting setting = short_setting(0);
  const auto starts = surveillance_starts(setting, 3, 4);
  const WatchRun descent = watch(setting, starts, false);
  const WatchRun rain = watch(setting, starts, true);
  EXPECT_EQ(descent.poses, rain.poses);
  EXPECT_EQ(descent.seen, rain.seen);
  ASSERT_EQ(descent.seen.size(), 30U);
}

TEST(Watch, KeepsClearanceAndControlLimits) {
  const WatchSetting setting = short_setting(2);
  const auto starts = surveillance_starts(setting, 5, 11);
  const WatchRun run = watch(setting, starts, true);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const models::World world = world_at(setting, starts[i].height_m);
    for (std::size_t t = 1; t < run.poses.size(); ++t) {
      const Eigen::Vector2d at_m = run.poses[t][i].position_m();
      EXPECT_GT(models::clearance_m(world, at_m), setting.clearance_m - 1e-9);
      EXPECT_LE((at_m - run.poses[t - 1][i].position_m()).norm(), 3.0 + 1e-9);
    }
  }
  for (const std::vector<char>& attacked : run.attacked) {
    EXPECT_LE(std::count(attacked.begin(), attacked.end(), 1), 2);
  }
}

// With every sensor jammed, Σ is (σ² + q n (n − 1)/2) I after n steps; the first step adds no
// noise.
TEST(Watch, UncertaintyGrowsWhenAllRobotsAreAttacked) {
  const WatchSetting setting = short_setting(2);
  const WatchRun run = watch(setting, surveillance_starts(setting, 2, 4), true);
  for (std::size_t t = 0; t < run.seen.size(); ++t) {
    for (const char seen : run.seen[t]) {
      ASSERT_EQ(seen, 0);
    }
    const double n = static_cast<double>(t + 1);
    const double variance_m2 = 1.0 + 0.01 * 0.5 * n * (n - 1.0);
    EXPECT_NEAR(run.entropy_nats[t], 1.5 * std::log(2.0 * kPi * std::exp(1.0) * variance_m2), 1e-9);
  }
}

TEST(Watch, RefusesAStartInABuilding) {
  const WatchSetting setting = short_setting(0);
  const models::Viewpoint in_a_tower{{110.0, 44.0, 0.0}, 5.5};
  EXPECT_THROW(watch(setting, {&in_a_tower, 1}, false), UsageError);
}

// As in the hardware experiment, the robot that plans first is jammed.
TEST(TwoTargets, AreSwappedBetweenRobotsOnlyWithResilience) {
  WatchSetting setting = two_targets_setting(0);
  setting.task_steps = 120;
  int switches = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const auto starts = two_targets_starts(setting, seed);
    const WatchRun descent = watch(setting, starts, false);
    const WatchRun rain = watch(setting, starts, true);
    for (const std::size_t robot : {0U, 1U}) {
      EXPECT_EQ(visits(setting, descent, robot).switches, 0) << "seed " << seed;
      EXPECT_EQ(visits(setting, descent, robot).home_share, 1.0) << "seed " << seed;
    }
    // The jammed robot gains nothing by moving, since its observations are lost.
    EXPECT_GT(visits(setting, rain, 1).switches, 0) << "seed " << seed;
    switches += visits(setting, rain, 0).switches;
  }
  EXPECT_GT(switches, 0);
}

}  // namespace
}  // namespace vantage::experiments
