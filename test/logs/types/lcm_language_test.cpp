#include "logs/types/lcm_language.hpp"

#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage::logs {
namespace {

std::string why_not(const std::string& text) {
  try {
    parse_lcm(text, "a.lcm");
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

TEST(ParseLcm, ReadsStructsMembersAndPackages) {
  const auto structs = parse_lcm(
      "package lab.arm; // a comment\n"
      "struct point_t { double x, y; }\n"
      "/* of\n more lines */ enum colour_t { RED = 1, BLUE }\n"
      "struct way_t{int32_t n;point_t at[n][2];other.pose_t end;string name;}",
      "a.lcm");
  ASSERT_EQ(structs.size(), 2U);
  EXPECT_EQ(structs[0].name, "lab.arm.point_t");
  ASSERT_EQ(structs[0].members.size(), 2U);
  EXPECT_EQ(structs[0].members[1].name, "y");
  EXPECT_EQ(structs[0].members[1].type, "double");
  EXPECT_EQ(structs[1].name, "lab.arm.way_t");
  EXPECT_EQ(structs[1].line, 5U);
  ASSERT_EQ(structs[1].members.size(), 4U);
  const LcmMember& at = structs[1].members[1];
  EXPECT_EQ(at.type, "lab.arm.point_t");
  ASSERT_EQ(at.dimensions.size(), 2U);
  EXPECT_EQ(at.dimensions[0].member, 0);
  EXPECT_EQ(at.dimensions[1].member, -1);
  EXPECT_EQ(at.dimensions[1].constant, 2);
  EXPECT_EQ(structs[1].members[2].type, "other.pose_t");
}

TEST(ParseLcm, TakesAConstantForASize) {
  const auto structs = parse_lcm(
      "struct a_t { const int32_t N = 0x10, M = 3; double v[N][M]; byte b[N]; }", "a.lcm");
  const auto& dimensions = structs.at(0).members.at(0).dimensions;
  EXPECT_EQ(dimensions.at(0).constant, 16);
  EXPECT_EQ(dimensions.at(0).size, "0x10");
  EXPECT_EQ(dimensions.at(1).constant, 3);
}

TEST(ParseLcm, HasNothingInAnEmptyFile) {
  EXPECT_TRUE(parse_lcm("", "a.lcm").empty());
  EXPECT_TRUE(parse_lcm(" // nothing\n\n", "a.lcm").empty());
  EXPECT_TRUE(parse_lcm("struct empty_t {}", "a.lcm").at(0).members.empty());
}

TEST(ParseLcm, SaysWhereAFileBreaksTheLanguage) {
  EXPECT_EQ(why_not("struct a_t {\n  double x\n}\n"), "a.lcm:3: expected ;, not }");
  EXPECT_EQ(why_not("struct a_t {\n  double x[n];\n}\n"),
            "a.lcm:2: the array's size n is no member before it");
  EXPECT_EQ(why_not("struct a_t { double n; byte x[n]; }"),
            "a.lcm:1: the array's size n is no integer");
  EXPECT_EQ(why_not("struct a_t { byte x[0]; }"),
            "a.lcm:1: an array's size must be a whole number above 0, not 0");
  EXPECT_EQ(why_not("struct a_t { byte x[3x]; }"),
            "a.lcm:1: an array's size must be a whole number above 0, not 3x");
  EXPECT_EQ(why_not("struct a_t { byte x;\n byte x; }"), "a.lcm:2: x stands twice in a_t");
  EXPECT_EQ(why_not("struct a_t { }\nstruct a_t { }"), "a.lcm:2: struct a_t stands here twice");
  EXPECT_EQ(why_not("\nclass a_t { }"), "a.lcm:2: expected package, struct or enum, not class");
  EXPECT_EQ(why_not("struct a_t { double 3x; }"), "a.lcm:1: expected a member's name, not 3x");
  EXPECT_EQ(why_not("struct a_t {\n\n double x;\n"), "a.lcm:4: expected a type, and the file ends");
  EXPECT_EQ(why_not("struct a_t {}\n/* for\never"), "a.lcm:2: a comment without an end");
}

TEST(ParseLcm, EndsWhateverItIsGiven) {
  const std::string whole =
      "package p; struct a_t { const int32_t N = 3; int32_t n; string s[n][N]; /* c */ b_t b; }";
  for (std::size_t size = 0; size < whole.size(); ++size) {
    why_not(whole.substr(0, size));
    std::string changed = whole;
    changed[size] = ';';
    why_not(changed);
    changed[size] = '{';
    why_not(changed);
  }
}

}  // namespace
}  // namespace vantage::logs
