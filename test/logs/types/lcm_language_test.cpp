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

TEST(ParseLcm, AcceptsConstantsAsSizes) {
  const auto structs = parse_lcm(
      "struct a_t { const int32_t N = 0x10, M = 3; double v[N][M]; byte b[N]; }", "a.lcm");
  const auto& dimensions = structs.at(0).members.at(0).dimensions;
  EXPECT_EQ(dimensions.at(0).constant, 16);
  EXPECT_EQ(dimensions.at(0).size, "0x10");
  EXPECT_EQ(dimensions.at(1).constant, 3);
}

TEST(ParseLcm, ReturnsNothingForAnEmptyFile) {
  EXPECT_TRUE(parse_lcm("", "a.lcm").empty());
  EXPECT_TRUE(parse_lcm(" // nothing\n\n", "a.lcm").empty());
  EXPECT_TRUE(parse_lcm("struct empty_t {}", "a.lcm").at(0).members.empty());
}

TEST(ParseLcm, ReportsTheLineOfASyntaxError) {
  EXPECT_EQ(why_not("struct a_t {\n  double x\n}\n"), "a.lcm:3: expected ;, not }");
  EXPECT_EQ(why_not("struct a_t {\n  double x[n];\n}\n"),
            "a.lcm:2: the array size n is not a constant or an earlier member");
  EXPECT_EQ(why_not("struct a_t { double n; byte x[n]; }"),
            "a.lcm:1: the array size n is not an integer");
  EXPECT_EQ(why_not("struct a_t { byte x[0]; }"),
            "a.lcm:1: an array's size must be a whole number above 0, not 0");
  EXPECT_EQ(why_not("struct a_t { byte x[3x]; }"),
            "a.lcm:1: an array's size must be a whole number above 0, not 3x");
  EXPECT_EQ(why_not("struct a_t { byte x;\n byte x; }"), "a.lcm:2: x is defined twice in a_t");
  EXPECT_EQ(why_not("struct a_t { }\nstruct a_t { }"), "a.lcm:2: struct a_t is defined twice");
  EXPECT_EQ(why_not("\nclass a_t { }"), "a.lcm:2: expected package, struct or enum, not class");
  EXPECT_EQ(why_not("struct a_t { double 3x; }"), "a.lcm:1: expected a member's name, not 3x");
  EXPECT_EQ(why_not("struct a_t {\n\n double x;\n"), "a.lcm:4: expected a type, but the file ends");
  EXPECT_EQ(why_not("struct a_t {}\n/* for\never"), "a.lcm:2: a comment is not closed");
}

TEST(ParseLcm, TerminatesForAnyInput) {
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

TEST(ParseLcm, TreatsUnknownTypesAsStructs) {
  for (const char* basic : {"int8_t", "int16_t", "int32_t", "int64_t", "byte", "float", "double",
                            "string", "boolean"}) {
    EXPECT_TRUE(is_basic_lcm_type(basic)) << basic;
    const auto structs = parse_lcm("package p; struct a_t { " + std::string(basic) + " x; }", "");
    EXPECT_EQ(structs.at(0).members.at(0).type, basic);
  }
  for (const char* other : {"uint8_t", "bool", "char", "", "Double"}) {
    EXPECT_FALSE(is_basic_lcm_type(other)) << other;
  }
  EXPECT_EQ(parse_lcm("package p; struct a_t { bool x; }", "").at(0).members.at(0).type, "p.bool");
  EXPECT_EQ(parse_lcm("struct a_t { q.bool x; }", "").at(0).members.at(0).type, "q.bool");
}

TEST(ParseLcm, ReadsSizesLikeC) {
  const auto dimensions = [](const std::string& size) {
    return parse_lcm("struct a_t { int8_t n; byte m; byte x[" + size + "]; }", "a.lcm")
        .at(0)
        .members.at(2)
        .dimensions.at(0);
  };
  EXPECT_EQ(dimensions("12").constant, 12);
  EXPECT_EQ(dimensions("12").size, "12");
  EXPECT_EQ(dimensions("0x1F").constant, 31);
  EXPECT_EQ(dimensions("020").constant, 16);
  EXPECT_EQ(dimensions("1").constant, 1);
  EXPECT_EQ(dimensions("2147483647").constant, 2'147'483'647);
  EXPECT_EQ(dimensions("n").member, 0);
  EXPECT_EQ(dimensions("n").constant, 0);
  for (const char* size : {"0", "2147483648", "08"}) {
    EXPECT_EQ(why_not("struct a_t { byte x[" + std::string(size) + "]; }"),
              "a.lcm:1: an array's size must be a whole number above 0, not " + std::string(size));
  }
  EXPECT_EQ(why_not("struct a_t { const int32_t N = -3; byte x[N]; }"),
            "a.lcm:1: an array's size must be a whole number above 0, not -3");
  EXPECT_EQ(why_not("struct a_t { const double N = 3; byte x[N]; }"),
            "a.lcm:1: the array size N is not an integer");
  EXPECT_EQ(why_not("struct a_t { int32_t n[2]; byte x[n]; }"),
            "a.lcm:1: the array size n is not an integer")
      << "but a list of integers";
  EXPECT_EQ(why_not("struct a_t { byte m; byte x[m]; }"),
            "a.lcm:1: the array size m is not an integer");
  EXPECT_EQ(why_not("struct a_t { const int32_t N = 3; }\nstruct b_t { byte x[N]; }"),
            "a.lcm:2: the array size N is not a constant or an earlier member")
      << "a member of another struct";
}

TEST(ParseLcm, CountsLinesAcrossComments) {
  EXPECT_EQ(why_not("/* one\n two */ // three\n struct a_t { struct b_t x; }"),
            "a.lcm:3: struct inside a struct is not allowed");
  EXPECT_EQ(why_not("struct a_t {\n\n enum b x; }"),
            "a.lcm:3: enum inside a struct is not allowed");
  EXPECT_EQ(why_not("struct a_t { const int32_t N = 3,\n N = 4; }"),
            "a.lcm:2: N is defined twice in a_t");
  EXPECT_EQ(why_not("struct a_t { const int32_t N = 3; byte N; }"),
            "a.lcm:1: N is defined twice in a_t");
  EXPECT_EQ(why_not("package p;\nstruct a_t {}\n\nstruct a_t {}"),
            "a.lcm:4: struct p.a_t is defined twice");
  EXPECT_EQ(why_not("package 3;"), "a.lcm:1: expected a package, not 3");
  EXPECT_EQ(why_not("enum {"), "a.lcm:1: expected an enum, not {");
  EXPECT_EQ(why_not("enum e_t { A,\n B"), "a.lcm:2: expected }, but the file ends");
  EXPECT_EQ(why_not("struct a_t { byte x[3; }"), "a.lcm:1: expected ], not ;");
  EXPECT_EQ(why_not("\n\nstruct a_t { byte x; }\n}"),
            "a.lcm:4: expected package, struct or enum, not }");
  EXPECT_EQ(why_not("struct a_t { byte _x, x2/**/, x3//\n; }"), "");
}

TEST(ParseLcm, RecordsTheLineOfEachStruct) {
  const auto structs = parse_lcm("struct a_t {\n byte x;\n}\n\nstruct\n b_t { byte x; }", "");
  ASSERT_EQ(structs.size(), 2U);
  EXPECT_EQ(structs[0].line, 1U);
  EXPECT_EQ(structs[1].line, 5U);
}

}  // namespace
}  // namespace vantage::logs
