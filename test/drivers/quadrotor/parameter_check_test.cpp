// Tests requests for parameters, their repetition, and the evaluation of replies.

#include "drivers/quadrotor/parameter_check.hpp"

#include <map>

#include <gtest/gtest.h>

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// A check of three parameters, and an autopilot that replies with the values that it knows.
struct Bench {
  ParameterCheck check{AutopilotDialect::kArdupilot,
                       wire::parse_parameter_rules("GUID_TIMEOUT 0.3 # at most 0.5: it flies on\n"
                                                   "FS_GCS_ENABLE 5 # exactly: it stays\n"
                                                   "VISO_DELAY_MS 10 # advised, exactly: late\n")};
  std::map<std::string, double> known{
      {"GUID_TIMEOUT", 0.3}, {"FS_GCS_ENABLE", 5.0}, {"VISO_DELAY_MS", 10.0}};
  std::map<std::string, int> requests;
  std::map<std::string, int> set;
  Time now = kStart;

  void answer(const std::string& name) {
    if (known.contains(name)) {
      check.take({static_cast<float>(known[name]), 3, 0, wire::mavlink::parameter_id(name), 9},
                 now);
    }
  }
  void run(double seconds, bool answers = true) {
    const Time end = now + from_seconds(seconds);
    for (; now < end; now += Duration{20'000}) {
      const ParameterCheck::Due due = check.due(now);
      for (const auto& read : due.reads) {
        EXPECT_EQ(read.param_index, -1) << "requested by name";
        ++requests[wire::mavlink::parameter_name(read.param_id)];
        if (answers) {
          answer(wire::mavlink::parameter_name(read.param_id));
        }
      }
      for (const auto& one : due.sets) {
        const std::string name = wire::mavlink::parameter_name(one.param_id);
        ++set[name];
        if (answers && known.contains(name)) {
          known[name] = static_cast<double>(one.param_value);
          answer(name);
        }
      }
    }
  }
};

TEST(ParameterCheck, RequestsEachParameterOnce) {
  Bench bench;
  EXPECT_FALSE(bench.check.is_kept()) << "no value is known yet";
  EXPECT_EQ(bench.check.reasons(),
            std::vector<std::string>{"reading the autopilot's parameters: 0 of 3"});
  bench.run(5.0);
  EXPECT_EQ(bench.requests.size(), 3U);
  for (const auto& [name, count] : bench.requests) {
    EXPECT_EQ(count, 1) << name;
  }
  EXPECT_TRUE(bench.check.is_complete());
  EXPECT_TRUE(bench.check.is_kept());
  EXPECT_TRUE(bench.check.reasons().empty());
  EXPECT_NEAR(bench.check.value("GUID_TIMEOUT").value_or(0.0), 0.3, 1e-6);
}

TEST(ParameterCheck, RepeatsUnansweredRequestsThenGivesUp) {
  Bench bench;
  bench.known.erase("FS_GCS_ENABLE");
  bench.run(2.0);
  EXPECT_FALSE(bench.check.is_complete());
  bench.run(3.0);
  EXPECT_TRUE(bench.check.is_complete());
  EXPECT_EQ(bench.requests["FS_GCS_ENABLE"], ParameterCheck::kRequestsMax);
  EXPECT_FALSE(bench.check.is_kept());
  EXPECT_EQ(bench.check.reasons(),
            std::vector<std::string>{"FS_GCS_ENABLE is missing, must be 5: it stays"});
}

TEST(ParameterCheck, LimitsPendingRequests) {
  Bench bench;
  bench.check = ParameterCheck(AutopilotDialect::kArdupilot,
                               wire::parameter_rules(AutopilotDialect::kArdupilot));
  EXPECT_EQ(bench.check.due(kStart).reads.size(),
            static_cast<std::size_t>(ParameterCheck::kUnderWayMax));
  EXPECT_TRUE(bench.check.due(kStart).reads.empty());
}

TEST(ParameterCheck, ReportsRequiredDifferences) {
  Bench bench;
  bench.known["GUID_TIMEOUT"] = 3.0;
  bench.known["VISO_DELAY_MS"] = 60.0;
  bench.run(2.0);
  EXPECT_FALSE(bench.check.is_kept());
  EXPECT_EQ(bench.check.reasons(),
            std::vector<std::string>{"GUID_TIMEOUT is 3, must be at most 0.5: it flies on"});
  bench.known["GUID_TIMEOUT"] = 0.5;
  bench.answer("GUID_TIMEOUT");  // changed by another client and broadcast by the autopilot
  EXPECT_TRUE(bench.check.is_kept());
}

TEST(ParameterCheck, RefreshesValues) {
  Bench bench;
  bench.run(2.0);
  ASSERT_TRUE(bench.check.is_kept());
  bench.known["FS_GCS_ENABLE"] = 0.0;  // changed without a broadcast
  bench.run(to_seconds(ParameterCheck::kRefresh) + 1.0);
  EXPECT_FALSE(bench.check.is_kept());
  bench.known.clear();
  bench.run(2.0 * to_seconds(ParameterCheck::kRefresh));
  EXPECT_EQ(bench.check.value("GUID_TIMEOUT"), std::nullopt) << "an old value is dropped";
}

TEST(ParameterCheck, RestartsAfterALostLink) {
  Bench bench;
  bench.run(2.0);
  ASSERT_TRUE(bench.check.is_kept());
  bench.check.restart();
  EXPECT_FALSE(bench.check.is_kept());
  EXPECT_EQ(bench.check.value("GUID_TIMEOUT"), std::nullopt);
  bench.run(2.0);
  EXPECT_TRUE(bench.check.is_kept());
}

TEST(ParameterCheck, SetsOnlyDifferingParameters) {
  Bench bench;
  bench.known["GUID_TIMEOUT"] = 3.0;
  bench.known["FS_GCS_ENABLE"] = 0.0;
  bench.known.erase("VISO_DELAY_MS");
  bench.run(5.0);
  EXPECT_TRUE(bench.set.empty()) << "no parameter is set without a request";
  bench.check.repair();
  EXPECT_FALSE(bench.check.is_complete());
  bench.run(2.0);
  EXPECT_TRUE(bench.check.is_complete());
  EXPECT_EQ(bench.set, (std::map<std::string, int>{{"GUID_TIMEOUT", 1}, {"FS_GCS_ENABLE", 1}}));
  EXPECT_TRUE(bench.check.is_kept());
}

TEST(ParameterCheck, GivesUpParametersThatCannotBeSet) {
  Bench bench;
  bench.known["GUID_TIMEOUT"] = 3.0;
  bench.run(2.0);
  bench.check.repair();
  bench.run(10.0, false);
  EXPECT_TRUE(bench.check.is_complete());
  EXPECT_EQ(bench.set["GUID_TIMEOUT"], ParameterCheck::kRequestsMax);
  EXPECT_FALSE(bench.check.is_kept());
}

TEST(ParameterCheck, IgnoresUnknownNamesAndNonFiniteValues) {
  Bench bench;
  bench.check.take({std::numeric_limits<float>::quiet_NaN(), 3, 0,
                    wire::mavlink::parameter_id("GUID_TIMEOUT"), 9},
                   kStart);
  bench.check.take({1.0F, 3, 0, wire::mavlink::parameter_id("OTHER"), 9}, kStart);
  EXPECT_EQ(bench.check.settled(), 0U);
}

}  // namespace
}  // namespace vantage::drivers
