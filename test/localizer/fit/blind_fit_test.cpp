#include "localizer/fit/blind_fit.hpp"

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "localizer/fit/sighted_response.hpp"
#include "test/localizer/simulated_team.hpp"

namespace vantage::localizer {
namespace {

/// Records the simulated team for `seconds`, without true poses. The frames' stamps are late by
/// the sensor's delay.
Recording recorded(test::SimulatedTeam& team, double seconds) {
  Recording recording(team.truth.size());
  for (int i = 0; i < static_cast<int>(seconds / test::SimulatedTeam::kStep_s); ++i) {
    team.step();
    for (std::size_t r = 0; r < recording.size(); ++r) {
      recording[r].odometry.push_back(team.commands[r]);
      if (!team.frames[r].empty()) {
        recording[r].frames.push_back({team.now, team.frames[r]});
      }
    }
  }
  return recording;
}

TEST(SightedResponse, RefusesTooFewPairs) {
  test::SimulatedTeam team(1, 1);
  const Recording recording = recorded(team, 2.0);
  EXPECT_THROW(static_cast<void>(sighted_response(team.spec.landmarks,
                                                  team.spec.robots[0].sightings, recording[0])),
               UsageError);
}

TEST(BlindFit, FindsDepthAndScaleWithoutTruePoses) {
  test::SimulatedTeam team(3, 6);
  const Recording recording = recorded(team, 120.0);
  scenario::LocalizerSpec spec = team.spec;
  for (scenario::LocalizedRobotSpec& robot : spec.robots) {
    robot.sightings = {};
    robot.drive = {};
  }
  const BlindFit fit = fit_without_truth(spec, recording);
  ASSERT_EQ(fit.sensors.size(), 3U);
  for (std::size_t r = 0; r < spec.robots.size(); ++r) {
    const scenario::SightingSpec& found = spec.robots[r].sightings;
    const scenario::SightingSpec& truth = team.spec.robots[r].sightings;
    EXPECT_TRUE(found.range_is_depth) << r;
    EXPECT_NEAR(found.range_scale, truth.range_scale, 0.02) << r;
    EXPECT_NEAR(found.range_offset_m, truth.range_offset_m, 0.1) << r;
    EXPECT_EQ(found.stamp_delay_s, 0.0) << r;
    EXPECT_EQ(fit.sensors[r].sensor.range_scale, found.range_scale) << r;
  }
}

TEST(BlindFit, RefusesRobotThatNeverFindsItsStart) {
  test::SimulatedTeam team(2, 6);
  Recording recording = recorded(team, 30.0);
  recording[1].frames.clear();
  EXPECT_THROW(static_cast<void>(fit_without_truth(team.spec, recording)), UsageError);
}

}  // namespace
}  // namespace vantage::localizer
