#include "planner/problem/sight.hpp"

#include <random>

#include <gtest/gtest.h>

#include "planner/problem/belief_table.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::uniform;

Views random_views(std::mt19937_64& rng, std::vector<Pose2>& poses) {
  Views views;
  views.count = test::pick(rng, 1, kMaxControls);
  poses.clear();
  for (int i = 0; i < views.count; ++i) {
    const Pose2 pose{uniform(rng, -6.0, 6.0), uniform(rng, -6.0, 6.0), uniform(rng, -kPi, kPi)};
    poses.push_back(pose);
    views.x_m[i] = pose.x_m;
    views.y_m[i] = pose.y_m;
    views.cos_yaw[i] = std::cos(pose.yaw_rad);
    views.sin_yaw[i] = std::sin(pose.yaw_rad);
  }
  return views;
}

models::PositionMatrix from_models(const SearchProblem& problem, const Pose2& at,
                                   const models::PositionVector& target_m) {
  models::PositionMatrix M = models::PositionMatrix::Zero(target_m.rows(), target_m.rows());
  for (const models::SensorModel& sensor : problem.sensors) {
    M += models::information(sensor, {at, problem.height_m}, target_m);
  }
  return M;
}

TEST(SightTable, LanesEqualTheModels) {
  std::mt19937_64 rng(41);
  SightTable sight;
  int seen_count = 0;
  int unseen_count = 0;
  std::vector<Pose2> poses;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    sight.reset(owned.problem);
    if (!sight.has_lanes()) {
      continue;
    }
    const Views views = random_views(rng, poses);
    const Eigen::Vector3d target_m(uniform(rng, -5.0, 5.0), uniform(rng, -5.0, 5.0), 0.0);
    for (int i = 0; i < views.count; ++i) {
      InformationLanes lanes = {};  // not written if no view of the group sees the target
      const LaneMask seen = sight.compute_lanes(target_m, views, i / kLanes, lanes);
      const int lane = i % kLanes;
      const models::PositionMatrix M =
          from_models(owned.problem, poses[static_cast<std::size_t>(i)], target_m.head<2>());
      const double slack = 1e-11 * std::max(1.0, M.norm());
      ASSERT_EQ(seen[lane] != 0, !M.isZero(0.0)) << "seed " << seed;
      EXPECT_NEAR(lanes.m00[lane], M(0, 0), slack) << "seed " << seed;
      EXPECT_NEAR(lanes.m01[lane], M(0, 1), slack) << "seed " << seed;
      EXPECT_NEAR(lanes.m11[lane], M(1, 1), slack) << "seed " << seed;
      ++(seen[lane] != 0 ? seen_count : unseen_count);
    }
  }
  EXPECT_GT(seen_count, 1'000);
  EXPECT_GT(unseen_count, 1'000);
}

TEST(SightTable, SingleQueriesEqualTheModels) {
  std::mt19937_64 rng(42);
  SightTable sight;
  int seen_count = 0;
  std::vector<Pose2> poses;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    sight.reset(owned.problem);
    const Views views = random_views(rng, poses);
    const bool spatial = test::pick(rng, 0, 1) == 1;
    const Eigen::Vector3d target_m(uniform(rng, -5.0, 5.0), uniform(rng, -5.0, 5.0),
                                   spatial ? uniform(rng, 0.0, 1.0) : 0.0);
    for (int i = 0; i < views.count; ++i) {
      const Pose2& at = poses[static_cast<std::size_t>(i)];
      const models::PositionMatrix M =
          from_models(owned.problem, at, target_m.head(spatial ? 3 : 2));
      const bool hidden =
          sight_world(owned.problem) != nullptr &&
          !models::line_of_sight(*owned.problem.world, at.position_m(), target_m.head<2>());
      PackedInformation packed;
      const bool seen = sight.add_information(
          target_m, Eigen::Vector2d::Zero(), spatial ? BlockLayout::kSpatial : BlockLayout::kPlanar,
          at, views.cos_yaw[i], views.sin_yaw[i], packed);
      ASSERT_EQ(seen, !M.isZero(0.0) && !hidden) << "seed " << seed;
      if (!seen) {
        continue;
      }
      ++seen_count;
      const int last = spatial ? 5 : 2;
      const double slack = 1e-10 * std::max(1.0, M.norm());
      EXPECT_NEAR(packed.m[0], M(0, 0), slack) << "seed " << seed;
      EXPECT_NEAR(packed.m[1], M(0, 1), slack) << "seed " << seed;
      EXPECT_NEAR(packed.m[last], M(M.rows() - 1, M.rows() - 1), slack) << "seed " << seed;
    }
  }
  EXPECT_GT(seen_count, 1'000);
}

TEST(SightTable, StateInformationEqualsTheModels) {
  std::mt19937_64 rng(43);
  SightTable sight;
  int seen_count = 0;
  std::vector<Pose2> poses;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    OwnedProblem owned = test::random_problem(seed);
    owned.problem.world = nullptr;
    owned.problem.field = nullptr;
    owned.problem.sensors[0].kind = models::SensorKind::kRangeRate;
    sight.reset(owned.problem);
    ASSERT_FALSE(sight.has_lanes());
    const Views views = random_views(rng, poses);
    models::StateVector state(4);
    state << uniform(rng, -5.0, 5.0), uniform(rng, -5.0, 5.0), uniform(rng, -1.0, 1.0),
        uniform(rng, -1.0, 1.0);
    const Eigen::Vector3d target_m(state(0), state(1), 0.0);
    for (int i = 0; i < views.count; ++i) {
      const Pose2& at = poses[static_cast<std::size_t>(i)];
      models::StateMatrix M = models::StateMatrix::Zero(4, 4);
      for (const models::SensorModel& sensor : owned.problem.sensors) {
        M += models::state_information(sensor, {at, owned.problem.height_m}, state);
      }
      PackedInformation packed;
      const bool seen = sight.add_information(target_m, state.tail<2>(), BlockLayout::kMoving, at,
                                              views.cos_yaw[i], views.sin_yaw[i], packed);
      ASSERT_EQ(seen, !M.isZero(0.0)) << "seed " << seed;
      if (!seen) {
        continue;
      }
      ++seen_count;
      EXPECT_TRUE(unpack(BlockLayout::kMoving, packed.m).isApprox(M, 1e-10)) << "seed " << seed;
    }
  }
  EXPECT_GT(seen_count, 1'000);
}

TEST(SightTable, LineOfSightDoesNotDependOnTheDistanceField) {
  std::mt19937_64 rng(44);
  SightTable sight;
  int clear = 0;
  int hidden = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    if (owned.field == nullptr || owned.world->obstacles.empty() ||
        sight_world(owned.problem) == nullptr) {
      continue;
    }
    sight.reset(owned.problem);
    ASSERT_TRUE(sight.has_obstacles());
    for (int i = 0; i < 200; ++i) {  // some are outside the walls, beyond the field
      const Eigen::Vector2d a_m(uniform(rng, -7.0, 7.0), uniform(rng, -7.0, 7.0));
      const Eigen::Vector2d b_m(uniform(rng, -7.0, 7.0), uniform(rng, -7.0, 7.0));
      const bool expected = models::line_of_sight(*owned.world, a_m, b_m);
      ASSERT_EQ(sight.line_of_sight(a_m, b_m), expected) << "seed " << seed;
      ++(expected ? clear : hidden);
    }
  }
  EXPECT_GT(clear, 1'000);
  EXPECT_GT(hidden, 1'000);
}

// The result in a lane must not depend on the lane or on the other lanes.
TEST(SightTable, LanesAreBitIdentical) {
  std::mt19937_64 rng(43);
  SightTable sight;
  std::vector<Pose2> poses;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    sight.reset(owned.problem);
    if (!sight.has_lanes()) {
      continue;
    }
    Views views = random_views(rng, poses);
    const Eigen::Vector3d target_m(uniform(rng, -5.0, 5.0), uniform(rng, -5.0, 5.0), 0.0);
    InformationLanes first;
    const LaneMask seen = sight.compute_lanes(target_m, views, 0, first);
    std::swap(views.x_m[0], views.x_m[3]);
    std::swap(views.y_m[0], views.y_m[3]);
    std::swap(views.cos_yaw[0], views.cos_yaw[3]);
    std::swap(views.sin_yaw[0], views.sin_yaw[3]);
    InformationLanes swapped;
    const LaneMask seen_swapped = sight.compute_lanes(target_m, views, 0, swapped);
    EXPECT_EQ(seen[0], seen_swapped[3]);
    EXPECT_EQ(first.m00[0], swapped.m00[3]);
    EXPECT_EQ(first.m01[0], swapped.m01[3]);
    EXPECT_EQ(first.m11[0], swapped.m11[3]);
  }
}

}  // namespace
}  // namespace vantage::planner
