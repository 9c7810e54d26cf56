#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
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

std::vector<CollisionReport> update(CollisionMonitor& monitor,
                                    const std::vector<Eigen::Vector3d>& centres_m) {
  std::vector<CollisionReport> begun;
  monitor.update(kNow, centres_m, begun);
  return begun;
}

TEST(SignedDistance, IsNegativeInsideAndZeroOnTheSurface) {
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
  // A new monitor knows no earlier positions and contacts, so its report depends on these poses
  // only.
  for (int trial = 0; trial < 3000; ++trial) {
    CollisionMonitor monitor(world, {{"A", 0.25, false}, {"B", 0.4, false}}, 0.6);
    const Eigen::Vector3d a(x(rng), y(rng), z(rng));
    const Eigen::Vector3d b = trial % 2 == 0 ? Eigen::Vector3d(x(rng), y(rng), z(rng))
                                             : Eigen::Vector3d(a.x() + 0.3 * z(rng), a.y(), a.z());
    const std::vector<CollisionReport> begun = update(monitor, {a, b});
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
  EXPECT_GT(hits, 1000) << "too few poses touch";
}

TEST(CollisionMonitor, DetectsContactBetweenTwoSteps) {
  CollisionMonitor robots(lab(), two_robots(), 0.0);
  EXPECT_TRUE(update(robots, {{1.0, 4.0, 1.0}, {3.0, 4.0, 1.0}}).empty());
  const auto crossed = update(robots, {{3.0, 4.0, 1.0}, {1.0, 4.0, 1.0}});
  ASSERT_EQ(crossed.size(), 1u);
  EXPECT_EQ(crossed[0].kind, CollisionKind::kCollision);
  EXPECT_NEAR(crossed[0].distance_m, -0.5, 1e-12);
  EXPECT_NEAR(robots.min_separation_m(), 0.0, 1e-12);

  CollisionMonitor box(lab(), {{"ROVER1", 0.2, false}}, 0.6);
  EXPECT_TRUE(update(box, {{0.5, 2.75, 0.0}}).empty());
  const auto through = update(box, {{2.2, 2.75, 0.0}});
  ASSERT_EQ(through.size(), 1u);
  EXPECT_EQ(through[0].body_b, "obstacle:0");
  EXPECT_TRUE(update(box, {{2.3, 2.75, 0.0}}).empty());
}

TEST(CollisionMonitor, AllowsFlightOverALowBox) {
  CollisionMonitor monitor(lab(), {{"Q1", 0.25, true}}, 0.6);
  EXPECT_TRUE(update(monitor, {{0.5, 2.75, 0.76}}).empty());
  EXPECT_TRUE(update(monitor, {{2.2, 2.75, 0.76}}).empty());
  EXPECT_EQ(update(monitor, {{0.5, 2.75, 0.74}}).size(), 1u);
}

TEST(CollisionMonitor, ReportsAContactOnce) {
  CollisionMonitor monitor(lab(), two_robots(), 0.0);
  const Eigen::Vector3d still(1.0, 4.0, 1.0);
  const auto beside = [&](double gap_m) {
    return update(monitor, {still, still + Eigen::Vector3d(0.5 + gap_m, 0.0, 0.0)}).size();
  };
  EXPECT_EQ(beside(0.1), 0u);
  EXPECT_EQ(beside(-0.01), 1u);
  EXPECT_EQ(beside(-0.02), 0u);
  EXPECT_EQ(beside(0.01), 0u) << "apart, but not far enough to end";
  EXPECT_EQ(beside(-0.01), 0u);
  EXPECT_EQ(beside(0.03), 0u);
  EXPECT_EQ(beside(-0.01), 1u);
}

// A near miss or contact is reported once. It ends only when the bodies are clearly farther apart
// than the distance at which it began.
TEST(CollisionMonitor, KeepsAContactUntilItEnds) {
  CollisionMonitor monitor(lab(), two_robots(), 0.6);
  const Eigen::Vector3d still(1.0, 4.0, 1.0);
  const auto apart = [&](double centres_m) {
    return update(monitor, {still, still + Eigen::Vector3d(centres_m, 0.0, 0.0)}).size();
  };
  for (int time = 0; time < 3; ++time) {
    EXPECT_EQ(apart(0.7), 0u);
    EXPECT_EQ(apart(0.59), 1u) << "near miss";
    for (int step = 0; step < 5; ++step) {
      EXPECT_EQ(apart(0.61), 0u) << "apart, but not far enough to end";
    }
    EXPECT_EQ(apart(0.59), 0u);
    EXPECT_EQ(apart(0.49), 1u) << "contact";
    for (int step = 0; step < 5; ++step) {
      EXPECT_EQ(apart(0.51), 0u);
    }
    EXPECT_EQ(apart(0.49), 0u);
    EXPECT_EQ(apart(0.53), 0u);
    EXPECT_EQ(apart(0.49), 1u) << "contact again, while near";
  }
}

TEST(CollisionMonitor, ReportsNearMissesOfRobotsOnly) {
  CollisionMonitor monitor(lab(), {{"Q1", 0.25, true}, {"Q2", 0.25, true}, {"ROVER1", 0.05, false}},
                           0.6);
  const Eigen::Vector3d a(1.0, 4.0, 1.0);
  const auto begun = update(
      monitor, {a, a + Eigen::Vector3d(0.0, 0.55, 0.0), a + Eigen::Vector3d(0.0, -0.35, 0.0)});
  ASSERT_EQ(begun.size(), 1u);
  EXPECT_EQ(begun[0].kind, CollisionKind::kNearMiss);
  EXPECT_EQ(begun[0].body_a, "Q1");
  EXPECT_EQ(begun[0].body_b, "Q2");
  EXPECT_NEAR(begun[0].distance_m, 0.05, 1e-12);
  EXPECT_NEAR(monitor.min_separation_m(), 0.55, 1e-12);
}

TEST(CollisionMonitor, SkipsAndCountsNonFinitePositions) {
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

/// Compares every body with every other, every box and every wall at every step, by closed forms
/// only.
class NaiveMonitor {
 public:
  NaiveMonitor(World world, double separation_m)
      : world_(std::move(world)), separation_m_(separation_m) {}

  std::vector<CollisionMonitor::Body> bodies;
  double min_separation_m = std::numeric_limits<double>::infinity();

  std::vector<std::string> update(const std::vector<Eigen::Vector3d>& now_m) {
    begun_.clear();
    before_m_.resize(now_m.size(), Eigen::Vector3d::Constant(NAN));
    for (std::size_t i = 0; i < now_m.size(); ++i) {
      if (!before_m_[i].allFinite()) {
        before_m_[i] = now_m[i];
      }
    }
    for (std::size_t i = 0; i < now_m.size(); ++i) {
      for (std::size_t j = i + 1; j < now_m.size(); ++j) {
        if (now_m[i].allFinite() && now_m[j].allFinite()) {
          judge_pair(i, j, now_m[i], now_m[j]);
        }
      }
      if (now_m[i].allFinite()) {
        judge_surroundings(i, now_m[i]);
      }
    }
    before_m_ = now_m;
    std::sort(begun_.begin(), begun_.end());
    return begun_;
  }
  void forget_motion() { before_m_.clear(); }

 private:
  void judge(const std::string& what, double now_m, double swept_m, double release_m) {
    bool& state = states_[what];
    if (swept_m <= 0.0 && !state) {
      begun_.push_back(what);
    }
    state = (state || swept_m <= 0.0) && now_m <= release_m;
  }
  void judge_pair(std::size_t i, std::size_t j, const Eigen::Vector3d& a_m,
                  const Eigen::Vector3d& b_m) {
    const double swept_m = closest_approach_m(before_m_[i], a_m, before_m_[j], b_m);
    const double apart_m = (a_m - b_m).norm();
    const std::string names = bodies[i].name + " " + bodies[j].name;
    const double radii_m = bodies[i].radius_m + bodies[j].radius_m;
    judge(names + " touch", apart_m - radii_m, swept_m - radii_m, 0.02);
    if (bodies[i].is_robot && bodies[j].is_robot) {
      judge(names + " near", apart_m - separation_m_, swept_m - separation_m_, 0.02);
      min_separation_m = std::min(min_separation_m, swept_m);
    }
  }
  void judge_surroundings(std::size_t i, const Eigen::Vector3d& a_m) {
    const double radius_m = bodies[i].radius_m;
    for (std::size_t k = 0; k < world_.obstacles.size(); ++k) {
      const Box3 box = box_of(world_.obstacles[k]);
      judge(bodies[i].name + " obstacle:" + std::to_string(k) + " touch",
            signed_distance_m(box, a_m) - radius_m,
            swept_distance_m(box, before_m_[i], a_m) - radius_m, 0.02);
    }
    const double now_m = distance_to_bounds_m(world_, a_m) - radius_m;
    judge(bodies[i].name + " bounds touch", now_m,
          std::min(now_m, distance_to_bounds_m(world_, before_m_[i]) - radius_m), 0.02);
  }

  World world_;
  double separation_m_;
  std::vector<Eigen::Vector3d> before_m_;
  std::map<std::string, bool> states_;
  std::vector<std::string> begun_;
};

std::vector<std::string> words_of(const std::vector<CollisionReport>& reports) {
  std::vector<std::string> words;
  for (const CollisionReport& report : reports) {
    words.push_back(report.body_a + " " + report.body_b +
                    (report.kind == CollisionKind::kCollision ? " touch" : " near"));
  }
  std::sort(words.begin(), words.end());
  return words;
}

// Robots and rovers of all sizes wander, flee, jump, appear late and are temporarily not observed.
// The reports must equal those of a check of all pairs at each step.
TEST(CollisionMonitor, EqualsCheckOfAllPairs) {
  std::mt19937_64 rng(17);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int touches = 0;
  int nears = 0;
  for (int trial = 0; trial < 12; ++trial) {
    World world = lab();
    world.obstacles.push_back({{{0.2, 6.0}, {1.9, 6.4}}, 2.0});
    const double separation_m = trial % 3 == 0 ? 0.3 : 0.8;
    NaiveMonitor naive(world, separation_m);
    for (int i = 0; i < 5; ++i) {
      naive.bodies.push_back(
          {std::string("B") + std::to_string(i), 0.05 + 0.3 * u(rng) * u(rng), i % 2 == trial % 2});
    }
    CollisionMonitor monitor(world, naive.bodies, separation_m);
    std::vector<Eigen::Vector3d> at_m;
    const auto anywhere = [&] {
      return Eigen::Vector3d(0.3 + 3.4 * u(rng), 0.3 + 7.4 * u(rng), 0.3 + u(rng));
    };
    for (std::size_t i = 0; i < naive.bodies.size(); ++i) {
      at_m.push_back(anywhere());
    }
    std::int64_t lost = 0;
    for (int step = 0; step < 150; ++step) {
      const double pace_m = step % 40 == 39 ? 3.0 : 0.25;
      for (Eigen::Vector3d& place_m : at_m) {
        place_m += pace_m * Eigen::Vector3d(u(rng) - 0.5, u(rng) - 0.5, 0.2 * (u(rng) - 0.5));
        place_m = place_m.cwiseMax(Eigen::Vector3d(0.1, 0.1, 0.1))
                      .cwiseMin(Eigen::Vector3d(3.9, 7.9, 2.9));
      }
      if (step == 50 || step == 70) {
        naive.bodies.push_back({std::string("C") + std::to_string(step), 0.2, step == 50});
        monitor.add(naive.bodies.back());
        at_m.push_back(anywhere());
      }
      if (step == 100) {
        naive.forget_motion();
        monitor.forget_motion();
        for (Eigen::Vector3d& place_m : at_m) {
          place_m = anywhere();
        }
      }
      std::vector<Eigen::Vector3d> seen_m = at_m;
      if (step % 10 < 3) {
        seen_m[static_cast<std::size_t>(step / 10) % seen_m.size()].y() = NAN;
        ++lost;
      }
      const std::vector<CollisionReport> begun = update(monitor, seen_m);
      ASSERT_EQ(words_of(begun), naive.update(seen_m)) << trial << " at " << step;
      for (const CollisionReport& report : begun) {
        EXPECT_EQ(report.stamp.time, kNow);
        const bool touch = report.kind == CollisionKind::kCollision;
        EXPECT_TRUE(touch ? report.distance_m <= 0.0 : report.distance_m < separation_m);
        (touch ? touches : nears) += 1;
      }
      EXPECT_NEAR(monitor.min_separation_m(), naive.min_separation_m, 1e-12);
      EXPECT_EQ(monitor.non_finite(), lost);
    }
    EXPECT_EQ(monitor.disagreements(), 0);
  }
  EXPECT_GT(touches, 100);
  EXPECT_GT(nears, 10);
}

TEST(CollisionMonitor, RequiresSizeAndPositionOfEachBody) {
  EXPECT_THROW(CollisionMonitor(lab(), {{"Q1", 0.0, true}}, 0.6), UsageError);
  EXPECT_THROW(CollisionMonitor(lab(), {{"Q1", NAN, true}}, 0.6), UsageError);
  EXPECT_THROW(CollisionMonitor(lab(), {{"Q1", INFINITY, true}}, 0.6), UsageError);
  CollisionMonitor monitor(lab(), two_robots(), 0.6);
  EXPECT_THROW(update(monitor, {{1.0, 1.0, 1.0}}), UsageError);
  EXPECT_THROW(update(monitor, {{1.0, 1.0, 1.0}, {2.0, 1.0, 1.0}, {3.0, 1.0, 1.0}}), UsageError);
}

TEST(BoundsDistance, IsTheLeastOfWallsAndCeiling) {
  World world;
  world.bounds = {{-1.0, -2.0}, {5.0, 9.0}};
  world.ceiling_m = 3.0;
  EXPECT_NEAR(distance_to_bounds_m(world, {-0.9, 3.0, 1.0}), 0.1, 1e-12);
  EXPECT_NEAR(distance_to_bounds_m(world, {4.8, 3.0, 1.0}), 0.2, 1e-12);
  EXPECT_NEAR(distance_to_bounds_m(world, {2.0, -1.7, 1.0}), 0.3, 1e-12);
  EXPECT_NEAR(distance_to_bounds_m(world, {2.0, 8.6, 1.0}), 0.4, 1e-12);
  EXPECT_NEAR(distance_to_bounds_m(world, {2.0, 3.0, 2.5}), 0.5, 1e-12);
  EXPECT_NEAR(distance_to_bounds_m(world, {2.0, 3.0, -9.0}), 3.0, 1e-12) << "no floor";
  EXPECT_NEAR(distance_to_bounds_m(world, {2.0, 9.7, 4.0}), -1.0, 1e-12);
}

}  // namespace
}  // namespace vantage::models
