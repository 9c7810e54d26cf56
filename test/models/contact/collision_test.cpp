#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "models/contact/collision_monitor.hpp"
#include "models/contact/shapes.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::models {
namespace {

constexpr Time kNow = from_utime(1'000'000);

World lab() { return test::lab_scenario().world; }

std::vector<CollisionMonitor::Body> two_robots() {
  return {{"Q1", 0.25, true}, {"Q2", 0.25, true}};
}

std::vector<ContactReport> update(CollisionMonitor& monitor,
                                  const std::vector<Eigen::Vector3d>& centres_m) {
  std::vector<ContactReport> begun;
  monitor.update(kNow, centres_m, begun);
  return begun;
}

TEST(SignedDistance, IsThatOfTheNearestSampledSurfacePoint) {
  const Box3 box{{-0.5, -0.25, 0.0}, {0.5, 0.25, 1.0}};
  EXPECT_DOUBLE_EQ(signed_distance_m(box, {0.0, 0.0, 0.9}), -0.1);
  EXPECT_DOUBLE_EQ(signed_distance_m(box, {0.5 + 3.0, 0.25 + 4.0, 0.5}), 5.0);
  EXPECT_DOUBLE_EQ(signed_distance_m(box, {0.5, 0.0, 0.5}), 0.0);
}

TEST(SweptDistance, AgreesWithDenseSampling) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(-2.0, 2.0);
  const Box3 box{{-0.5, -0.25, -0.4}, {0.5, 0.25, 1.0}};
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3d a(u(rng), u(rng), u(rng));
    const Eigen::Vector3d b(u(rng), u(rng), u(rng));
    double sampled_m = 1e9;
    for (int k = 0; k <= 2000; ++k) {
      sampled_m = std::min(sampled_m, signed_distance_m(box, a + k / 2000.0 * (b - a)));
    }
    const double swept_m = swept_distance_m(box, a, b);
    EXPECT_LE(swept_m, sampled_m + 1e-9);
    EXPECT_GE(swept_m, sampled_m - (b - a).norm() / 2000.0);
  }
}

TEST(CollisionMonitor, FclAndClosedFormAgreeOnRandomPoses) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> x(-0.5, 4.5);
  std::uniform_real_distribution<double> y(-0.5, 8.5);
  std::uniform_real_distribution<double> z(-0.2, 3.3);
  const World world = lab();
  std::int64_t hits = 0;
  // A monitor of its own for each draw: no motion, no hysteresis, so a report is the truth.
  for (int trial = 0; trial < 3000; ++trial) {
    CollisionMonitor monitor(world, {{"A", 0.25, false}, {"B", 0.4, false}}, 0.6);
    const Eigen::Vector3d a(x(rng), y(rng), z(rng));
    const Eigen::Vector3d b = trial % 2 == 0 ? Eigen::Vector3d(x(rng), y(rng), z(rng))
                                             : Eigen::Vector3d(a.x() + 0.3 * z(rng), a.y(), a.z());
    const std::vector<ContactReport> begun = update(monitor, {a, b});
    std::int64_t expected = (a - b).norm() <= 0.65 ? 1 : 0;
    for (const auto& [centre, radius] : {std::pair(a, 0.25), std::pair(b, 0.4)}) {
      for (const Obstacle& obstacle : world.obstacles) {
        expected += signed_distance_m(box_of(obstacle), centre) <= radius ? 1 : 0;
      }
      expected += distance_to_bounds_m(world, centre) <= radius ? 1 : 0;
    }
    EXPECT_EQ(static_cast<std::int64_t>(begun.size()), expected);
    EXPECT_EQ(monitor.disagreements(), 0);
    hits += expected;
  }
  EXPECT_GT(hits, 1000) << "the poses hardly ever touched: nothing was tested";
}

TEST(CollisionMonitor, CatchesWhatTunnelsBetweenTwoSteps) {
  CollisionMonitor robots(lab(), two_robots(), 0.0);
  EXPECT_TRUE(update(robots, {{1.0, 4.0, 1.0}, {3.0, 4.0, 1.0}}).empty());
  const auto crossed = update(robots, {{3.0, 4.0, 1.0}, {1.0, 4.0, 1.0}});
  ASSERT_EQ(crossed.size(), 1u);
  EXPECT_EQ(crossed[0].kind, ContactKind::kCollision);
  EXPECT_NEAR(crossed[0].distance_m, -0.5, 1e-12);
  EXPECT_NEAR(robots.min_separation_m(), 0.0, 1e-12);

  CollisionMonitor box(lab(), {{"ROVER1", 0.2, false}}, 0.6);
  EXPECT_TRUE(update(box, {{0.5, 2.75, 0.0}}).empty());
  const auto through = update(box, {{2.2, 2.75, 0.0}});
  ASSERT_EQ(through.size(), 1u);
  EXPECT_EQ(through[0].body_b, "obstacle:0");
  EXPECT_TRUE(update(box, {{2.3, 2.75, 0.0}}).empty());
}

TEST(CollisionMonitor, FliesOverALowBox) {
  CollisionMonitor monitor(lab(), {{"Q1", 0.25, true}}, 0.6);
  EXPECT_TRUE(update(monitor, {{0.5, 2.75, 0.76}}).empty());
  EXPECT_TRUE(update(monitor, {{2.2, 2.75, 0.76}}).empty());
  EXPECT_EQ(update(monitor, {{0.5, 2.75, 0.74}}).size(), 1u);
}

TEST(CollisionMonitor, ReportsAContactOnceUntilItHasEnded) {
  CollisionMonitor monitor(lab(), two_robots(), 0.0);
  const Eigen::Vector3d still(1.0, 4.0, 1.0);
  const auto beside = [&](double gap_m) {
    return update(monitor, {still, still + Eigen::Vector3d(0.5 + gap_m, 0.0, 0.0)}).size();
  };
  EXPECT_EQ(beside(0.1), 0u);
  EXPECT_EQ(beside(-0.01), 1u);
  EXPECT_EQ(beside(-0.02), 0u);
  EXPECT_EQ(beside(0.01), 0u) << "apart, but not by enough to count as ended";
  EXPECT_EQ(beside(-0.01), 0u);
  EXPECT_EQ(beside(0.03), 0u);
  EXPECT_EQ(beside(-0.01), 1u);
}

// However long they stay so near that it does not count as parted, it is one contact; each time.
TEST(CollisionMonitor, KeepsAContactAsLongAsItHasNotEnded) {
  CollisionMonitor monitor(lab(), two_robots(), 0.6);
  const Eigen::Vector3d still(1.0, 4.0, 1.0);
  const auto apart = [&](double centres_m) {
    return update(monitor, {still, still + Eigen::Vector3d(centres_m, 0.0, 0.0)}).size();
  };
  for (int time = 0; time < 3; ++time) {
    EXPECT_EQ(apart(0.7), 0u);
    EXPECT_EQ(apart(0.59), 1u) << "near";
    for (int step = 0; step < 5; ++step) {
      EXPECT_EQ(apart(0.61), 0u) << "apart, but not by enough to count as ended";
    }
    EXPECT_EQ(apart(0.59), 0u);
    EXPECT_EQ(apart(0.49), 1u) << "touching";
    for (int step = 0; step < 5; ++step) {
      EXPECT_EQ(apart(0.51), 0u);
    }
    EXPECT_EQ(apart(0.49), 0u);
    EXPECT_EQ(apart(0.53), 0u);
    EXPECT_EQ(apart(0.49), 1u) << "touching again, and near all the time";
  }
}

TEST(CollisionMonitor, ReportsANearMissOfRobotsButNotOfRovers) {
  CollisionMonitor monitor(lab(), {{"Q1", 0.25, true}, {"Q2", 0.25, true}, {"ROVER1", 0.05, false}},
                           0.6);
  const Eigen::Vector3d a(1.0, 4.0, 1.0);
  const auto begun = update(
      monitor, {a, a + Eigen::Vector3d(0.0, 0.55, 0.0), a + Eigen::Vector3d(0.0, -0.35, 0.0)});
  ASSERT_EQ(begun.size(), 1u);
  EXPECT_EQ(begun[0].kind, ContactKind::kNearMiss);
  EXPECT_EQ(begun[0].body_a, "Q1");
  EXPECT_EQ(begun[0].body_b, "Q2");
  EXPECT_NEAR(begun[0].distance_m, 0.05, 1e-12);
  EXPECT_NEAR(monitor.min_separation_m(), 0.55, 1e-12);
}

TEST(CollisionMonitor, LeavesOutWhatIsNotFiniteAndCountsIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CollisionMonitor monitor(lab(), two_robots(), 0.6);
  EXPECT_TRUE(update(monitor, {{nan, 4.0, 1.0}, {3.0, 4.0, 1.0}}).empty());
  EXPECT_TRUE(update(monitor, {{1.0, 4.0, 1.0}, {3.0, 4.0, nan}}).empty());
  EXPECT_EQ(monitor.non_finite(), 2);
  EXPECT_EQ(update(monitor, {{1.0, 4.0, 1.0}, {1.2, 4.0, 1.0}}).size(), 2u);
}

TEST(CollisionMonitor, ReportsWallsAndCeilingButNotTheFloor) {
  const std::vector<CollisionMonitor::Body> one{{"Q1", 0.25, true}};
  const std::vector<std::pair<Eigen::Vector3d, std::size_t>> cases{
      {{0.24, 4.0, 1.0}, 1}, {{3.76, 4.0, 1.0}, 1}, {{2.0, 0.24, 1.0}, 1}, {{2.0, 7.76, 1.0}, 1},
      {{2.0, 4.0, 2.76}, 1}, {{2.0, 4.0, 0.0}, 0},  {{-50.0, 4.0, 1.0}, 1}};
  for (const auto& [centre, reports] : cases) {
    CollisionMonitor monitor(lab(), one, 0.6);
    const auto begun = update(monitor, {centre});
    EXPECT_EQ(begun.size(), reports) << centre.transpose();
    if (!begun.empty()) {
      EXPECT_EQ(begun[0].body_b, "bounds");
    }
  }
}

}  // namespace
}  // namespace vantage::models
