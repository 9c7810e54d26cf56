#include "logs/metrics/set_means.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

Time at_s(double s) { return from_utime(1'000'000'000) + from_seconds(s); }

// Returns a frame with two stationary targets, 5 m apart.
models::TruthFrame truth(double s) {
  models::TruthFrame frame;
  frame.stamp.time = at_s(s);
  for (int id = 0; id < 2; ++id) {
    models::TruthBody body;
    body.name = id == 0 ? "R1" : "R2";
    body.target_id = id;
    body.world_from_body.translation_m = {5.0 * id, 0.0, 0.0};
    frame.bodies.push_back(body);
  }
  return frame;
}

models::RobotBelief belief(const std::string& robot, double s,
                           const std::vector<std::pair<int, double>>& targets) {
  models::RobotBelief out;
  out.robot = robot;
  out.stamp.time = at_s(s);
  for (const auto& [id, x_m] : targets) {
    out.targets.push_back(
        {id,
         models::to_information({Eigen::Vector2d(x_m, 0.0), models::StateMatrix::Identity(2, 2)})
             .value(),
         at_s(s)});
  }
  return out;
}

TEST(SetSums, AverageOverBeliefsAndThenOverRobots) {
  SetSums sums(2);
  sums.on_truth(truth(0.0));
  sums.on_belief(belief("Q1", 0.5, {{0, 0.3}, {1, 5.0}}));
  sums.on_belief(belief("Q2", 0.5, {}));
  sums.on_truth(truth(1.0));
  sums.on_truth(truth(30.0));
  sums.on_belief(belief("Q1", 30.5, {{1, 0.3}, {0, 5.0}}));  // the two labels are swapped
  sums.on_truth(truth(31.0));
  const auto means = sums.means();
  ASSERT_TRUE(means);
  EXPECT_NEAR(means->ospa_m, 0.5 * (0.3 / std::sqrt(2.0)) + 0.5 * 1.0, 1e-9);
  EXPECT_NEAR(means->matched_rmse_m, 0.5 * 0.3 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(means->swaps_per_min, 0.5 * 2.0 / 0.5, 1e-9);
}

TEST(SetSums, AreEmptyWithoutTruth) {
  SetSums sums(2);
  sums.on_belief(belief("Q1", 0.5, {{0, 0.3}}));
  EXPECT_FALSE(sums.means());
}

// Each robot has the same weight, for any number of beliefs and tracked targets.
TEST(SetSums, WeightRobotsEqually) {
  SetSums sums(2);
  sums.on_truth(truth(0.0));
  sums.on_belief(belief("Q2", 0.0, {{0, 0.6}}));
  for (int k = 0; k < 3; ++k) {
    sums.on_belief(belief("Q1", 10.0 * k, {{0, 0.0}, {1, 5.0}}));  // tracks both targets
  }
  sums.on_belief(belief("Q2", 30.0, {{1, 0.6}}));  // another label: one swap in 30 s
  for (int k = 1; k <= 30; ++k) {
    sums.on_truth(truth(k));
  }
  const auto means = sums.means();
  ASSERT_TRUE(means);
  EXPECT_NEAR(means->ospa_m, 0.5 * (0.0 + std::sqrt((0.36 + 1.0) / 2.0)), 1e-9);
  EXPECT_NEAR(means->matched_rmse_m, 0.5 * (0.0 + 0.6), 1e-9);
  EXPECT_NEAR(means->swaps_per_min, 0.5 * (0.0 + 2.0), 1e-9);
}

TEST(SetSums, EvaluateABeliefWhenItsTruthArrives) {
  SetSums sums(2);
  sums.on_truth(truth(0.0));
  sums.on_belief(belief("Q1", 1.0, {}));
  sums.on_truth(truth(0.999));
  EXPECT_FALSE(sums.means());
  sums.on_truth(truth(1.0));
  ASSERT_TRUE(sums.means());
  EXPECT_EQ(sums.means()->ospa_m, 1.0) << "the cutoff distance";
  EXPECT_EQ(sums.means()->swaps_per_min, 0.0) << "a single belief has no swap rate";
  sums.on_belief(belief("Q2", 0.5, {{0, 0.0}, {1, 5.0}}));  // arrives late, after its truth
  sums.on_truth(truth(2.0));
  EXPECT_NEAR(sums.means()->ospa_m, 0.5, 1e-12);
  SetSums before(2);
  before.on_belief(belief("Q1", 1.0, {}));
  before.on_truth(truth(2.0));
  EXPECT_FALSE(before.means()) << "before the first truth, errors are unknown";
}

}  // namespace
}  // namespace vantage::logs
