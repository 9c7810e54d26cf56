#include "logs/metrics/run_set.hpp"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

TEST(RunSet, CountsEachNumberOnceAndMergesNeighbours) {
  std::mt19937 rng(7);
  for (int repetition = 0; repetition < 200; ++repetition) {
    RunSet set;
    std::set<std::int64_t> expected;
    std::uniform_int_distribution<std::int64_t> number(-5, 30);
    for (int i = 0; i < 40; ++i) {
      const std::int64_t drawn = number(rng);
      set.insert(drawn);
      expected.insert(drawn);
      std::int64_t runs = 0;
      for (const std::int64_t each : expected) {
        runs += expected.contains(each - 1) ? 0 : 1;
      }
      ASSERT_EQ(set.size(), std::ssize(expected));
      ASSERT_EQ(set.runs(), runs);
    }
  }
}

TEST(RunSet, NeedsConstantMemoryForConsecutiveRounds) {
  RunSet set;
  for (std::int64_t round = 0; round < 86'400; round += 2) {  // two robots' plans, out of order
    set.insert(round + 1);
    set.insert(round);
    set.insert(round + 1);
  }
  EXPECT_EQ(set.size(), 86'400);
  EXPECT_EQ(set.runs(), 1);
}

}  // namespace
}  // namespace vantage::logs
