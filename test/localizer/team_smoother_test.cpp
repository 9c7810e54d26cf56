#include "localizer/team_smoother.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "localizer/sighting_model.hpp"
#include "test/localizer/simulated_team.hpp"

namespace vantage::localizer {
namespace {

/// Drives straight without sightings and then sees landmarks from a known pose.
struct BlindDrive {
  explicit BlindDrive(int steps) : filter(team.spec) {
    filter.place(0, {0.0, 0.0, 0.0}, Eigen::Vector3d(0.25, 0.25, 0.01).asDiagonal());
    const Eigen::Vector3d increment(0.02, 0.0, 0.0);
    for (int i = 0; i < steps; ++i) {
      smoother.begin_step(filter, team.now);
      filter.advance(0.1, {&increment, 1});
      smoother.end_step(filter);
      team.now += from_seconds(0.1);
    }
    final_pose = filter.pose(0);
    final_pose.y_m += 0.3;  // the true course is left of the assumed one
    std::vector<models::Sighting> frame;
    for (const std::size_t k : {0U, 1U, 11U}) {
      const scenario::LandmarkSpec& landmark = team.spec.landmarks[k];
      const ExpectedSighting expected =
          expected_sighting(team.spec.robots[0].sightings, final_pose, landmark.position_m);
      frame.push_back({{}, landmark.id, expected.range_m, expected.bearing_rad});
    }
    filter.observe(0, frame);
  }
  test::SimulatedTeam team{1, 1};
  TeamFilter filter;
  TeamSmoother smoother;
  Pose2 final_pose;
};

TEST(TeamSmoother, CorrectsEarlierPosesByLaterSightings) {
  const BlindDrive drive(50);
  int steps = 0;
  double first_y_m = 0.0;
  drive.smoother.smooth(drive.filter,
                        [&](Time, const Eigen::VectorXd& state, const Eigen::MatrixXd& P) {
                          ++steps;
                          first_y_m = state(1);
                          EXPECT_LT(P(0, 0), 0.25);
                        });
  EXPECT_EQ(steps, 50);
  EXPECT_NEAR(first_y_m, 0.3, 0.15);
}

TEST(TeamSmoother, AgreesWithFilterIfMotionIsExact) {
  // Without process noise the smoothed start is the final pose minus the motion.
  test::SimulatedTeam team(1, 1);
  team.spec.odometry_noise = {0.0, 0.0, 0.0, 1e-9, 10.0, 1e-9, 10.0};
  TeamFilter filter(team.spec);
  TeamSmoother smoother;
  filter.place(0, {0.0, 0.0, 0.0}, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal());
  const Eigen::Vector3d increment(0.02, 0.0, 0.0);
  for (int i = 0; i < 30; ++i) {
    smoother.begin_step(filter, team.now);
    filter.advance(0.1, {&increment, 1});
    smoother.end_step(filter);
  }
  const scenario::LandmarkSpec& landmark = team.spec.landmarks[0];
  const ExpectedSighting expected =
      expected_sighting(team.spec.robots[0].sightings, {0.6, 0.1, 0.0}, landmark.position_m);
  const models::Sighting sighting{{}, landmark.id, expected.range_m, expected.bearing_rad};
  filter.observe(0, {&sighting, 1});
  Pose2 start;
  smoother.smooth(filter, [&](Time, const Eigen::VectorXd& state, const Eigen::MatrixXd&) {
    start = {state(0), state(1), state(2)};
  });
  const Pose2 moved = start * Pose2{0.6, 0.0, 0.0};
  // The linearisation of 30 steps differs from the exact motion by the square of the correction.
  EXPECT_NEAR(moved.x_m, filter.pose(0).x_m, 1e-3);
  EXPECT_NEAR(moved.y_m, filter.pose(0).y_m, 1e-3);
  EXPECT_NEAR(moved.yaw_rad, filter.pose(0).yaw_rad, 1e-6);
}

TEST(TeamSmoother, ForgetsOldSteps) {
  BlindDrive drive(50);
  drive.smoother.forget_before(drive.team.now - from_seconds(1.0));
  int steps = 0;
  drive.smoother.smooth(drive.filter,
                        [&](Time, const Eigen::VectorXd&, const Eigen::MatrixXd&) { ++steps; });
  EXPECT_EQ(steps, 10);
}

}  // namespace
}  // namespace vantage::localizer
