#include "tools/compare/comparison.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "tools/compare/trial_batch.hpp"

namespace vantage::tools {
namespace {

TrialGroup group(const std::string& name, std::vector<std::pair<std::uint64_t, double>> values) {
  TrialGroup out{name, {}};
  for (const auto& [seed, value] : values) {
    out.trials.push_back({seed, {{"RMSE of a robot, m", value}}});
  }
  return out;
}

bool has_line(const std::vector<std::string>& lines, const std::string& name,
              const std::string& cell) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.starts_with(name) && line.find(cell) != std::string::npos;
  });
}

TEST(Comparison, PairsTrialsBySeed) {
  const TrialGroup base = group("arvi", {{1, 1.0}, {2, 5.0}, {3, 9.0}, {7, 100.0}});
  const TrialGroup other = group("beam", {{3, 9.5}, {1, 1.5}, {2, 5.5}, {8, -100.0}});
  const experiments::Sample differences = paired_differences(other, base, 0);
  EXPECT_EQ(differences.size(), 3U);
  EXPECT_DOUBLE_EQ(differences.mean(), 0.5);
  EXPECT_DOUBLE_EQ(differences.half_interval(), 0.0);
}

// Seeds shift both planners by several metres; only the paired difference shows that beam is
// better.
TEST(Comparison, MarksDifferencesWhoseIntervalExcludesZero) {
  const TrialGroup base = group("arvi", {{1, 1.0}, {2, 5.0}, {3, 9.0}});
  const auto lines = comparison_table({base, group("beam", {{1, 0.6}, {2, 4.5}, {3, 8.4}}),
                                       group("rvi", {{1, 1.3}, {2, 4.7}, {3, 9.1}})});
  EXPECT_TRUE(has_line(lines, "RMSE of a robot, m", "5.000 ± 9.937"));
  EXPECT_TRUE(has_line(lines, "RMSE of a robot, m", "-0.500 ± 0.248 *"));
  EXPECT_TRUE(has_line(lines, "RMSE of a robot, m", "+0.033 ± 0.759  "));
  EXPECT_TRUE(has_line(lines, "seeds in both", "3"));
}

TEST(Comparison, LeavesOutTrialsWithoutAValue) {
  TrialGroup base = group("arvi", {{1, 1.0}, {2, 3.0}});
  base.trials[0].quantities[0].value.reset();
  EXPECT_EQ(sample_of(base, 0).size(), 1U);
  EXPECT_EQ(paired_differences(base, base, 0).size(), 1U);
  base.trials[1].quantities[0].value.reset();
  EXPECT_TRUE(has_line(comparison_table({base}), "RMSE of a robot, m", " -"));
  EXPECT_NE(comparison_figure({base}, "title").find("</svg>"), std::string::npos);
}

TEST(Comparison, ShowsManyGroupsInSeveralBlocks) {
  std::vector<TrialGroup> groups;
  for (int g = 0; g < 14; ++g) {
    groups.push_back(group("planner" + std::to_string(g), {{1, g + 0.25}, {2, g + 0.25}}));
  }
  const auto lines = comparison_table(groups);
  for (int g = 0; g < 14; ++g) {
    EXPECT_TRUE(has_line(lines, "RMSE of a robot, m", std::to_string(g) + ".250 ± 0.000")) << g;
    EXPECT_TRUE(g == 0 || has_line(lines, "RMSE of a robot, m", "+" + std::to_string(g) + ".000"))
        << g;
  }
}

TEST(Comparison, WritesJsonWithEveryValue) {
  const auto json =
      comparison_json({group("arvi", {{4, 1.0}, {5, 2.0}}), group("beam", {{5, 3.0}})});
  EXPECT_EQ(json["differences_to"], "arvi");
  EXPECT_EQ(json["groups"][0]["seeds"], (std::vector<std::uint64_t>{4, 5}));
  const auto& rmse = json["groups"][1]["quantities"]["RMSE of a robot, m"];
  EXPECT_EQ(rmse["all"]["mean"], 3.0);
  EXPECT_EQ(rmse["difference"]["mean"], 1.0);
  EXPECT_EQ(rmse["values"], std::vector<double>{3.0});
}

TEST(Comparison, NamesTheSameQuantitiesForEverySummary) {
  logs::TrialSummary empty;
  logs::TrialSummary full;
  full.rmse_m = 0.5;
  full.map_entropy_nats = 10.0;
  const auto names = [](const logs::TrialSummary& summary) {
    std::vector<std::string> out;
    for (const ComparedValue& each : quantities_of(summary)) {
      out.push_back(each.name);
    }
    return out;
  };
  EXPECT_EQ(names(empty), names(full));
}

struct SeedRow {
  const char* text;
  std::vector<std::uint64_t> seeds;
};

TEST(ParseSeeds, ReadsNumbersAndRanges) {
  for (const SeedRow& row : {SeedRow{"7", {7}}, SeedRow{"1-3", {1, 2, 3}},
                             SeedRow{"9,1-2,18446744073709551615", {9, 1, 2, ~std::uint64_t{0}}}}) {
    EXPECT_EQ(parse_seeds(row.text), row.seeds) << row.text;
  }
  EXPECT_EQ(parse_seeds("1-100000").size(), 100'000U);
}

TEST(ParseSeeds, RefusesOtherText) {
  for (const char* text : {"", ",", "1,", "1,,2", "a", "1-", "-3", "3-1", "1-2-3", "1.5", " 1",
                           "1-100001", "0-18446744073709551615", "2,1-3", "18446744073709551616"}) {
    EXPECT_THROW(parse_seeds(text), StartupError) << text;
  }
}

}  // namespace
}  // namespace vantage::tools
