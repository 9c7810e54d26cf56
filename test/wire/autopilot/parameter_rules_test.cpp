#include "wire/autopilot/parameter_rules.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage::wire {
namespace {

using Kind = ParameterRule::Kind;

ParameterRule rule(const std::string& line) { return parse_parameter_rules(line).at(0); }

std::string refusal(const std::string& text) {
  try {
    parse_parameter_rules(text);
  } catch (const StartupError& error) {
    return error.what();
  }
  return "taken";
}

TEST(ParameterRules, AreParsedFromLines) {
  const auto rules = parse_parameter_rules(
      "# a comment\n\nGUID_TIMEOUT 0.3  # at most 0.5: it flies on\r\nA\t-1 # exactly: b: c\n");
  ASSERT_EQ(rules.size(), 2U);
  EXPECT_EQ(rules[0].name, "GUID_TIMEOUT");
  EXPECT_EQ(rules[0].value, 0.3);
  EXPECT_EQ(rules[0].kind, Kind::kAtMost);
  EXPECT_FALSE(rules[0].is_advised);
  EXPECT_EQ(rules[0].effect, "it flies on");
  EXPECT_EQ(rules[1].name, "A");
  EXPECT_EQ(rules[1].value, -1.0);
  EXPECT_EQ(rules[1].effect, "b: c");
  EXPECT_TRUE(rule("A 1 # advised, exactly: b").is_advised);
}

TEST(ParameterRules, AcceptTheStatedValues) {
  EXPECT_TRUE(rule("A 0.3 # exactly: b").accepts(static_cast<double>(0.3F)));
  EXPECT_FALSE(rule("A 0.3 # exactly: b").accepts(0.30001));
  EXPECT_TRUE(rule("A 0.3 # at most 0.5: b").accepts(static_cast<double>(0.5F)));
  EXPECT_FALSE(rule("A 0.3 # at most 0.5: b").accepts(0.51));
  EXPECT_TRUE(rule("A 500 # at least 400: b").accepts(400.0));
  EXPECT_FALSE(rule("A 500 # at least 400: b").accepts(399.0));
  EXPECT_TRUE(rule("A 10 # between 1 and 20: b").accepts(1.0));
  EXPECT_FALSE(rule("A 10 # between 1 and 20: b").accepts(0.0));
  EXPECT_FALSE(rule("A 10 # between 1 and 20: b").accepts(21.0));
  EXPECT_TRUE(rule("A 0 # one of 0 3: b").accepts(3.0));
  EXPECT_FALSE(rule("A 0 # one of 0 3: b").accepts(1.0));
}

// The tolerance is a millionth of the larger magnitude, for values of either sign.
TEST(ParameterRules, AreSymmetricInTheSign) {
  for (const char* const sign : {"", "-"}) {
    const std::string about = std::string("A ") + sign + "8.000008000004 # exactly: b";
    EXPECT_TRUE(rule(about).accepts(*sign == '-' ? -8.0 : 8.0)) << about;
    EXPECT_FALSE(rule(about).accepts(*sign == '-' ? -7.99999 : 7.99999)) << about;
  }
}

// The tolerance is a millionth of max(1, magnitude). It applies on each side of each bound of each
// kind of rule.
TEST(ParameterRules, AllowARelativeErrorOfOneMillionth) {
  for (const double at : {-3000.0, -0.25, 0.0, 0.25, 3000.0}) {
    const double little = 0.9e-6 * std::max(1.0, std::abs(at));
    const double much = 1.2e-6 * std::max(1.0, std::abs(at));
    ParameterRule rule;
    rule.value = at;
    for (const double sign : {-1.0, 1.0}) {
      rule.kind = Kind::kExactly;
      EXPECT_TRUE(rule.accepts(at + sign * little)) << at;
      EXPECT_FALSE(rule.accepts(at + sign * much)) << at;
      EXPECT_FALSE(rule.accepts(at + sign * 1e5)) << at;
      rule.kind = Kind::kAtMost;
      rule.bounds = {at};
      EXPECT_TRUE(rule.accepts(at + little)) << at;
      EXPECT_EQ(rule.accepts(at + sign * much), sign < 0.0) << at;
      EXPECT_EQ(rule.accepts(at + sign * 1e5), sign < 0.0) << at;
      rule.kind = Kind::kAtLeast;
      EXPECT_TRUE(rule.accepts(at - little)) << at;
      EXPECT_EQ(rule.accepts(at + sign * much), sign > 0.0) << at;
      EXPECT_EQ(rule.accepts(at + sign * 1e5), sign > 0.0) << at;
      rule.kind = Kind::kBetween;
      rule.bounds = {at, at + 7.0};
      EXPECT_TRUE(rule.accepts(at - little) && rule.accepts(at + 3.0)) << at;
      EXPECT_FALSE(rule.accepts(at - much)) << at;
      rule.bounds = {at - 7.0, at};
      EXPECT_TRUE(rule.accepts(at + little) && rule.accepts(at - 3.0)) << at;
      EXPECT_FALSE(rule.accepts(at + much)) << at;
      rule.kind = Kind::kOneOf;
      rule.bounds = {at - 7.0, at, at + 7.0};
      for (const double allowed : rule.bounds) {
        EXPECT_TRUE(rule.accepts(allowed)) << at;
      }
      EXPECT_FALSE(rule.accepts(at + sign * much)) << at;
      EXPECT_FALSE(rule.accepts(at + sign * 3.0)) << at;
    }
  }
}

TEST(ParameterRules, DescribeTheExpectedValue) {
  EXPECT_EQ(rule("A 7.25 # exactly: b").requirement_text(), "7.25");
  EXPECT_EQ(rule("A 7 # at most 8: b").requirement_text(), "at most 8");
  EXPECT_EQ(rule("A 7 # at least -6: b").requirement_text(), "at least -6");
  EXPECT_EQ(rule("A 7 # between 6 and 8: b").requirement_text(), "between 6 and 8");
  EXPECT_EQ(rule("A 7 # one of 7: b").requirement_text(), "7");
  EXPECT_EQ(rule("A 7 # one of 6 7: b").requirement_text(), "6 or 7");
  EXPECT_EQ(rule("A 7 # one of 5 6 7 8: b").requirement_text(), "5, 6, 7 or 8");
  EXPECT_EQ(parameter_text(static_cast<double>(0.3F)), "0.3");
}

TEST(ParameterRules, ReportValueRuleAndConsequence) {
  EXPECT_EQ(rule("GUID_TIMEOUT 0.3 # at most 0.5: it flies on").violation_text(3.0),
            "GUID_TIMEOUT is 3, must be at most 0.5: it flies on");
  EXPECT_EQ(rule("A 0 # one of 0 3 5: b").violation_text(1.0), "A is 1, must be 0, 3 or 5: b");
  EXPECT_EQ(rule("A 2 # between 1 and 3: b").violation_text(std::nullopt),
            "A is missing, must be between 1 and 3: b");
  EXPECT_EQ(rule("A 0.05 # exactly: b").violation_text(static_cast<double>(0.2F)),
            "A is 0.2, must be 0.05: b");
}

TEST(ParameterRules, RefuseMalformedLinesWithTheirNumber) {
  EXPECT_EQ(refusal("A 1 # exactly: b\nB 1\n"),
            "line 2: must be `NAME VALUE  # RULE: what happens otherwise`");
  EXPECT_EQ(refusal("A 1 # roughly: b"), "line 1: 'roughly' is not a rule");
  EXPECT_EQ(refusal("A one # exactly: b"), "line 1: ' one' is not a number");
  EXPECT_EQ(refusal("A 1 # at most: b"), "line 1: 'at most' is not a rule");
  EXPECT_NE(refusal("A 1 # at most x: b"), "taken");
  EXPECT_NE(refusal("A 1 # between 1: b"), "taken");
  EXPECT_NE(refusal("A 1 # one of : b"), "taken");
  EXPECT_NE(refusal("A # exactly: b"), "taken");
  EXPECT_NE(refusal("LONGER_THAN_16_IT 1 # exactly: b"), "taken");
  EXPECT_EQ(refusal("A 1 # at most 0: b"), "line 1: A violates its own rule");
  EXPECT_EQ(refusal("A 1 # exactly: b\nA 1 # exactly: b"), "line 2: A is listed twice");
}

TEST(ParameterRules, RequireTheNumberOfBoundsOfTheirKind) {
  for (const char* const line :
       {"A 1 # exactly 1: b", "A 1 # at most 1 2: b", "A 1 # at least 1 1: b",
        "A 1 # between 1 and 2 3: b", "A 1 # between 0 1 and 2: b", "A 1 # between and 2: b",
        "A 1 # between 1 and: b", "A 1 # one of: b", "A 1 2 # exactly: b", "1 # exactly: b",
        "A 1 exactly: b", "A 1 # exactly"}) {
    EXPECT_NE(refusal(line), "taken") << line;
  }
  EXPECT_EQ(rule("EXACTLY_16_CHARS 1 # exactly: b").name, "EXACTLY_16_CHARS");
  EXPECT_NE(refusal("ONE_MORE_THAN_16_ 1 # exactly: b"), "taken");
  EXPECT_EQ(rule("A:B 1 # exactly: b").name, "A:B") << "a name may contain a colon";
}

TEST(ParameterRules, CountEmptyLinesInLineNumbers) {
  EXPECT_EQ(refusal("\n# a comment\n\t\nA 1 # exactly: b\nA 1 # roughly: b"),
            "line 5: 'roughly' is not a rule");
  EXPECT_EQ(refusal("A 1 # exactly: b\nB 1 # exactly: b\nC 1 # exactly: b\nB 1 # exactly: c"),
            "line 4: B is listed twice");
  EXPECT_EQ(parse_parameter_rules("A 1 # exactly: b\nB 2 # exactly: c").at(1).effect, "c");
  EXPECT_TRUE(parse_parameter_rules("").empty());
}

TEST(ParameterEncoding, MatchesTheAutopilot) {
  EXPECT_EQ(parameter_encoding(models::AutopilotDialect::kPx4),
            mavlink::ParameterEncoding::kBytewise);
  EXPECT_EQ(parameter_encoding(models::AutopilotDialect::kArdupilot),
            mavlink::ParameterEncoding::kCast);
}

TEST(ParameterFiles, ContainTheDriversRequiredParameters) {
  const auto has = [](models::AutopilotDialect dialect, const std::string& name) {
    const auto& rules = parameter_rules(dialect);
    return std::any_of(rules.begin(), rules.end(), [&](const ParameterRule& found) {
      return found.name == name && !found.is_advised;
    });
  };
  for (const char* name : {"GUID_TIMEOUT", "FS_GCS_ENABLE", "EK3_SRC1_YAW", "COMPASS_USE"}) {
    EXPECT_TRUE(has(models::AutopilotDialect::kArdupilot, name)) << name;
  }
  for (const char* name : {"COM_OF_LOSS_T", "COM_OBL_RC_ACT", "EKF2_EV_CTRL"}) {
    EXPECT_TRUE(has(models::AutopilotDialect::kPx4, name)) << name;
  }
}

TEST(ParameterFiles, AreReadableByArdupilotsTools) {
  std::istringstream lines(parameter_file(models::AutopilotDialect::kArdupilot));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LT(line.size(), 98U) << line;
  }
}

}  // namespace
}  // namespace vantage::wire
