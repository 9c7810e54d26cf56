#include "logs/foxglove/session_watch.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::logs::foxglove {
namespace {

struct Notice {
  double at_s;
  std::int64_t run;
  const char* yaml;
  bool begins;
};

struct Case {
  const char* name;
  std::vector<Notice> notices;
};

void PrintTo(const Case& of, std::ostream* out) { *out << of.name; }

class SessionWatchTest : public ::testing::TestWithParam<Case> {};

TEST_P(SessionWatchTest, BeginsASessionPerTrial) {
  SessionWatch watch;
  for (const Notice& each : GetParam().notices) {
    models::ScenarioNotice notice;
    notice.stamp.run_id = each.run;
    notice.yaml = each.yaml;
    EXPECT_EQ(watch.on(notice, Time{} + from_seconds(each.at_s)), each.begins) << each.at_s << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sessions, SessionWatchTest,
    ::testing::Values(
        Case{"OneTrial", {{0, 1, "a", true}, {5, 1, "a", false}, {10, 1, "a", false}}},
        Case{"AnotherScenarioAtOnce", {{0, 1, "a", true}, {1, 2, "b", true}}},
        Case{"TheSameScenarioAfterAPause",
             {{0, 1, "a", true}, {5, 1, "a", false}, {14, 2, "a", true}, {19, 2, "a", false}}},
        Case{"TheSameScenarioAtOnceCountsFromItsSecondMessage",
             {{0, 1, "a", true}, {5, 1, "a", false}, {7, 2, "a", false}, {12, 2, "a", true}}},
        Case{"TwoHostsOfOneTrial",
             {{0, 1, "a", true},
              {2, 2, "a", false},
              {5, 1, "a", false},
              {7, 2, "a", false},
              {10, 1, "a", false},
              {17, 2, "a", false}}},
        Case{"APlayedLogThatJumpsBack", {{100, 1, "a", true}, {3, 1, "a", false}}}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace vantage::logs::foxglove
