#include "bus/transport/channel_index.hpp"

#include <random>

#include <gtest/gtest.h>

namespace vantage::bus {
namespace {

TEST(ChannelIndex, FindsWhatGoingThroughAllWouldFind) {
  std::mt19937_64 rng(5);
  const std::vector<std::string> patterns = {"A", "AB", "A*", "*", "PLAN_Q1", "PLAN_*", "PLAN_Q"};
  const std::vector<std::string> channels = {"A", "AB", "ABC", "PLAN_Q1", "PLAN_Q", "PLAN_", "B"};
  for (int trial = 0; trial < 200; ++trial) {
    ChannelIndex index;
    std::vector<std::string> added;
    for (int i = 0; i < trial % 12; ++i) {
      added.push_back(patterns[rng() % patterns.size()]);
      EXPECT_EQ(index.add(added.back()), added.size() - 1);
    }
    for (const std::string& channel : channels) {
      std::optional<std::size_t> found = index.next(channel, 0);
      for (std::size_t i = 0; i < added.size(); ++i) {
        if (channel_matches(added[i], channel)) {
          ASSERT_EQ(found, i);
          found = index.next(channel, i + 1);
        }
      }
      EXPECT_EQ(found, std::nullopt);
    }
    for (const std::string& pattern : patterns) {
      EXPECT_EQ(index.contains(pattern),
                std::find(added.begin(), added.end(), pattern) != added.end());
    }
  }
}

}  // namespace
}  // namespace vantage::bus
