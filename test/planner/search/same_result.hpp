#pragma once

#include <gtest/gtest.h>

#include "planner/problem/problem.hpp"

namespace vantage::test {

/// Expects two search results to be equal bit for bit, except for peak_bytes, which is not
/// guaranteed.
inline void expect_same(const planner::SearchResult& a, const planner::SearchResult& b) {
  EXPECT_EQ(a.found, b.found);
  EXPECT_EQ(a.controls, b.controls);
  EXPECT_EQ(a.poses, b.poses);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.moving_steps, b.moving_steps);
  EXPECT_EQ(a.lower_bound, b.lower_bound);
  EXPECT_EQ(a.epsilon, b.epsilon);
  EXPECT_EQ(a.delta_m, b.delta_m);
  EXPECT_EQ(a.passes, b.passes);
  EXPECT_EQ(a.nodes_generated, b.nodes_generated);
  EXPECT_EQ(a.nodes_expanded, b.nodes_expanded);
  EXPECT_EQ(a.work_nodes, b.work_nodes);
  EXPECT_EQ(a.stop_reason, b.stop_reason);
  ASSERT_EQ(a.history.size(), b.history.size());
  for (std::size_t i = 0; i < a.history.size(); ++i) {
    EXPECT_EQ(a.history[i].epsilon, b.history[i].epsilon);
    EXPECT_EQ(a.history[i].delta_m, b.history[i].delta_m);
    EXPECT_EQ(a.history[i].cost, b.history[i].cost);
    EXPECT_EQ(a.history[i].work_nodes, b.history[i].work_nodes);
  }
}

}  // namespace vantage::test
