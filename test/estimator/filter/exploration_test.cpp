#include "models/belief/exploration.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/estimator/filter_support.hpp"

namespace vantage::models {
namespace {

using estimator::test::at;
using estimator::test::instant;

class ExplorationLandmarks : public ::testing::Test {
 protected:
  ExplorationLandmarks() {
    world_.bounds = {{-5.0, -5.0}, {5.0, 5.0}};
    world_.obstacles.push_back({{{1.0, 1.0}, {2.0, 3.0}}, 10.0});
    grid_ = VisibilityGrid(world_, 0.25, 30.0);
    sensor_.range_max_m = 2.0;
    spec_.landmark_spacing_m = 1.0;
    spec_.landmark_sigma_m = 0.5;
    spec_.landmarks_max = 6;
  }
  World world_;
  VisibilityGrid grid_;
  SensorModel sensor_;
  ExplorationSpec spec_;
};

TEST_F(ExplorationLandmarks, AreFrontiersInOrderOfDistance) {
  grid_.see(sensor_, at(0, 0), world_, instant(0));
  const Eigen::Vector2d from_m(0.5, -1.0);
  const auto landmarks = exploration_landmarks(grid_, spec_, from_m, instant(1));
  ASSERT_EQ(landmarks.size(), 6u);
  double last_m = 0.0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector2d l_m = landmarks[i].mean;
    EXPECT_NEAR(l_m.norm(), 2.0, 2.0 * 0.25);
    EXPECT_EQ(landmarks[i].covariance, 0.25 * Eigen::Matrix2d::Identity());
    EXPECT_GE((l_m - from_m).norm(), last_m);
    last_m = (l_m - from_m).norm();
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((l_m - Eigen::Vector2d(landmarks[j].mean)).norm(), 1.0);
    }
  }
}

TEST_F(ExplorationLandmarks, ReturnWhenTheMemoryExpires) {
  grid_.see(sensor_, at(0, 0), world_, instant(0));
  const auto before = exploration_landmarks(grid_, spec_, {0.0, 0.0}, instant(1));
  ASSERT_FALSE(before.empty());
  const Eigen::Vector2d explored_m = before.front().mean;
  grid_.see(sensor_, at(explored_m.x() + 0.1, explored_m.y()), world_, instant(2));
  spec_.landmarks_max = 1000;
  for (const Gaussian& l : exploration_landmarks(grid_, spec_, {0.0, 0.0}, instant(3))) {
    EXPECT_GT((Eigen::Vector2d(l.mean) - explored_m).norm(), 1.0);
  }
  sensor_.range_max_m = 100.0;
  world_.obstacles.clear();
  grid_.see(sensor_, at(0, 0), world_, instant(4));
  EXPECT_TRUE(exploration_landmarks(grid_, spec_, {0.0, 0.0}, instant(5)).empty());
  EXPECT_FALSE(exploration_landmarks(grid_, spec_, {0.0, 0.0}, instant(100)).empty());
}

TEST_F(ExplorationLandmarks, AreEmptyWhenTheLimitIsZero) {
  spec_.landmarks_max = 0;
  EXPECT_TRUE(exploration_landmarks(grid_, spec_, {0.0, 0.0}, instant(0)).empty());
}

/// A world of 10 × 10 m without obstacles, in regions of 5 m.
class UnexploredRegions : public ::testing::Test {
 protected:
  UnexploredRegions() {
    world_.bounds = {{-5.0, -5.0}, {5.0, 5.0}};
    grid_ = VisibilityGrid(world_, 0.25, 40.0);
    sensor_.range_max_m = 100.0;
  }
  World world_;
  VisibilityGrid grid_;
  SensorModel sensor_;
};

TEST_F(UnexploredRegions, AreAllEqualBeforeTheFirstScan) {
  const auto regions = unexplored_regions(grid_, 5.0, 10, instant(0));
  ASSERT_EQ(regions.size(), 4u);
  for (const UnexploredRegion& region : regions) {
    EXPECT_DOUBLE_EQ(region.share, 0.25);
    EXPECT_NEAR(std::abs(region.centre_m.x()), 2.5, 0.2);
    EXPECT_NEAR(std::abs(region.centre_m.y()), 2.5, 0.2);
  }
}

TEST_F(UnexploredRegions, GrowWithTheTimeSinceTheLastScan) {
  grid_.see(sensor_, at(0, 0), world_, instant(0));
  EXPECT_TRUE(unexplored_regions(grid_, 5.0, 10, instant(0)).empty());
  EXPECT_EQ(unexplored_regions(grid_, 5.0, 10, instant(10)).size(), 4u);
  // One quarter was scanned again 5 s ago; the others were last scanned 15 s ago.
  sensor_.range_max_m = 3.4;
  grid_.see(sensor_, at(2.5, 2.5), world_, instant(20));
  const auto regions = unexplored_regions(grid_, 5.0, 10, instant(30));
  ASSERT_EQ(regions.size(), 4u);
  double sum = 0.0;
  for (const UnexploredRegion& region : regions) {
    const bool is_seen = region.centre_m.x() > 0.0 && region.centre_m.y() > 0.0;
    EXPECT_NEAR(region.share, is_seen ? 1.0 / 82.0 : 27.0 / 82.0, 0.03);
    sum += region.share;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_EQ(grid_.unexplored_share(grid_.geometry().index_of({-4.0, -4.0}), instant(30)), 0.375);
  EXPECT_EQ(grid_.unexplored_share(grid_.geometry().index_of({-4.0, -4.0}), instant(99)), 1.0);
}

TEST_F(UnexploredRegions, KeepOnlyTheLargestUpToTheMaximumNumber) {
  world_.obstacles.push_back({{{-5.0, -5.0}, {0.0, 0.0}}, 10.0});
  world_.obstacles.push_back({{{0.0, 0.0}, {4.0, 5.0}}, 10.0});
  grid_ = VisibilityGrid(world_, 0.25, 40.0);
  const auto regions = unexplored_regions(grid_, 5.0, 2, instant(0));
  ASSERT_EQ(regions.size(), 2u);
  for (const UnexploredRegion& region : regions) {
    EXPECT_LT(region.centre_m.x() * region.centre_m.y(), 0.0) << "the free quarters";
    EXPECT_GT(region.share, 0.4);
  }
  EXPECT_TRUE(unexplored_regions(grid_, 5.0, 0, instant(0)).empty());
}

}  // namespace
}  // namespace vantage::models
