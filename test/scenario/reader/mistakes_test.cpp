#include "scenario/reader/mistakes.hpp"

#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/lab_text.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::scenario {
namespace {

std::vector<std::string> mistakes_in(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("f.yaml");
  std::ofstream(path) << text;
  std::vector<std::string> out = mistakes_of_scenario(path);
  for (std::string& mistake : out) {
    EXPECT_TRUE(mistake.starts_with(path + ":")) << mistake;
    mistake = mistake.substr(mistake.find(": ") + 2);
  }
  return out;
}

TEST(MistakesOfScenario, AreEmptyForAValidFile) {
  EXPECT_TRUE(mistakes_in(test::lab_with({})).empty());
}

// Two mistakes of one section, one of a list item, an unknown word, an unknown key and a missing
// key are all reported, in the order of their lines.
TEST(MistakesOfScenario, ListsEveryMistakeByLine) {
  const std::vector<std::string> mistakes =
      mistakes_in(test::lab_with({{"duration_s: 300", "duration_s: -3"},
                                  {"brake_mps2: 2 ", "brake_mps2: fast "},
                                  {"range_max_m: 1 ", "range_maxi_m: 1 "},
                                  {"height_m: 1.5", "height_m: 9"},
                                  {"algorithm: arvi", "algorithm: avri"},
                                  {"step_s: 0.5", "step_s: 0"},
                                  {"horizon_steps: 12", "horizon_steps: 1000"}}));
  ASSERT_EQ(mistakes.size(), 7U);
  const char* const expected[] = {"duration_s: must be above 0",
                                  "robot_defaults.limits.brake_mps2",
                                  "range_maxi_m: unknown key; did you mean range_max_m?",
                                  "robots[1].height_m: must be below world.ceiling_m",
                                  "planner.algorithm: must be one of",
                                  "planner.horizon_steps: must be",
                                  "planner.step_s: must be"};
  std::size_t next = 0;
  for (const std::string& mistake : mistakes) {
    if (next < std::size(expected) && mistake.find(expected[next]) != std::string::npos) {
      ++next;
    }
  }
  EXPECT_EQ(next, std::size(expected)) << "not found in this order: " << expected[next];
}

// If a rule about several keys is broken, the section is read no further. Unknown keys of the
// section are still reported.
TEST(MistakesOfScenario, IncludeUnknownKeysOfASectionThatBreaksARule) {
  const std::vector<std::string> mistakes =
      mistakes_in(test::lab_with({{"team_budget_s: 0.5", "team_budget_s: 2\n  pace_s: 3"}}));
  ASSERT_EQ(mistakes.size(), 2U);
  EXPECT_EQ(mistakes[0].find("planner.team_budget_s: must be at most the round"), 0U)
      << mistakes[0];
  EXPECT_EQ(mistakes[1].find("planner.pace_s: unknown key"), 0U) << mistakes[1];
}

// For a file with one mistake the list is the error of load_scenario().
TEST(MistakesOfScenario, EqualTheErrorOfTheReaderForOneMistake) {
  const std::string text = test::lab_with({{"team_budget_s: 0.5", "team_budget_s: 2"}});
  std::string error;
  try {
    parse_scenario(text, "f");
  } catch (const StartupError& refused) {
    error = refused.what();
  }
  const std::vector<std::string> mistakes = mistakes_in(text);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ("f" + error.substr(1, error.find(": ") + 1) + mistakes[0], error);
}

TEST(MistakesOfScenario, HaveOneEntryForTextThatIsNotYaml) {
  EXPECT_EQ(mistakes_in("name: [").size(), 1U);
}

}  // namespace
}  // namespace vantage::scenario
