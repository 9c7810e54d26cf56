#include "logs/metrics/truth_history.hpp"

#include <gtest/gtest.h>

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

TEST(TruthHistory, IsLinearBetweenFramesAndSilentOutside) {
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

TEST(TruthHistory, SeesRobotsPassThroughEachOtherBetweenFrames) {
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

TEST(TruthHistory, IgnoresAndCountsFramesThatAreNotNewer) {
  TruthHistory truth;
  truth.add(frame(100, {body("R1", 0, 1.0, 0.0)}));
  truth.add(frame(100, {body("R1", 0, 9.0, 0.0)}));
  EXPECT_EQ(truth.frames_ignored(), 1);
  EXPECT_EQ(truth.target_position_m(0, from_utime(100))->x(), 1.0);
}

TEST(TruthHistory, ForgetsWhatIsOlderThanItsMemory) {
  TruthHistory truth(1.0);
  for (std::int64_t i = 0; i <= 30; ++i) {
    truth.add(frame(i * 100'000, {body("R1", 0, 0.0, 0.0)}));
  }
  EXPECT_TRUE(truth.target_position_m(0, from_utime(2'000'000)));
  EXPECT_FALSE(truth.target_position_m(0, from_utime(1'900'000)));
}

}  // namespace
}  // namespace vantage::logs
