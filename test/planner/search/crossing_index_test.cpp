#include "planner/search/crossing_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

TEST(PoseMetric, UsesTheShorterTurn) {
  const PoseMetric metric{2.0};
  for (const double yaw_rad : {-3.1, -2.0, -0.2, 0.0, 0.4, 2.5, kPi}) {
    for (const double turn_rad : {-3.0, -0.1, 0.0, 0.1, 3.0}) {
      const Pose2 a{0.0, 0.0, yaw_rad};
      const Pose2 b{3.0, -4.0, wrap_to_pi(yaw_rad + turn_rad)};
      const double expected_m2 = 25.0 + 4.0 * turn_rad * turn_rad;
      EXPECT_NEAR(metric.squared(a, b), expected_m2, 1e-12) << yaw_rad << " and " << turn_rad;
      EXPECT_NEAR(metric.squared(b, a), expected_m2, 1e-12) << yaw_rad << " and " << turn_rad;
    }
  }
}

TEST(PoseMetric, AtDeltaZeroRequiresEqualPoses) {
  const Pose2 a{1.0, -2.0, 0.5};
  for (const double weight_m_per_rad : {0.0, 1e-200, 0.3}) {
    const PoseMetric metric{weight_m_per_rad};
    EXPECT_TRUE(metric.crosses(a, a, 0.0));
    EXPECT_FALSE(metric.crosses(a, {1.0, -2.0, 0.6}, 0.0)) << weight_m_per_rad;
    EXPECT_FALSE(metric.crosses(a, {1.0 + 1e-200, -2.0 + 1e-12, 0.5}, 0.0)) << weight_m_per_rad;
    EXPECT_TRUE(metric.crosses(a, {1.3, -2.4, 0.5}, 0.5 + 1e-12));
    EXPECT_FALSE(metric.crosses(a, {1.3, -2.4, 0.5}, 0.5 - 1e-12));
    EXPECT_TRUE(metric.crosses(a, {9.0, 9.0, 3.0}, std::numeric_limits<double>::infinity()));
  }
}

std::vector<NodeId> near(const CrossingIndex& index, const Pose2& pose) {
  std::vector<NodeId> out;
  index.near(pose, [&](NodeId id) {
    out.push_back(id);
    return true;
  });
  std::sort(out.begin(), out.end());
  return out;
}

// Poses within δ are visited once; poses beyond 3 δ are not. This applies on all sides of the
// origin, after a reset and for any δ.
TEST(CrossingIndex, VisitsNearPosesAndNoFarOnes) {
  std::mt19937_64 rng(71);
  CrossingIndex index(600);
  for (int round = 0; round < 20; ++round) {
    const double delta_m = std::pow(10.0, test::uniform(rng, -2.0, 1.0));
    index.reset(delta_m);
    EXPECT_EQ(index.size(), 0U);
    std::vector<Pose2> poses;
    const int count = test::pick(rng, 1, 600);
    for (int i = 0; i < count; ++i) {
      poses.push_back(
          {delta_m * test::uniform(rng, -8.0, 8.0), delta_m * test::uniform(rng, -8.0, 8.0), 0.0});
      ASSERT_TRUE(index.insert(poses.back(), static_cast<NodeId>(5 + i)));
      ASSERT_EQ(index.size(), poses.size());
    }
    for (int i = 0; i < 100; ++i) {
      const Pose2 at{delta_m * test::uniform(rng, -9.0, 9.0),
                     delta_m * test::uniform(rng, -9.0, 9.0), 1.0};
      const std::vector<NodeId> visited = near(index, at);
      EXPECT_TRUE(std::adjacent_find(visited.begin(), visited.end()) == visited.end());
      for (std::size_t k = 0; k < poses.size(); ++k) {
        const double away_m = (poses[k].position_m() - at.position_m()).norm();
        const bool is_visited =
            std::binary_search(visited.begin(), visited.end(), static_cast<NodeId>(5 + k));
        EXPECT_TRUE(is_visited || away_m > delta_m);
        EXPECT_FALSE(is_visited && away_m > 3.0 * delta_m);
      }
    }
  }
}

TEST(CrossingIndex, StopsOnRequestAndReportsWhenItIsFull) {
  CrossingIndex index(3);
  index.reset(0.0);
  for (const NodeId id : {7U, 8U, 9U}) {
    EXPECT_TRUE(index.insert({1.0, -2.0, 0.0}, id));
  }
  EXPECT_FALSE(index.insert({1.0, -2.0, 0.0}, 10));
  EXPECT_EQ(index.size(), 3U);
  EXPECT_EQ(near(index, {1.0, -2.0, 0.0}), (std::vector<NodeId>{7, 8, 9}));
  int visited = 0;
  index.near({1.0, -2.0, 0.0}, [&](NodeId) { return ++visited < 2; });
  EXPECT_EQ(visited, 2);
  index.reset(0.0);
  EXPECT_TRUE(near(index, {1.0, -2.0, 0.0}).empty());
  EXPECT_TRUE(index.insert({1e300, -1e300, 0.0}, 1));  // extreme numbers
  EXPECT_EQ(near(index, {1e300, -1e300, 0.0}), (std::vector<NodeId>{1}));
  EXPECT_TRUE(near(index, {-1e300, -1e300, 0.0}).empty());
}

}  // namespace
}  // namespace vantage::planner
