#include "localizer/team_filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "localizer/sighting_model.hpp"
#include "test/localizer/simulated_team.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::localizer {
namespace {

const Eigen::Matrix3d kStart = Eigen::Vector3d(0.04, 0.09, 0.01).asDiagonal();

models::Sighting sighting_of(const scenario::LocalizerSpec& spec, int robot, const Pose2& pose,
                             int id, const Eigen::Vector2d& point_m) {
  const ExpectedSighting expected =
      expected_sighting(spec.robots[static_cast<std::size_t>(robot)].sightings, pose, point_m);
  return {{}, id, expected.range_m, expected.bearing_rad};
}

TEST(TeamFilter, AgreesWithInformationFormForSightingOfTeammate) {
  // The expected covariance is P = (P0⁻¹ + Hᵀ R⁻¹ H)⁻¹ over the poses of both robots.
  test::SimulatedTeam team(2, 1);
  TeamFilter filter(team.spec);
  const Pose2 first{0.0, 0.0, 0.2};
  const Pose2 second{2.0, 0.5, 1.0};
  filter.place(0, first, kStart);
  filter.place(1, second, 2.0 * kStart);
  const models::Sighting sighting =
      sighting_of(team.spec, 0, first, team.spec.robots[1].id, second.position_m());
  filter.observe(0, {&sighting, 1});

  const ExpectedSighting expected =
      expected_sighting(team.spec.robots[0].sightings, first, second.position_m());
  const scenario::SightingNoiseSpec& noise = team.spec.sighting_noise;
  const double d = expected.distance_m;
  Eigen::Matrix2d R = Eigen::Matrix2d::Zero();
  R(0, 0) = std::pow(noise.range_sigma_m + noise.range_sigma_per_m * d * d, 2);
  R(1, 1) = std::pow(noise.bearing_sigma_rad, 2) + std::pow(noise.across_sigma_m / d, 2) +
            std::pow(noise.frame_bearing_sigma_rad, 2);
  R += std::pow(noise.teammate_sigma_m, 2) * expected.by_point * expected.by_point.transpose();
  Eigen::Matrix<double, 2, 6> H = Eigen::Matrix<double, 2, 6>::Zero();
  H.leftCols<3>() = expected.by_pose;
  H.middleCols<2>(3) = expected.by_point;
  Eigen::Matrix<double, 6, 6> P0 = Eigen::Matrix<double, 6, 6>::Zero();
  P0.topLeftCorner<3, 3>() = kStart;
  P0.bottomRightCorner<3, 3>() = 2.0 * kStart;
  const Eigen::Matrix<double, 6, 6> P = (P0.inverse() + H.transpose() * R.inverse() * H).inverse();
  EXPECT_LT((filter.covariance(0) - P.topLeftCorner<3, 3>()).norm(), 1e-12);
  EXPECT_LT((filter.covariance(1) - P.bottomRightCorner<3, 3>()).norm(), 1e-12);
  EXPECT_LT((filter.pose(0).position_m() - first.position_m()).norm(), 1e-9);
}

TEST(TeamFilter, StaysFiniteWhenAnUnknownLandmarkIsSightedAtTheSensor) {
  test::SimulatedTeam team(1, 1);
  team.spec.unknown_landmarks_max = 4;
  const scenario::SightingSpec& law = team.spec.robots[0].sightings;
  for (const double range_m : {1e-6, law.range_offset_m, law.range_offset_m + 1e-9}) {
    TeamFilter filter(team.spec);
    filter.place(0, {0.0, 0.0, 0.2}, kStart);
    for (int i = 0; i < 3; ++i) {
      const models::Sighting sighting{{}, 77, range_m, 0.3};
      filter.observe(0, {&sighting, 1});
      EXPECT_TRUE(filter.covariance(0).allFinite()) << range_m;
      EXPECT_TRUE(filter.pose(0).position_m().allFinite()) << range_m;
    }
    EXPECT_EQ(filter.counts().used, 0) << range_m;
  }
}

TEST(TeamFilter, LandmarkSightingAlsoImprovesTeammateThatSawTheRobot) {
  test::SimulatedTeam team(2, 1);
  TeamFilter filter(team.spec);
  const Pose2 first{0.0, 0.0, 0.0};
  const Pose2 second{2.0, 0.0, 0.0};
  filter.place(0, first, kStart);
  filter.place(1, second, kStart);
  const models::Sighting meeting =
      sighting_of(team.spec, 0, first, team.spec.robots[1].id, second.position_m());
  filter.observe(0, {&meeting, 1});
  const double before = filter.covariance(0).determinant();
  const models::Sighting landmark = sighting_of(team.spec, 1, second, team.spec.landmarks[0].id,
                                                team.spec.landmarks[0].position_m);
  filter.observe(1, {&landmark, 1});
  EXPECT_LT(filter.covariance(0).determinant(), 0.7 * before);
}

TEST(TeamFilter, FollowsOdometryWithoutSightings) {
  test::SimulatedTeam team(1, 1);
  TeamFilter filter(team.spec);
  filter.place(0, {1.0, 2.0, kPi / 2.0}, kStart);
  const Eigen::Vector3d increment(0.5, 0.1, 0.3);
  filter.advance(0.1, {&increment, 1});
  EXPECT_NEAR(filter.pose(0).x_m, 0.9, 1e-12);
  EXPECT_NEAR(filter.pose(0).y_m, 2.5, 1e-12);
  EXPECT_NEAR(filter.pose(0).yaw_rad, kPi / 2.0 + 0.3, 1e-12);
  EXPECT_GT(filter.covariance(0)(2, 2), kStart(2, 2));
}

TEST(TeamFilter, RejectsSightingBeyondTheGateAndKeepsItsPose) {
  test::SimulatedTeam team(1, 1);
  TeamFilter filter(team.spec);
  const Pose2 pose{0.0, 0.0, 0.0};
  filter.place(0, pose, 1e-4 * Eigen::Matrix3d::Identity());
  models::Sighting wrong =
      sighting_of(team.spec, 0, pose, team.spec.landmarks[0].id, team.spec.landmarks[0].position_m);
  wrong.range_m -= 2.0;
  filter.observe(0, {&wrong, 1});
  EXPECT_EQ(filter.counts().rejected, 1);
  EXPECT_EQ(filter.pose(0), pose);
}

TEST(TeamFilter, RecoversFromSlipOfTheWheels) {
  test::SimulatedTeam team(1, 1);
  TeamFilter filter(team.spec);
  const Pose2 truth{0.0, 0.0, 0.5};
  filter.place(0, {0.0, 0.0, 0.0}, 1e-4 * Eigen::Matrix3d::Identity());
  for (int i = 0; i < 5; ++i) {
    std::vector<models::Sighting> frame;
    for (const int k : {0, 1, 2}) {
      const scenario::LandmarkSpec& landmark = team.spec.landmarks[static_cast<std::size_t>(k)];
      frame.push_back(sighting_of(team.spec, 0, truth, landmark.id, landmark.position_m));
    }
    filter.observe(0, frame);
  }
  EXPECT_GE(filter.counts().slips, 1);
  EXPECT_NEAR(filter.pose(0).yaw_rad, 0.5, 0.03);
}

TEST(TeamFilter, CountsUnusableSightings) {
  test::SimulatedTeam team(2, 1);
  TeamFilter filter(team.spec);
  const models::Sighting of_mate{{}, 2, 1.0, 0.0};
  const models::Sighting of_stranger{{}, 77, 1.0, 0.0};
  filter.observe(0, {&of_mate, 1});
  EXPECT_EQ(filter.counts().unplaced, 1);
  filter.place(0, {}, kStart);
  filter.observe(0, {&of_mate, 1});
  EXPECT_EQ(filter.counts().unplaced, 2);
  filter.observe(0, {&of_stranger, 1});
  EXPECT_EQ(filter.counts().unknown, 1);
  EXPECT_EQ(filter.counts().used, 0);
}

/// Runs the filter on the simulated team for `steps` steps and returns it. With `without_ids`, the
/// sightings have no id.
TeamFilter filter_after(test::SimulatedTeam& team, int steps, std::vector<double>* nees = nullptr,
                        bool without_ids = false) {
  TeamFilter filter(team.spec);
  std::vector<CommandedMotion> motions;
  for (int r = 0; r < filter.robots(); ++r) {
    filter.place(r, team.truth[static_cast<std::size_t>(r)], 1e-4 * Eigen::Matrix3d::Identity());
    motions.emplace_back(team.spec.robots[static_cast<std::size_t>(r)].drive);
    static_cast<void>(motions.back().advance_to(team.now));
  }
  std::vector<Eigen::Vector3d> increments(motions.size());
  for (int i = 0; i < steps; ++i) {
    team.step();
    for (std::vector<models::Sighting>& frame : team.frames) {
      for (models::Sighting& sighting : frame) {
        sighting.id = without_ids ? kNoBodyId : sighting.id;
      }
    }
    for (std::size_t r = 0; r < motions.size(); ++r) {
      motions[r].command(team.commands[r].stamp.time, team.commands[r].motion_body.x(),
                         team.commands[r].motion_body.z());
      increments[r] = motions[r].advance_to(team.now);
    }
    filter.advance(test::SimulatedTeam::kStep_s, increments);
    for (int r = 0; r < filter.robots(); ++r) {
      filter.observe(r, team.frames[static_cast<std::size_t>(r)]);
    }
    for (int r = 0; nees != nullptr && i % 20 == 0 && r < filter.robots(); ++r) {
      const Eigen::Vector2d error =
          filter.pose(r).position_m() - team.truth[static_cast<std::size_t>(r)].position_m();
      const Eigen::Matrix2d P = filter.covariance(r).topLeftCorner<2, 2>();
      nees->push_back(error.dot(P.inverse() * error));
    }
  }
  return filter;
}

TEST(TeamFilter, IsConsistentWithItsCovariance) {
  std::vector<double> nees;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    test::SimulatedTeam team(3, seed);
    filter_after(team, 600, &nees);
  }
  double sum = 0.0;
  for (const double each : nees) {
    sum += each;
  }
  const double mean = sum / static_cast<double>(nees.size());
  EXPECT_GT(mean, 1.6);  // ideal: 2
  EXPECT_LT(mean, 2.6);
}

/// Returns the largest position error of the robots, m.
double worst_m(const TeamFilter& filter, const test::SimulatedTeam& team) {
  double worst = 0.0;
  for (int r = 0; r < filter.robots(); ++r) {
    const Eigen::Vector2d error =
        filter.pose(r).position_m() - team.truth[static_cast<std::size_t>(r)].position_m();
    worst = std::max(worst, error.norm());
  }
  return worst;
}

TEST(TeamFilter, AssignsSightingsWithoutIds) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    test::SimulatedTeam team(3, seed);
    const TeamFilter filter = filter_after(team, 600, nullptr, true);
    EXPECT_LT(worst_m(filter, team), 0.3) << seed;
    const FilterCounts& counts = filter.counts();
    EXPECT_GT(counts.matched, 20 * (counts.ambiguous + counts.unmatched)) << seed;
    EXPECT_EQ(counts.unknown, 0) << seed;
  }
}

TEST(TeamFilter, UsesNoSightingThatFitsTwoBodies) {
  test::SimulatedTeam team(1, 1);
  team.spec.landmarks = {{1001, {3.0, 0.2}}, {1002, {3.0, -0.2}}};
  TeamFilter filter(team.spec);
  filter.place(0, {}, kStart);
  models::Sighting sighting = sighting_of(team.spec, 0, {}, 0, {3.0, 0.0});
  sighting.id = kNoBodyId;
  filter.observe(0, {&sighting, 1});
  EXPECT_EQ(filter.counts().ambiguous, 1);
  EXPECT_EQ(filter.counts().used, 0);
  EXPECT_EQ(filter.covariance(0), kStart);
}

TEST(TeamFilter, UsesNoSightingThatFitsNoBody) {
  test::SimulatedTeam team(1, 1);
  TeamFilter filter(team.spec);
  filter.place(0, {}, 1e-4 * Eigen::Matrix3d::Identity());
  const models::Sighting sighting{{}, kNoBodyId, 2.0, 0.0};
  filter.observe(0, {&sighting, 1});
  EXPECT_EQ(filter.counts().unmatched, 1);
  EXPECT_EQ(filter.counts().used, 0);
}

TEST(TeamFilter, AssignsSightingsThatOnlyTogetherAreUnambiguous) {
  // Each sighting alone fits both landmarks, because the heading is uncertain.
  test::SimulatedTeam team(1, 1);
  team.spec.landmarks = {{1001, {3.0, 0.35}}, {1002, {3.0, -0.35}}, {1003, {4.0, 1.2}}};
  TeamFilter filter(team.spec);
  filter.place(0, {}, Eigen::Vector3d(1e-4, 1e-4, 0.04).asDiagonal());
  const Pose2 truth{0.0, 0.0, 0.15};
  std::vector<models::Sighting> frame;
  for (const scenario::LandmarkSpec& landmark : team.spec.landmarks) {
    frame.push_back(sighting_of(team.spec, 0, truth, kNoBodyId, landmark.position_m));
  }
  filter.observe(0, frame);
  EXPECT_EQ(filter.counts().matched, 3);
  EXPECT_NEAR(filter.pose(0).yaw_rad, 0.15, 0.02);
}

/// Moves the landmarks of `team` from its map to the returned list.
std::vector<scenario::LandmarkSpec> hide_landmarks(test::SimulatedTeam& team) {
  std::vector<scenario::LandmarkSpec> hidden = std::move(team.spec.landmarks);
  team.spec.landmarks.clear();
  team.spec.unknown_landmarks_max = static_cast<int>(hidden.size());
  return hidden;
}

TEST(TeamFilter, MapsUnknownLandmarks) {
  test::SimulatedTeam team(3, 5);
  const std::vector<scenario::LandmarkSpec> hidden = hide_landmarks(team);
  const TeamFilter filter = filter_after(team, 600);
  EXPECT_LT(worst_m(filter, team), 0.4);
  int mapped = 0;
  for (std::size_t k = 0; k < filter.mapped().size(); ++k) {
    for (const scenario::LandmarkSpec& landmark : hidden) {
      if (landmark.id == filter.mapped()[k]) {
        const int at = static_cast<int>(k);
        const Eigen::Vector2d error = filter.landmark_m(at) - landmark.position_m;
        EXPECT_LT(error.dot(filter.landmark_covariance(at).inverse() * error), 16.0) << landmark.id;
        ++mapped;
      }
    }
  }
  EXPECT_GE(mapped, 6);
  EXPECT_EQ(filter.counts().unknown, 0);
}

TEST(TeamFilter, MapsAtMostTheGivenNumberOfLandmarks) {
  test::SimulatedTeam team(3, 5);
  hide_landmarks(team);
  team.spec.unknown_landmarks_max = 2;
  const TeamFilter filter = filter_after(team, 300);
  EXPECT_EQ(filter.mapped().size(), 2U);
  EXPECT_GT(filter.counts().unknown, 0);
}

TEST(TeamFilter, MapsLandmarkAgainAfterWrongFirstSighting) {
  test::SimulatedTeam team(1, 1);
  const std::vector<scenario::LandmarkSpec> hidden = hide_landmarks(team);
  TeamFilter filter(team.spec);
  filter.place(0, {}, 1e-4 * Eigen::Matrix3d::Identity());
  const models::Sighting wrong = sighting_of(team.spec, 0, {}, 1001, {5.0, 1.0});
  const models::Sighting right = sighting_of(team.spec, 0, {}, 1001, {2.0, 0.5});
  filter.observe(0, {&wrong, 1});
  filter.observe(0, {&right, 1});
  filter.observe(0, {&right, 1});
  EXPECT_LT((filter.landmark_m(0) - Eigen::Vector2d(2.0, 0.5)).norm(), 1e-6);
}

TEST(TeamFilter, IsDeterministic) {
  test::SimulatedTeam first(3, 9);
  test::SimulatedTeam second(3, 9);
  EXPECT_EQ(filter_after(first, 100).state(), filter_after(second, 100).state());
}

TEST(TeamFilter, AllocatesNothingPerStep) {
  test::SimulatedTeam team(5, 3);
  TeamFilter filter = filter_after(team, 50);
  TeamFilter copy(team.spec);
  std::vector<Eigen::Vector3d> increments(5, Eigen::Vector3d(0.01, 0.0, 0.01));
  const test::AllocationCounter allocations;
  filter.advance(0.1, increments);
  for (int r = 0; r < filter.robots(); ++r) {
    filter.observe(r, team.frames[static_cast<std::size_t>(r)]);
  }
  copy.assign(filter);
  EXPECT_EQ(allocations.count(), 0U);
  EXPECT_GT(filter.counts().used, 0);
}

TEST(TeamFilter, AllocatesNothingForUnknownLandmarksOrWithoutIds) {
  test::SimulatedTeam team(5, 3);
  hide_landmarks(team);
  TeamFilter filter = filter_after(team, 50);
  for (std::vector<models::Sighting>& frame : team.frames) {
    for (std::size_t k = 1; k < frame.size(); k += 2) {
      frame[k].id = kNoBodyId;
    }
  }
  const models::Sighting first{{}, 12345, 2.0, 0.1};
  const test::AllocationCounter allocations;
  for (int r = 0; r < filter.robots(); ++r) {
    filter.observe(r, team.frames[static_cast<std::size_t>(r)]);
  }
  filter.observe(0, {&first, 1});
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace vantage::localizer
