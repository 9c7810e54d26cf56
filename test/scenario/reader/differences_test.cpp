#include "scenario/reader/differences.hpp"

#include <gtest/gtest.h>

namespace vantage::scenario {
namespace {

using Differences = std::map<std::string, std::vector<std::string>>;

TEST(DifferingKeys, ListsOnlyKeysWhoseValuesDiffer) {
  const std::string base = "seed: 1\nplanner: {algorithm: arvi, horizon_steps: 12}\n";
  EXPECT_EQ(differing_keys({base}), Differences{});
  EXPECT_EQ(differing_keys({base, base, base}), Differences{});
  EXPECT_EQ(differing_keys({base, "planner: {horizon_steps: 12, algorithm: arvi}\nseed: 1\n"}),
            Differences{})
      << "order and style of the text do not matter";
  EXPECT_EQ(differing_keys({base, "seed: 2\nplanner: {algorithm: greedy, horizon_steps: 12}\n"}),
            (Differences{{"planner.algorithm", {"arvi", "greedy"}}, {"seed", {"1", "2"}}}));
}

TEST(DifferingKeys, ComparesListsAsAWholeAndMarksAbsentKeys) {
  const auto found = differing_keys(
      {"robots: [{name: Q1}]\n", "robots: [{name: Q1}, {name: Q2}]\nwind: {x_mps: 1}\n"});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found.at("robots").at(0), "[{name: Q1}]");
  EXPECT_EQ(found.at("robots").at(1), "[{name: Q1}, {name: Q2}]");
  EXPECT_EQ(found.at("wind.x_mps"), (std::vector<std::string>{"-", "1"}));
}

}  // namespace
}  // namespace vantage::scenario
