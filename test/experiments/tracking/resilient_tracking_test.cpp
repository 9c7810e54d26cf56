#include "experiments/tracking/resilient_tracking.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

TEST(TrackUnderAttack, IsEqualForBothPlannersWithoutAttack) {
  const TrackingSetting setting{.robots = 2,
                                .targets = {.count = 3},
                                .attacks = 0,
                                .task_steps = 30,
                                .nodes_per_plan = 2'000};
  const TrackingRun cd = track_under_attack(setting, false, 4);
  const TrackingRun rain = track_under_attack(setting, true, 4);
  EXPECT_EQ(cd.rmse_m, rain.rmse_m);
  ASSERT_EQ(cd.rmse_m.size(), 30U);
}

// Checks the errors of each target over time and their consistency with the covariance, without
// attacks.
TEST(TrackUnderAttack, TracksEveryTargetWithoutAttack) {
  const TrackingSetting setting{
      .robots = 8, .targets = {.count = 4}, .attacks = 0, .task_steps = 250};
  double nees = 0.0;
  constexpr std::uint64_t kSeeds = 2;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TrackingRun run = track_under_attack(setting, false, seed);
    ASSERT_EQ(run.targets.size(), 250U);
    for (std::size_t m = 0; m < 4; ++m) {
      double squared_m2 = 0.0;
      int seen = 0;
      for (const std::vector<TargetStep>& targets : run.targets) {
        squared_m2 += targets[m].error_m * targets[m].error_m;
        nees += targets[m].nees;
        seen += targets[m].is_seen ? 1 : 0;
      }
      EXPECT_LT(std::sqrt(squared_m2 / 250.0), 1.0) << "seed " << seed << ", target " << m;
      EXPECT_GT(seen, 50) << "seed " << seed << ", target " << m;
    }
  }
  EXPECT_NEAR(nees / (4.0 * 250.0 * kSeeds), 4.0, 0.8);
}

// Each choice that the paper leaves open changes the result, though not for every seed.
TEST(TrackUnderAttack, ResultDependsOnEachUnpublishedChoice) {
  const TrackingSetting published{.robots = 4,
                                  .targets = {.count = 4},
                                  .attacks = 2,
                                  .task_steps = 150,
                                  .nodes_per_plan = 2'000};
  TrackingSetting by_bearing = published;
  by_bearing.bearing_noise = BearingNoise::kByBearing;
  TrackingSetting free = published;
  free.targets.beliefs_stay_inside = false;
  TrackingSetting together = published;
  together.attacker = planner::Attacker::kBestTogether;
  for (const TrackingSetting& other : {by_bearing, free, together}) {
    int differ = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      differ += track_under_attack(other, false, seed).rmse_m !=
                        track_under_attack(published, false, seed).rmse_m
                    ? 1
                    : 0;
    }
    EXPECT_GT(differ, 0);
  }
}

TEST(TrackUnderAttack, LearnsNothingWhenAllRobotsAreAttacked) {
  const TrackingSetting setting{.robots = 2,
                                .targets = {.count = 2},
                                .attacks = 2,
                                .task_steps = 50,
                                .nodes_per_plan = 2'000};
  const TrackingRun run = track_under_attack(setting, true, 4);
  for (std::size_t t = 1; t < run.entropy_nats.size(); ++t) {
    EXPECT_GE(run.entropy_nats[t], run.entropy_nats[t - 1] - 1e-9);
  }
}

}  // namespace
}  // namespace vantage::experiments
