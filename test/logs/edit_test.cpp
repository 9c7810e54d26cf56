#include "logs/edit/edit.hpp"

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "core/check.hpp"
#include "logs/record/log_writer.hpp"
#include "test/logs/damage.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

using test::Bytes;

/// An event: time (µs), channel, first byte of its data.
using Kept = std::vector<std::tuple<std::int64_t, std::string, int>>;

class Edit : public ::testing::Test {
 protected:
  IndexedLog log_of(const std::string& name, const Kept& events) {
    Bytes bytes;
    std::int64_t number = 0;
    for (const auto& [utime, channel, value] : events) {
      const Bytes data{static_cast<std::uint8_t>(value)};
      append_event({number++, from_utime(utime), channel, data}, bytes);
    }
    test::write_file(folder_.file(name), bytes);
    return IndexedLog(folder_.file(name));
  }
  static EventSink into(Kept& kept) {
    return [&kept](const LogEvent& event) {
      kept.emplace_back(to_utime(event.time), event.channel, event.data[0]);
      return true;
    };
  }
  test::TemporaryFolder folder_;
};

TEST_F(Edit, CutsAHalfOpenIntervalAndPrependsTheScenario) {
  const IndexedLog log = log_of("a", {{0, "SCENARIO", 1},
                                      {5'000'000, "SCENARIO", 2},
                                      {6'000'000, "A", 3},
                                      {7'000'000, "B", 4},
                                      {8'000'000, "A", 5}});
  EditRules rules;
  rules.from = from_utime(6'500'000);
  rules.to = from_utime(8'000'000);
  Kept kept;
  const EditCounts counts = edit_log(log, rules, into(kept));
  EXPECT_EQ(kept, (Kept{{6'500'000, "SCENARIO", 2}, {7'000'000, "B", 4}}));
  EXPECT_EQ(counts.written, 2);
}

TEST_F(Edit, FindsTheOnlyScenarioOfALog) {
  const IndexedLog log = log_of("a", {{0, "SCENARIO", 1}, {90'000'000, "A", 2}});
  EditRules rules;
  rules.from = from_utime(80'000'000);
  Kept kept;
  edit_log(log, rules, into(kept));
  EXPECT_EQ(kept, (Kept{{80'000'000, "SCENARIO", 1}, {90'000'000, "A", 2}}));
}

TEST_F(Edit, KeepsEveryEventWhenTimesGoBack) {
  const IndexedLog log = log_of("a", {{10, "A", 1}, {30, "A", 2}, {20, "A", 3}, {40, "A", 4}});
  EditRules rules;
  rules.from = from_utime(15);
  rules.to = from_utime(25);
  Kept kept;
  edit_log(log, rules, into(kept));
  EXPECT_EQ(kept, (Kept{{20, "A", 3}}));
}

TEST_F(Edit, MatchesWholeChannelNames) {
  const IndexedLog log = log_of("a", {{1, "VICON", 1}, {2, "VICON_RAW", 2}, {3, "PLAN_Q1", 3}});
  EditRules rules;
  rules.channels = ChannelFilter({"VICON", "PLAN_.*"}, {"PLAN_Q2"});
  Kept kept;
  const EditCounts counts = edit_log(log, rules, into(kept));
  EXPECT_EQ(kept, (Kept{{1, "VICON", 1}, {3, "PLAN_Q1", 3}}));
  EXPECT_EQ(counts.left_out, 1);
  EXPECT_THROW(ChannelFilter({"("}, {}), UsageError);
}

TEST_F(Edit, RenamesWholeChannelNamesAndPrefixes) {
  const IndexedLog log =
      log_of("a", {{1, "VICON", 1}, {2, "VICON_RAW", 2}, {3, "PLAN_Q1", 3}, {4, "A", 4}});
  EditRules rules;
  rules.names = ChannelRenames({"VICON=MOCAP", "PLAN_*=OLD_PLAN_*", "A=" + std::string(64, 'A')});
  Kept kept;
  const EditCounts counts = edit_log(log, rules, into(kept));
  EXPECT_EQ(kept, (Kept{{1, "MOCAP", 1}, {2, "VICON_RAW", 2}, {3, "OLD_PLAN_Q1", 3}}));
  EXPECT_EQ(counts.invalid_names, 1);
  EXPECT_THROW(ChannelRenames({"VICON"}), UsageError);
  EXPECT_THROW(ChannelRenames({"VICON*=X"}), UsageError);
  EXPECT_THROW(ChannelRenames({"=X"}), UsageError);
}

TEST_F(Edit, MergesByTimeAndKeepsEachLogsOrder) {
  const IndexedLog a = log_of("a", {{10, "A", 1}, {30, "A", 2}, {30, "A", 3}, {50, "A", 4}});
  const IndexedLog b = log_of("b", {{10, "B", 5}, {20, "B", 6}, {30, "B", 7}});
  const IndexedLog none = log_of("c", {});
  Kept kept;
  const EditCounts counts = merge_logs({&a, &none, &b}, into(kept));
  EXPECT_EQ(kept, (Kept{{10, "A", 1},
                        {10, "B", 5},
                        {20, "B", 6},
                        {30, "A", 2},
                        {30, "A", 3},
                        {30, "B", 7},
                        {50, "A", 4}}));
  EXPECT_EQ(counts.written, 7);
}

TEST_F(Edit, RepairsATruncatedLog) {
  const Kept events{{10, "A", 1}, {20, "B", 2}, {30, "A", 3}, {40, "B", 4}};
  log_of("whole", events);
  Bytes torn = test::read_file(folder_.file("whole"));
  const std::size_t size = torn.size() / 4;
  torn[size] = 0;                // damages the second event's sync word
  torn.resize(torn.size() - 1);  // cuts the fourth event's data
  test::write_file(folder_.file("torn"), torn);
  const IndexedLog log(folder_.file("torn"));
  EditRules rules;
  {
    LogWriter writer(folder_.file("mended"));
    edit_log(log, rules, [&](const LogEvent& event) {
      return writer.write(event.time, event.channel, event.data);
    });
  }
  lcm::LogFile mended(folder_.file("mended"), "r");
  Kept read;
  while (const lcm::LogEvent* event = mended.readNextEvent()) {
    read.emplace_back(event->timestamp, event->channel,
                      *static_cast<const std::uint8_t*>(event->data));
  }
  EXPECT_EQ(read, (Kept{{10, "A", 1}, {30, "A", 3}}));
  EXPECT_TRUE(survey_log(test::read_file(folder_.file("mended"))).is_whole());
}

// Tests the functions behind `vantage log check` and `repair` on files.
TEST_F(Edit, RepairsAThousandDamagedLogs) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    // Each log gets its own file, since truncating a file that was just written is slow.
    const std::string torn = folder_.file("torn" + std::to_string(seed));
    const std::string mended = folder_.file("mended" + std::to_string(seed));
    std::mt19937_64 rng(seed + 1'000'000);
    const test::MadeLog made = test::random_log(rng, 40);
    const test::DamagedLog damaged = test::damage(made, rng);
    test::write_file(torn, damaged.bytes);
    const IndexedLog log(torn);
    EditRules rules;
    {
      LogWriter writer(mended);
      edit_log(log, rules, [&](const LogEvent& event) {
        return writer.write(event.time, event.channel, event.data);
      });
    }
    const Bytes bytes = test::read_file(mended);
    ASSERT_TRUE(survey_log(bytes).is_whole()) << "seed " << seed;
    LogScan scan(bytes);
    std::optional<LocatedEvent> event = scan.next();
    const auto is = [&](const LogEvent& wanted) {
      return event->time == wanted.time && event->channel == wanted.channel &&
             std::equal(event->data.begin(), event->data.end(), wanted.data.begin(),
                        wanted.data.end());
    };
    for (const auto& [offset, size] : damaged.intact) {
      const LogEvent wanted = *event_at(damaged.bytes, offset);
      while (event && !is(wanted)) {
        event = scan.next();
      }
      ASSERT_TRUE(event.has_value()) << "seed " << seed << ", event at byte " << offset;
      event = scan.next();
    }
  }
}

TEST_F(Edit, EndsAtTheFirstWriteError) {
  const IndexedLog log = log_of("a", {{10, "A", 1}, {30, "A", 2}});
  EditRules rules;
  const EditCounts counts = edit_log(log, rules, [](const LogEvent&) { return false; });
  EXPECT_EQ(counts.failed, 1);
  EXPECT_EQ(counts.written, 0);
}

TEST_F(Edit, EndsOnRequest) {
  const IndexedLog log = log_of("a", {{10, "A", 1}, {30, "A", 2}, {50, "A", 3}});
  int checks = 0;
  EditRules rules;
  rules.stop = [&] { return ++checks > 2; };
  const EditCounts counts = edit_log(log, rules, [](const LogEvent&) { return true; });
  EXPECT_TRUE(counts.is_stopped);
  EXPECT_EQ(counts.written, 2);
  checks = 1;
  const EditCounts merged = merge_logs(
      {&log, &log}, [](const LogEvent&) { return true; }, [&] { return ++checks > 2; });
  EXPECT_TRUE(merged.is_stopped);
  EXPECT_EQ(merged.written, 1);
}

// The scenario is searched for up to 15 s (three SCENARIO periods) before the part. If none is
// found there, the first scenario of the log is used.
TEST_F(Edit, SearchesFifteenSecondsBackForTheScenario) {
  const auto scenario_of = [&](const Kept& events, std::int64_t from) {
    const IndexedLog log =
        log_of("a" + std::to_string(events.size()) + std::to_string(from), events);
    EditRules rules;
    rules.from = from_utime(from);
    Kept kept;
    edit_log(log, rules, into(kept));
    if (kept.empty() || std::get<1>(kept[0]) != "SCENARIO") {
      return -1;
    }
    EXPECT_EQ(std::get<0>(kept[0]), from);
    return std::get<2>(kept[0]);
  };
  const Kept events{{0, "SCENARIO", 1},
                    {1'000'000, "A", 2},
                    {30'000'000, "SCENARIO", 3},
                    {31'000'000, "SCENARIO", 4},
                    {60'000'000, "A", 5}};
  EXPECT_EQ(scenario_of(events, 46'000'000), 4);
  EXPECT_EQ(scenario_of(events, 46'000'001), 1) << "too long ago: the first scenario applies";
  EXPECT_EQ(scenario_of(events, 31'000'001), 4);
  EXPECT_EQ(scenario_of({{0, "A", 1}, {10, "SCENARIO", 2}, {20, "A", 3}}, 10), 2)
      << "the scenario within the part, not the one before it";
  EXPECT_EQ(scenario_of({{0, "A", 1}, {10, "B", 2}}, 5), -1);
  EXPECT_EQ(scenario_of({{0, "SCENARIO", 1}, {10, "A", 2}}, 0), 1) << "the complete log";
}

TEST_F(Edit, SearchesTheFirstThousandEventsForAScenario) {
  for (const int before : {999, 1000}) {
    Kept events;
    for (int i = 0; i < before; ++i) {
      events.emplace_back(i, "A", 1);
    }
    events.emplace_back(before, "SCENARIO", 2);
    events.emplace_back(90'000'000, "A", 3);
    const IndexedLog log = log_of("a" + std::to_string(before), events);
    EditRules rules;
    rules.from = from_utime(80'000'000);
    Kept kept;
    edit_log(log, rules, into(kept));
    EXPECT_EQ(kept.size(), before == 999 ? 2U : 1U) << before;
  }
}

TEST_F(Edit, PrependsOnlyASelectedScenarioAndRenamesIt) {
  const Kept events{{0, "SCENARIO", 1}, {10, "A", 2}, {20, "A", 3}};
  const IndexedLog log = log_of("a", events);
  EditRules rules;
  rules.from = from_utime(15);
  rules.channels = ChannelFilter({"A"}, {});
  Kept kept;
  edit_log(log, rules, into(kept));
  EXPECT_EQ(kept, (Kept{{20, "A", 3}}));
  rules = {};
  rules.from = from_utime(15);
  rules.names = ChannelRenames({"SCENARIO=OLD"});
  kept.clear();
  edit_log(log, rules, into(kept));
  EXPECT_EQ(kept, (Kept{{15, "OLD", 1}, {20, "A", 3}}));
  rules.from = from_utime(0);
  kept.clear();
  edit_log(log, rules, into(kept));
  EXPECT_EQ(kept.size(), 3U) << "nothing is prepended at the start of the log";
  const EditCounts failed = edit_log(log, rules, [](const LogEvent&) { return false; });
  EXPECT_EQ(failed.failed, 1);
}

TEST_F(Edit, OmitsDoubtfulEventsOnRequest) {
  log_of("whole", {{10, "A", 1}, {20, "A", 2}, {30, "A", 3}});
  Bytes bytes = test::read_file(folder_.file("whole"));
  bytes[27] = 0;  // length of the first event; no header follows its end
  test::write_file(folder_.file("a"), bytes);
  const IndexedLog log(folder_.file("a"));
  ASSERT_EQ(log.survey().scan.doubtful, 1);
  for (const bool drops : {false, true}) {
    EditRules rules;
    rules.drops_doubtful = drops;
    const EditCounts counts = edit_log(log, rules, [](const LogEvent&) { return true; });
    EXPECT_EQ(counts.written, drops ? 2 : 3);
    EXPECT_EQ(counts.left_out, drops ? 1 : 0);
  }
}

// A sorted log is read only up to the end of the part, so later events are not counted as omitted.
// An unsorted log is read completely.
TEST_F(Edit, CountsOmittedEvents) {
  EditRules rules;
  rules.from = from_utime(20);
  rules.to = from_utime(30);
  const auto counts_of = [&](const std::string& name, const Kept& events) {
    const IndexedLog log = log_of(name, events);
    return edit_log(log, rules, [](const LogEvent&) { return true; });
  };
  const EditCounts sorted =
      counts_of("a", {{10, "A", 1}, {20, "A", 2}, {29, "A", 3}, {30, "A", 4}, {40, "A", 5}});
  EXPECT_EQ(sorted.written, 2);
  EXPECT_EQ(sorted.left_out, 0);
  const EditCounts mixed =
      counts_of("b", {{20, "A", 1}, {10, "A", 2}, {30, "A", 3}, {29, "A", 4}, {19, "A", 5}});
  EXPECT_EQ(mixed.written, 2);
  EXPECT_EQ(mixed.left_out, 3);
  EXPECT_FALSE(mixed.is_stopped);
}

TEST_F(Edit, EndsAMergeAtTheFirstWriteError) {
  const IndexedLog log = log_of("a", {{10, "A", 1}, {30, "A", 2}, {50, "A", 3}});
  int taken = 0;
  const EditCounts counts = merge_logs({&log, &log}, [&](const LogEvent&) { return ++taken <= 3; });
  EXPECT_EQ(taken, 4);
  EXPECT_EQ(counts.written, 3);
  EXPECT_EQ(counts.failed, 1);
  EXPECT_FALSE(counts.is_stopped);
  EXPECT_EQ(merge_logs({}, [](const LogEvent&) { return true; }).written, 0);
}

}  // namespace
}  // namespace vantage::logs
