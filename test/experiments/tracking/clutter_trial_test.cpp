#include "experiments/tracking/clutter_trial.hpp"

#include <gtest/gtest.h>

#include "core/index.hpp"
#include "experiments/tracking/team_trial.hpp"

namespace vantage::experiments {
namespace {

ClutterScores scores(const models::DetectionModel& detection) {
  return track_in_clutter(scenario_of(TeamTrial{"lab.yaml"}, 1), detection, 60.0, 1);
}

const ClutterScore& of(const ClutterScores& scores, ClutterMethod method) {
  return scores[index(method)];
}

TEST(TrackInClutter, LabelledFilterIsCloseToKnownIdsWithoutClutter) {
  const ClutterScores all = scores({1.0, 0.0});
  const ClutterScore& known = of(all, ClutterMethod::kKnownIds);
  const ClutterScore& ours = of(all, ClutterMethod::kLabelled);
  EXPECT_GT(known.tracks, 4.5);
  EXPECT_NEAR(ours.tracks, known.tracks, 0.3);
  EXPECT_LT(ours.ospa_m, 1.4 * known.ospa_m);
}

TEST(TrackInClutter, LabelledFilterIsBestExceptForKnownIds) {
  const ClutterScores all = scores({0.9, 1.0});
  const double ours_m = of(all, ClutterMethod::kLabelled).ospa_m;
  EXPECT_LT(ours_m, of(all, ClutterMethod::kJpda).ospa_m);
  EXPECT_LT(ours_m, of(all, ClutterMethod::kNearest).ospa_m);
  EXPECT_GT(ours_m, of(all, ClutterMethod::kKnownIds).ospa_m);
}

TEST(TrackInClutter, DependsOnItsSeedOnly) {
  const ClutterScores one = scores({0.7, 2.0});
  const ClutterScores other = scores({0.7, 2.0});
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].ospa_m, other[i].ospa_m);
    EXPECT_EQ(one[i].swaps_per_min, other[i].swaps_per_min);
    EXPECT_EQ(one[i].matched_rmse_m, other[i].matched_rmse_m);
  }
}

}  // namespace
}  // namespace vantage::experiments
