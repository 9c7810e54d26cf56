#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "estimator/app/replay_node.hpp"
#include "test/estimator/filter_support.hpp"

namespace vantage::estimator {
namespace {

using test::instant;

models::RobotBelief some_belief() {
  models::RobotBelief belief =
      test::prior(instant(3), {{Eigen::Vector2d(1.0, -2.0), 0.25 * Eigen::Matrix2d::Identity()},
                               {Eigen::Vector2d(3.0, 4.0), Eigen::Matrix2d::Identity()}});
  belief.degree = 2;
  belief.grid = {{0.0, 1.0}, 0.5, 2, 1};
  belief.last_seen_utime = {7, 8};
  return belief;
}

// And whatever else is said of how it came about.
TEST(SameContent, IsTheSameOfTheSameTargetsAndCells) {
  const models::RobotBelief one = some_belief();
  models::RobotBelief other = one;
  other.stamp.sequence = 9;
  other.step = 4;
  other.inputs.push_back({"VICON", 1, 2});
  EXPECT_TRUE(same_content(one, other, 0.0));
}

TEST(SameContent, IsAnotherWhereAnythingOfItIs) {
  const models::RobotBelief one = some_belief();
  const auto is_another = [&](auto change) {
    models::RobotBelief other = one;
    change(other);
    EXPECT_EQ(same_content(one, other, 1e-9), same_content(other, one, 1e-9));
    return !same_content(one, other, 1e-9);
  };
  using models::RobotBelief;
  EXPECT_FALSE(is_another([](RobotBelief&) {}));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.stamp.time += Duration{1}; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.degree = 1; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.grid.origin_m.x() += 1.0; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.last_seen_utime[1] = 9; }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.targets.pop_back(); }));
  EXPECT_TRUE(is_another([](RobotBelief& b) { b.targets.push_back(b.targets[0]); }));
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].target_id = 5; }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].last_seen += Duration{1}; }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].information.vector.setZero(4); }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].information.matrix.resize(2, 3); }));
    EXPECT_TRUE(is_another([&](RobotBelief& b) { b.targets[i].information.matrix.resize(3, 2); }));
  }
}

// Each number within the tolerance, of one more than itself, either way.
TEST(SameContent, ForgivesAShareOfEachNumber) {
  constexpr double kTolerance = 1e-3;
  const models::RobotBelief one = some_belief();
  for (const double side : {-1.0, 1.0}) {
    for (const auto& [share, is_same] : {std::pair(0.99, true), std::pair(1.01, false)}) {
      for (const std::size_t i : {0U, 1U}) {
        for (const Eigen::Index row : {0, 1}) {
          models::RobotBelief other = one;
          double& number = other.targets[i].information.vector(row);
          const double logged = number;
          number += side * share * kTolerance * (1.0 + std::abs(logged));
          EXPECT_EQ(same_content(other, one, kTolerance), is_same) << logged;
          other = one;
          double& entry = other.targets[i].information.matrix(row, row);
          entry += side * share * kTolerance * (1.0 + std::abs(entry));
          EXPECT_EQ(same_content(other, one, kTolerance), is_same);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vantage::estimator
