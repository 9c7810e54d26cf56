#include "bus/transport/channel_index.hpp"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace vantage::bus {
namespace {

TEST(ChannelIndex, FindsTheSameAsALinearSearch) {
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

// Compares the index with a plain list of subscriptions while names and patterns are added and
// removed.
TEST(ChannelIndex, FindsTheSameAsALinearSearchWhileEntriesChange) {
  std::mt19937_64 rng(6);
  const std::vector<std::string> patterns = {"A", "AB", "A*", "*", "PLAN_Q1", "PLAN_*"};
  const std::vector<std::string> channels = {"A", "AB", "PLAN_Q1", "PLAN_", "B"};
  ChannelIndex index;
  std::vector<std::string> held;  // indexed by number; empty: unused
  for (int i = 0; i < 3'000; ++i) {
    const std::string& pattern = patterns[rng() % patterns.size()];
    if (rng() % 4 != 0) {
      const std::size_t number = index.add(pattern);
      if (number == held.size()) {
        EXPECT_EQ(std::count(held.begin(), held.end(), ""), 0) << "one entry was unused";
        held.emplace_back();
      }
      ASSERT_LT(number, held.size());
      ASSERT_EQ(held[number], "");
      held[number] = pattern;
    } else {
      std::vector<std::size_t> expected;
      for (std::size_t k = 0; k < held.size(); ++k) {
        if (held[k] == pattern) {
          expected.push_back(k);
          held[k] = "";
        }
      }
      std::vector<std::size_t> removed = index.remove(pattern);
      std::sort(removed.begin(), removed.end());
      ASSERT_EQ(removed, expected);
    }
    for (const std::string& channel : channels) {
      std::size_t from = 0;
      for (std::size_t k = 0; k < held.size(); ++k) {
        if (!held[k].empty() && channel_matches(held[k], channel)) {
          ASSERT_EQ(index.next(channel, from), k);
          from = k + 1;
        }
      }
      ASSERT_EQ(index.next(channel, from), std::nullopt);
    }
  }
}

TEST(ChannelIndex, ReusesReturnedNumbers) {
  ChannelIndex index;
  index.add("A");
  index.add("B*");
  index.add("A");
  EXPECT_EQ(index.remove("A"), (std::vector<std::size_t>{0, 2}));
  EXPECT_FALSE(index.contains("A"));
  EXPECT_EQ(index.next("A", 0), std::nullopt);
  EXPECT_EQ(index.remove("B*"), (std::vector<std::size_t>{1}));
  EXPECT_EQ(index.next("BC", 0), std::nullopt);
  EXPECT_EQ(index.remove("C"), std::vector<std::size_t>{});
  std::set<std::size_t> again;
  for (const char* name : {"C", "C", "C"}) {
    again.insert(index.add(name));
  }
  EXPECT_EQ(again, (std::set<std::size_t>{0, 1, 2}));
  EXPECT_EQ(index.next("C", 0), 0U);
  EXPECT_EQ(index.next("C", 1), 1U);
  EXPECT_EQ(index.next("C", 2), 2U);
}

}  // namespace
}  // namespace vantage::bus
