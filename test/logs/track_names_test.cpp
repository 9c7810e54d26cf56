#include "logs/metrics/track_names.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "logs/metrics/team_estimate.hpp"
#include "test/support/random.hpp"

namespace vantage::logs {
namespace {

constexpr Time kTime = from_utime(1'000'000);

models::TargetBelief track(int label, const Eigen::Vector2d& at_m) {
  models::TargetBelief out;
  out.target_id = label;
  out.information.matrix = Eigen::Matrix2d::Identity();
  out.information.vector = at_m;
  out.last_seen = from_utime(label);
  return out;
}

// The assignment is optimal: it is compared with all assignments of the smaller set to the larger.
TEST(TracksNamedByPosition, UseTheOptimalAssignment) {
  test::Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const int targets = random.integer(0, 5);
    const int count = random.integer(0, 5);
    TruthHistory truth;
    models::TruthFrame frame;
    frame.stamp.time = kTime;
    std::vector<Eigen::Vector2d> true_m;
    for (int id = 0; id < targets; ++id) {
      true_m.push_back(random.vector<2>(-3.0, 3.0));
      frame.bodies.push_back(
          {"R", id, {{true_m.back().x(), true_m.back().y(), 9.0}, Quaternion::Identity()}, {}});
    }
    truth.add(frame);
    std::vector<models::TargetBelief> tracks;
    std::vector<Eigen::Vector2d> estimated_m;
    for (int i = 0; i < count; ++i) {
      estimated_m.push_back(random.vector<2>(-3.0, 3.0));
      tracks.push_back(track(100 + i, estimated_m.back()));
    }
    double least_m2 = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> order(static_cast<std::size_t>(std::max(targets, count)));
    std::iota(order.begin(), order.end(), 0U);
    const auto fewer = static_cast<std::size_t>(std::min(targets, count));
    do {
      double sum_m2 = 0.0;
      for (std::size_t i = 0; i < fewer; ++i) {
        sum_m2 += targets <= count ? (true_m[i] - estimated_m[order[i]]).squaredNorm()
                                   : (estimated_m[i] - true_m[order[i]]).squaredNorm();
      }
      least_m2 = std::min(least_m2, sum_m2);
    } while (std::next_permutation(order.begin(), order.end()));

    const auto named = assign_ids_by_position(tracks, truth, targets, kTime);
    ASSERT_EQ(named.size(), fewer);
    double sum_m2 = 0.0;
    for (std::size_t i = 0; i < named.size(); ++i) {
      EXPECT_TRUE(i == 0 || named[i - 1].target_id < named[i].target_id);
      ASSERT_GE(named[i].target_id, 0);
      ASSERT_LT(named[i].target_id, targets);
      const auto which = static_cast<std::size_t>(to_utime(named[i].last_seen) - 100);
      EXPECT_EQ(named[i].information.vector, tracks.at(which).information.vector) << "unchanged";
      sum_m2 +=
          (true_m[static_cast<std::size_t>(named[i].target_id)] - estimated_m[which]).squaredNorm();
    }
    EXPECT_NEAR(sum_m2, fewer == 0 ? 0.0 : least_m2, 1e-9);
  }
}

TEST(TracksNamedByPosition, SkipTracksAndTargetsWithoutPosition) {
  TruthHistory truth;
  models::TruthFrame frame;
  frame.stamp.time = kTime;
  frame.bodies = {{"R3", 2, {{4.0, 0.0, 0.0}, Quaternion::Identity()}, {}}};
  truth.add(frame);
  models::TargetBelief nothing = track(100, {4.0, 0.0});
  nothing.information.matrix.setZero();
  const auto named =
      assign_ids_by_position(std::vector{nothing, track(101, {9.0, 9.0})}, truth, 3, kTime);
  ASSERT_EQ(named.size(), 1U);
  EXPECT_EQ(named[0].target_id, 2);
  EXPECT_EQ(named[0].last_seen, from_utime(101));
  EXPECT_TRUE(assign_ids_by_position(std::vector{track(101, {9.0, 9.0})}, truth, 2, kTime).empty())
      << "only two targets exist";
}

}  // namespace
}  // namespace vantage::logs
