#include "logs/metrics/truth_history.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "models/world/world.hpp"
#include "test/support/random.hpp"

namespace vantage::logs {
namespace {

models::TruthBody body(const std::string& name, int target_id, double x_m, double y_m) {
  models::TruthBody out;
  out.name = name;
  out.target_id = target_id;
  out.world_from_body = lift({x_m, y_m, 0.0}, 1.0);
  return out;
}

models::TruthFrame frame(std::int64_t utime, std::vector<models::TruthBody> bodies) {
  models::TruthFrame out;
  out.stamp.time = from_utime(utime);
  out.bodies = std::move(bodies);
  return out;
}

TEST(TruthHistory, InterpolatesBetweenFramesOnly) {
  TruthHistory truth;
  truth.add(frame(1'000'000, {body("R1", 0, 0.0, 2.0)}));
  truth.add(frame(1'100'000, {body("R1", 0, 1.0, 4.0)}));
  const auto at = truth.target_position_m(0, from_utime(1'025'000));
  ASSERT_TRUE(at);
  EXPECT_NEAR(at->x(), 0.25, 1e-12);
  EXPECT_NEAR(at->y(), 2.5, 1e-12);
  EXPECT_EQ(truth.target_position_m(0, from_utime(1'000'000))->x(), 0.0);
  EXPECT_FALSE(truth.target_position_m(0, from_utime(999'999)));
  EXPECT_FALSE(truth.target_position_m(0, from_utime(1'100'001)));
  EXPECT_FALSE(truth.target_position_m(1, from_utime(1'050'000)));
}

TEST(TruthHistory, DetectsRobotsThatCrossBetweenFrames) {
  TruthHistory truth;
  EXPECT_FALSE(truth.min_separation_m());
  truth.add(frame(0, {body("Q1", -1, -1.0, 0.1), body("Q2", -1, 1.0, 0.0)}));
  truth.add(frame(50'000, {body("Q1", -1, 1.0, 0.1), body("Q2", -1, -1.0, 0.0)}));
  ASSERT_TRUE(truth.min_separation_m());
  EXPECT_NEAR(*truth.min_separation_m(), 0.1, 1e-12);
}

TEST(TruthHistory, DoesNotCountTargetsAsRobots) {
  TruthHistory truth;
  truth.add(frame(0, {body("Q1", -1, 0.0, 0.0), body("R1", 0, 0.0, 0.0)}));
  EXPECT_FALSE(truth.min_separation_m());
}

TEST(TruthHistory, IgnoresFramesThatAreNotNewer) {
  TruthHistory truth;
  truth.add(frame(100, {body("R1", 0, 1.0, 0.0)}));
  truth.add(frame(100, {body("R1", 0, 9.0, 0.0)}));
  EXPECT_EQ(truth.target_position_m(0, from_utime(100))->x(), 1.0);
}

TEST(TruthHistory, ForgetsOldFrames) {
  TruthHistory truth(1.0);
  for (std::int64_t i = 0; i <= 30; ++i) {
    truth.add(frame(i * 100'000, {body("R1", 0, 0.0, 0.0)}));
  }
  EXPECT_TRUE(truth.target_position_m(0, from_utime(2'000'000)));
  EXPECT_FALSE(truth.target_position_m(0, from_utime(1'900'000)));
}

// The minimum separation equals the minimum over all pairs of all frames.
TEST(TruthHistory, FindsTheLeastSeparationOfChangingBodies) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    test::Random random(seed);
    TruthHistory truth(0.3);
    std::map<std::string, Eigen::Vector3d> before;
    double least_m = std::numeric_limits<double>::infinity();
    std::map<std::string, Eigen::Vector3d> at_m;
    for (int robot = 0; robot < 6; ++robot) {
      at_m["Q" + std::to_string(robot)] = random.vector<3>(-20.0, 20.0);
    }
    for (int k = 0; k < 60; ++k) {
      models::TruthFrame now;
      now.stamp.time = from_utime(100'000 * k);
      std::map<std::string, Eigen::Vector3d> seen;
      for (auto& [name, position_m] : at_m) {
        position_m += random.vector<3>(-1.0, 1.0);
        if (random.integer(0, 9) > 0) {
          seen[name] = position_m;
          now.bodies.push_back({name, -1, {position_m, Quaternion::Identity()}, {}});
        }
      }
      truth.add(now);
      for (auto a = seen.begin(); a != seen.end(); ++a) {
        for (auto b = std::next(a); b != seen.end(); ++b) {
          const bool both = before.contains(a->first) && before.contains(b->first);
          least_m = std::min(
              least_m, models::closest_approach_m(both ? before[a->first] : a->second, a->second,
                                                  both ? before[b->first] : b->second, b->second));
        }
      }
      before = seen;
      ASSERT_EQ(truth.min_separation_m(), std::optional(least_m)) << seed << " " << k;
    }
  }
}

// The two robots meet between frames and are far apart in the second frame. The pair is examined
// only because of the distance that both travelled.
TEST(TruthHistory, FindsMeetingBetweenFrames) {
  TruthHistory truth;
  truth.add(frame(0, {body("Q1", -1, -0.3, 0.0), body("Q2", -1, 0.3, 0.0)}));
  EXPECT_NEAR(truth.min_separation_m().value(), 0.6, 1e-12);
  truth.add(frame(100'000, {body("Q1", -1, 1.7, 0.0), body("Q2", -1, -1.7, 0.0)}));
  EXPECT_NEAR(truth.min_separation_m().value(), 0.0, 1e-12);
}

TEST(TruthHistory, InterpolatesEachTargetSeparately) {
  TruthHistory truth;
  truth.add(frame(1'000'000, {body("R1", 0, 0.0, 0.0), body("R2", 1, 5.0, -3.0)}));
  truth.add(frame(2'000'000, {body("R1", 0, 1.0, -1.0)}));
  truth.add(frame(4'000'000, {body("R1", 0, 5.0, -1.0), body("R2", 1, 9.0, -3.0)}));
  truth.add(frame(5'000'000, {body("R2", 1, 8.0, -2.0)}));
  const auto x_m = [&](int id, std::int64_t utime) {
    const auto at_m = truth.target_position_m(id, from_utime(utime));
    return at_m ? at_m->x() : -1.0;
  };
  EXPECT_NEAR(x_m(0, 1'500'000), 0.5, 1e-12);
  EXPECT_NEAR(x_m(0, 2'000'000), 1.0, 1e-12);
  EXPECT_NEAR(x_m(0, 3'500'000), 4.0, 1e-12);
  EXPECT_EQ(x_m(0, 4'500'000), -1.0) << "not visible at that time";
  EXPECT_EQ(x_m(0, 5'000'000), -1.0);
  EXPECT_EQ(x_m(1, 1'000'000), 5.0);
  EXPECT_EQ(x_m(1, 1'500'000), -1.0);
  EXPECT_EQ(x_m(1, 3'000'000), -1.0) << "only for later times";
  EXPECT_NEAR(x_m(1, 4'750'000), 8.25, 1e-12);
  EXPECT_NEAR(truth.target_position_m(1, from_utime(4'750'000))->y(), -2.25, 1e-12);
}

}  // namespace
}  // namespace vantage::logs
