#include "logs/edit/channel_rules.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage::logs {
namespace {

template <class Make>
std::string why_not(const Make& make) {
  try {
    make();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(ChannelFilter, AppliesIncludesAndExcludes) {
  ChannelFilter all;
  EXPECT_TRUE(all.takes(""));
  EXPECT_TRUE(all.takes("VICON"));
  ChannelFilter some({"PLAN_.*", "VICON"}, {".*_Q2", "X"});
  ChannelFilter others({}, {".*_Q2", "X"});
  for (int time = 0; time < 2; ++time) {  // the second result comes from the cache
    EXPECT_TRUE(some.takes("PLAN_Q1"));
    EXPECT_TRUE(some.takes("VICON"));
    EXPECT_FALSE(some.takes("PLAN_Q2"));
    EXPECT_FALSE(some.takes("XVICON"));
    EXPECT_FALSE(some.takes("VICONX"));
    EXPECT_FALSE(some.takes("TRUTH"));
    EXPECT_TRUE(others.takes("TRUTH"));
    EXPECT_FALSE(others.takes("PLAN_Q2"));
    EXPECT_FALSE(others.takes("X"));
  }
}

TEST(ChannelFilter, IsCorrectForManyNames) {
  ChannelFilter even({".*[02468]"}, {});
  for (int i = 0; i < 20'002; ++i) {
    const std::string name = "C" + std::to_string(i);
    ASSERT_EQ(even.takes(name), i % 2 == 0) << name;
    ASSERT_EQ(even.takes(name), i % 2 == 0) << name;
  }
  EXPECT_TRUE(even.takes("C0"));
}

TEST(ChannelFilter, ReportsAnInvalidExpression) {
  const std::string why = why_not([] { ChannelFilter({"A", "(B"}, {}); });
  EXPECT_EQ(why.find("channel expression '(B' is not a valid regular expression: "), 0U) << why;
  EXPECT_NE(why_not([] { ChannelFilter({}, {"[C"}); }).find("'[C'"), std::string::npos);
}

TEST(ChannelRenames, ApplyTheFirstMatchingRule) {
  const ChannelRenames names({"A=B", "A*=C_*", "AB=D", "X*=*"});
  EXPECT_EQ(names.rename("A"), "B");
  EXPECT_EQ(names.rename("AB"), "C_B") << "the second rule also matches and has priority";
  EXPECT_EQ(names.rename("BA"), "BA");
  EXPECT_EQ(names.rename("XYZ"), "YZ");
  EXPECT_EQ(names.rename("X"), std::nullopt) << "the name would be empty";
  EXPECT_EQ(ChannelRenames().rename("A"), "A");
}

TEST(ChannelRenames, RefuseNamesTooLongForLcm) {
  const std::string longest(63, 'B');
  const ChannelRenames names({"A*=" + longest.substr(3) + "*"});
  EXPECT_EQ(names.rename("ABBB"), longest);
  EXPECT_EQ(names.rename("ABBBB"), std::nullopt);
}

TEST(ChannelRenames, ReportAnInvalidRule) {
  const auto why = [](const std::string& rule) {
    return why_not([&] { ChannelRenames({"GOOD=FINE", rule}); });
  };
  for (const char* rule : {"A", "=A", "A=", "="}) {
    EXPECT_EQ(why(rule), "rename rule '" + std::string(rule) + "': must be OLD=NEW or OLD*=NEW*");
  }
  for (const char* rule : {"A*=B", "A=B*"}) {
    EXPECT_EQ(why(rule),
              "rename rule '" + std::string(rule) + "': both names must end in '*', or neither");
  }
  EXPECT_EQ(why("A=B"), "");
  EXPECT_EQ(why("A*=B*"), "");
  EXPECT_EQ(why("*=B*"), "") << "all of them";
}

}  // namespace
}  // namespace vantage::logs
