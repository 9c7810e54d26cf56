#include "wire/autopilot/parameter_rules.hpp"

#include <algorithm>
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

TEST(ParameterRules, AreReadFromLines) {
  const auto rules = parse_parameter_rules(
      "# a comment\n\nGUID_TIMEOUT 0.3  # at most 0.5: it flies on\r\nA\t-1 # exactly: b: c\n");
  ASSERT_EQ(rules.size(), 2U);
  EXPECT_EQ(rules[0].name, "GUID_TIMEOUT");
  EXPECT_EQ(rules[0].value, 0.3);
  EXPECT_EQ(rules[0].kind, Kind::kAtMost);
  EXPECT_FALSE(rules[0].is_advised);
  EXPECT_EQ(rules[0].otherwise, "it flies on");
  EXPECT_EQ(rules[1].name, "A");
  EXPECT_EQ(rules[1].value, -1.0);
  EXPECT_EQ(rules[1].otherwise, "b: c");
  EXPECT_TRUE(rule("A 1 # advised, exactly: b").is_advised);
}

TEST(ParameterRules, AcceptWhatTheySay) {
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

// By a millionth of whichever of the two is further from zero.
TEST(ParameterRules, AcceptANumberAsTheyAcceptItsNegative) {
  for (const char* const sign : {"", "-"}) {
    const std::string about = std::string("A ") + sign + "8.000008000004 # exactly: b";
    EXPECT_TRUE(rule(about).accepts(*sign == '-' ? -8.0 : 8.0)) << about;
    EXPECT_FALSE(rule(about).accepts(*sign == '-' ? -7.99999 : 7.99999)) << about;
  }
}

TEST(ParameterRules, SayTheValueTheRuleAndWhatWouldHappen) {
  EXPECT_EQ(rule("GUID_TIMEOUT 0.3 # at most 0.5: it flies on").complaint(3.0),
            "GUID_TIMEOUT is 3, wanted is at most 0.5: it flies on");
  EXPECT_EQ(rule("A 0 # one of 0 3 5: b").complaint(1.0), "A is 1, wanted is 0, 3 or 5: b");
  EXPECT_EQ(rule("A 2 # between 1 and 3: b").complaint(std::nullopt),
            "A is not there, wanted is between 1 and 3: b");
  EXPECT_EQ(rule("A 0.05 # exactly: b").complaint(static_cast<double>(0.2F)),
            "A is 0.2, wanted is 0.05: b");
}

TEST(ParameterRules, RefuseWhatIsNoneAndNameTheLine) {
  EXPECT_EQ(refusal("A 1 # exactly: b\nB 1\n"),
            "line 2: must be `NAME VALUE  # RULE: what happens otherwise`");
  EXPECT_EQ(refusal("A 1 # roughly: b"), "line 1: 'roughly' is no rule");
  EXPECT_EQ(refusal("A one # exactly: b"), "line 1: ' one' is no number");
  EXPECT_EQ(refusal("A 1 # at most: b"), "line 1: 'at most' is no rule");
  EXPECT_NE(refusal("A 1 # at most x: b"), "taken");
  EXPECT_NE(refusal("A 1 # between 1: b"), "taken");
  EXPECT_NE(refusal("A 1 # one of : b"), "taken");
  EXPECT_NE(refusal("A # exactly: b"), "taken");
  EXPECT_NE(refusal("LONGER_THAN_16_IT 1 # exactly: b"), "taken");
  EXPECT_EQ(refusal("A 1 # at most 0: b"), "line 1: A breaks its own rule");
  EXPECT_EQ(refusal("A 1 # exactly: b\nA 1 # exactly: b"), "line 2: A comes a second time");
}

TEST(ParameterFiles, AreReadAndNameWhatTheDriverCannotDoWithout) {
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

TEST(ParameterFiles, HaveNoLineThatArdupilotsOwnToolsWouldCut) {
  std::istringstream lines(parameter_file(models::AutopilotDialect::kArdupilot));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LT(line.size(), 98U) << line;
  }
}

}  // namespace
}  // namespace vantage::wire
