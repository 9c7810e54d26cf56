#include "localizer/judge/judge.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "test/localizer/simulated_team.hpp"

namespace vantage::localizer {
namespace {

Time at(double s) { return from_utime(1'000'000'000'000) + from_seconds(s); }

TEST(TruePath, InterpolatesBetweenNearSamplesOnly) {
  TruePath path;
  path.add(at(0.0), {0.0, 0.0, 3.1});
  path.add(at(0.1), {0.2, 0.1, -3.1});
  path.add(at(0.5), {1.0, 1.0, 0.0});
  const auto middle = path.at(at(0.05));
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->x_m, 0.1, 1e-12);
  EXPECT_NEAR(std::abs(middle->yaw_rad), kPi, 1e-9);
  EXPECT_FALSE(path.at(at(0.3)));
  EXPECT_TRUE(path.at(at(0.5)));
  EXPECT_FALSE(path.at(at(-0.1)));
  EXPECT_FALSE(path.at(at(0.6)));
}

TEST(TruePath, IgnoresSamplesThatAreNotNewer) {
  TruePath path;
  path.add(at(1.0), {1.0, 0.0, 0.0});
  path.add(at(1.0), {9.0, 0.0, 0.0});
  path.add(at(0.5), {9.0, 0.0, 0.0});
  EXPECT_EQ(path.end(), at(1.0));
  EXPECT_EQ(path.at(at(1.0))->x_m, 1.0);
}

/// Records the simulated team for `seconds`.
Recording recorded(test::SimulatedTeam& team, double seconds) {
  Recording recording(team.truth.size());
  for (int i = 0; i < static_cast<int>(seconds / test::SimulatedTeam::kStep_s); ++i) {
    for (std::size_t r = 0; r < recording.size(); ++r) {
      recording[r].truth.add(team.now, team.truth[r]);
    }
    team.step();
    for (std::size_t r = 0; r < recording.size(); ++r) {
      recording[r].odometry.push_back(team.commands[r]);
      if (team.frames[r].empty()) {
        continue;
      }
      const Time stamp =
          team.frames[r].front().time + from_seconds(team.spec.robots[r].sightings.stamp_delay_s);
      recording[r].frames.push_back({stamp, team.frames[r]});
    }
  }
  return recording;
}

TEST(Judge, EvaluatesEveryRobotAtEveryInstant) {
  test::SimulatedTeam team(3, 1);
  const Recording recording = recorded(team, 30.0);
  const JudgeFigures figures = judge(team.spec, recording, {});
  EXPECT_NEAR(figures.position_m.count, 3 * 300, 6);
  EXPECT_EQ(figures.without_pose, 0);
  EXPECT_LT(figures.position_m.rmse, 0.15);
  EXPECT_LE(figures.position_m.median, figures.position_m.p95);
  EXPECT_LE(figures.position_m.p95, figures.position_m.max);
  EXPECT_GT(figures.bytes_per_robot_s, 0.0);
}

TEST(Judge, ErrorDecreasesWithLaterSightings) {
  test::SimulatedTeam team(3, 2);
  const Recording recording = recorded(team, 80.0);
  const double filtered_m = judge(team.spec, recording, {}).position_m.rmse;
  const double late_m = judge(team.spec, recording, {.hindsight_s = 10.0}).position_m.rmse;
  const JudgeFigures smoothed =
      judge(team.spec, recording, {.hindsight_s = std::numeric_limits<double>::infinity()});
  EXPECT_LT(late_m, filtered_m);
  EXPECT_LT(smoothed.position_m.rmse, 1.05 * late_m);
  EXPECT_NEAR(smoothed.position_m.count, 3 * 800, 12);
}

TEST(Judge, SkipsTheFirstMinuteAfterUnknownStart) {
  test::SimulatedTeam team(3, 3);
  const Recording recording = recorded(team, 80.0);
  const JudgeFigures figures = judge(team.spec, recording, {.is_start_known = false});
  EXPECT_NEAR(figures.position_m.count + figures.without_pose, 3 * 200, 6);
  for (const double placed_s : figures.placed_after_s) {
    EXPECT_GE(placed_s, 0.0);
  }
}

TEST(Judge, AlignsEstimatesWhenLandmarksAreHidden) {
  test::SimulatedTeam team(3, 4);
  team.spec.landmarks.clear();
  team.spec.unknown_landmarks_max = 12;
  Recording recording = recorded(team, 60.0);
  JudgeOptions options;
  options.hidden_landmarks = team.landmarks;
  const JudgeFigures figures = judge(team.spec, recording, options);
  EXPECT_GE(figures.landmarks_m.size(), 6U);
  EXPECT_LT(figures.position_m.rmse, 0.3);
  EXPECT_LE(figures.landmarks_own_rmse_m, figures.landmarks_rmse_m);
  // A rotation and translation of the truth changes nothing.
  const Pose2 moved_from_world{1.0, -2.0, 0.75};
  for (std::size_t r = 0; r < recording.size(); ++r) {
    TruePath moved;
    for (Time time = recording[r].truth.begin(); time <= recording[r].truth.end();
         time += std::chrono::milliseconds(100)) {
      moved.add(time, moved_from_world * *recording[r].truth.at(time));
    }
    recording[r].truth = moved;
  }
  for (scenario::LandmarkSpec& landmark : options.hidden_landmarks) {
    landmark.position_m = moved_from_world * landmark.position_m;
  }
  const JudgeFigures again = judge(team.spec, recording, options);
  EXPECT_NEAR(again.position_m.rmse, figures.position_m.rmse, 1e-6);
  EXPECT_NEAR(again.yaw_rad.rmse, figures.yaw_rad.rmse, 1e-6);
  EXPECT_NEAR(again.nees_pose, figures.nees_pose, 1e-3);
  EXPECT_NEAR(again.landmarks_rmse_m, figures.landmarks_rmse_m, 1e-6);
}

TEST(Judge, RefusesRecordingOfOtherTeam) {
  test::SimulatedTeam team(3, 1);
  EXPECT_THROW(static_cast<void>(judge(team.spec, Recording(2), {})), UsageError);
  EXPECT_THROW(static_cast<void>(judge(team.spec, Recording(3), {})), UsageError);
}

}  // namespace
}  // namespace vantage::localizer
