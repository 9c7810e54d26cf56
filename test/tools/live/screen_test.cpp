#include "tools/live/screen.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using Lines = std::vector<std::string>;

TEST(CutTo, CountsCharactersNotBytes) {
  EXPECT_EQ(cut_to("abcdef", 3), "abc");
  EXPECT_EQ(cut_to("a → b", 3), "a →");
  EXPECT_EQ(cut_to("a → b", 5), "a → b");
  EXPECT_EQ(cut_to("a → b", 9), "a → b");
  EXPECT_EQ(cut_to("a", 0), "");
}

TEST(CutTo, GivesColoursNoRoomAndEndsThem) {
  const std::string line = "ab" + inked("cd", Ink::kBad) + "ef";
  EXPECT_EQ(cut_to(line, 6), line);
  EXPECT_EQ(cut_to(line, 3), "ab\x1b[1;31mc\x1b[0m");
  EXPECT_EQ(cut_to(line, 5), "ab\x1b[1;31mcd\x1b[0me\x1b[0m");
}

TEST(Fit, LeavesRoomForTheCursorAndSaysWhatIsMissing) {
  const Lines five{"1", "2", "3", "4", "5"};
  EXPECT_EQ(fit(five, 6, 80), five);
  EXPECT_EQ(fit(five, 5, 80), (Lines{"1", "2", "3", "... 2 more lines"}));
  EXPECT_EQ(fit(five, 3, 80), (Lines{"1", "... 4 more lines"}));
}

TEST(Fit, KnowsNoLimitWithoutATerminal) {
  const Lines lines(100, std::string(500, 'x'));
  EXPECT_EQ(fit(lines, 0, 0), lines);
}

}  // namespace
}  // namespace vantage::tools
