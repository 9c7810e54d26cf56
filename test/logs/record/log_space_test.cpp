#include "logs/record/log_space.hpp"

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

scenario::Scenario three_robots() {
  scenario::Scenario out;
  out.duration_s = 240.0;
  out.robots.resize(3);
  return out;
}

TEST(RoomForLog, IncludesTheTimeOfLandings) {
  const scenario::Scenario scenario = three_robots();
  EXPECT_EQ(log_bytes_needed(scenario), 90'000'000U);  // 3 · 100 kB/s · 300 s
  const LogSpaceCheck enough = check_log_space(scenario, "lab.lcmlog", 90'000'000U);
  EXPECT_TRUE(enough.is_enough);
  const LogSpaceCheck little = check_log_space(scenario, "lab.lcmlog", 89'900'000U);
  EXPECT_FALSE(little.is_enough);
  EXPECT_EQ(little.summary,
            "log: 89.9 MB free on the disk of lab.lcmlog; a log of 300 s takes at most 90.0 MB");
  EXPECT_TRUE(check_log_space(scenario, "lab.lcmlog", std::nullopt).is_enough)
      << "unknown free space";
}

struct Watched {
  LogWatch watch{300e3};
  Time now = kStart;
  std::optional<std::string> look(std::uint64_t size_bytes, std::uint64_t free_bytes) {
    now += std::chrono::milliseconds(500);
    return watch.update({size_bytes, free_bytes}, now);
  }
};

TEST(LogWatch, IsSilentWhileTheLogGrows) {
  Watched log;
  for (std::uint64_t k = 0; k < 100; ++k) {
    EXPECT_EQ(log.look(1000 * k, 1'000'000'000), std::nullopt);
  }
  EXPECT_EQ(log.watch.health(log.now).state, models::ProcessState::kRunning);
}

TEST(LogWatch, ReportsAStallAndItsEndOnce) {
  Watched log;
  EXPECT_EQ(log.look(1000, 1'000'000'000), std::nullopt);
  EXPECT_TRUE(log.look(1000, 0).has_value()) << "the disk is full";
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(log.look(1000, 0), std::nullopt);
  }
  const auto words = log.look(1000, 0);
  ASSERT_TRUE(words.has_value());
  EXPECT_NE(words->find("LOG NOT WRITTEN for 3 s, with 0.0 MB free"), std::string::npos) << *words;
  EXPECT_FALSE(log.watch.is_written());
  const models::ProcessHealth health = log.watch.health(log.now);
  EXPECT_EQ(health.process, "LOG");
  EXPECT_EQ(health.state, models::ProcessState::kDegraded);
  EXPECT_EQ(log.look(1000, 0), std::nullopt) << "only once";
  EXPECT_TRUE(log.look(2000, 1'000'000'000).has_value());
  EXPECT_TRUE(log.watch.is_written());
}

TEST(LogWatch, ReportsAtOnceThatTheDiskRefusesData) {
  LogWatch watch{300e3};
  EXPECT_EQ(watch.update({1000, 1'000'000'000}, kStart), std::nullopt);
  EXPECT_TRUE(watch.update({1000, 0, true}, kStart).has_value());
  EXPECT_FALSE(watch.is_written());
  EXPECT_TRUE(watch.update({1000, 1'000'000'000, false}, kStart).has_value());
  EXPECT_TRUE(watch.is_written());
}

// A log that stops growing is reported even if the disk has space: the recorder has ended, or the
// file has been removed.
TEST(LogWatch, DetectsAFileThatDoesNotGrow) {
  Watched log;
  log.look(5000, 1'000'000'000);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(log.look(0, 1'000'000'000), std::nullopt);
  }
  EXPECT_TRUE(log.look(0, 1'000'000'000).has_value());
}

TEST(LogWatch, ReportsANearlyFullDisk) {
  Watched log;
  EXPECT_EQ(log.look(1000, 18'000'001), std::nullopt);
  const auto words = log.look(2000, 9'000'000);
  ASSERT_TRUE(words.has_value());
  EXPECT_EQ(*words, "log: only 9.0 MB of disk space are left, enough for 30 s of flight");
  EXPECT_EQ(log.watch.health(log.now).state, models::ProcessState::kDegraded);
  EXPECT_TRUE(log.watch.is_written());
}

TEST(RoomForLog, ReportsFreeAndRequiredSpace) {
  scenario::Scenario scenario = three_robots();
  EXPECT_EQ(check_log_space(scenario, "a", std::nullopt).summary,
            "log: the free disk space is unknown for a");
  scenario.duration_s = 0.5;
  scenario.robots.resize(1);
  EXPECT_EQ(log_bytes_needed(scenario), 6'050'000U);  // 100 kB/s · 60.5 s
  EXPECT_EQ(check_log_space(scenario, "a", 6'050'000U).summary,
            "log: 6.0 MB free on the disk of a; a log of 60.5 s takes at most 6.0 MB");
  EXPECT_TRUE(check_log_space(scenario, "a", 6'050'000U).is_enough);
  EXPECT_FALSE(check_log_space(scenario, "a", 6'049'999U).is_enough);
}

TEST(LogWatch, ReportsAStallAfterThreeSeconds) {
  LogWatch watch{300e3};
  const auto at = [&](std::int64_t us, std::uint64_t size_bytes) {
    return watch.update({size_bytes, 1'000'000'000}, kStart + Duration{us});
  };
  EXPECT_FALSE(at(0, 1'000));
  EXPECT_FALSE(at(1'000'000, 1'001));
  EXPECT_FALSE(at(3'999'999, 1'001));
  EXPECT_TRUE(watch.is_written());
  EXPECT_EQ(at(4'000'000, 1'001),
            "LOG NOT WRITTEN for 3 s, with 1000.0 MB free: the flight continues unrecorded");
  EXPECT_FALSE(watch.is_written());
  EXPECT_FALSE(at(9'000'000, 1'001));
  EXPECT_EQ(at(9'100'000, 1'002), "log: written as usual, with 1000.0 MB free");
  EXPECT_FALSE(at(12'000'000, 1'002));
  EXPECT_TRUE(at(12'100'000, 1'002)) << "a second warning";
  const models::ProcessHealth health = watch.health(kStart + Duration{13'000'000});
  EXPECT_EQ(health.stamp.time, kStart + Duration{13'000'000});
  EXPECT_EQ(health.loops, 8);
  ASSERT_EQ(health.counters.size(), 4U);
  const std::pair<const char*, std::int64_t> counters[] = {{"log.bytes", 1'002},
                                                           {"log.free_bytes", 1'000'000'000},
                                                           {"log.is_written", 0},
                                                           {"log.times_unwritten", 2}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(health.counters[i].name, counters[i].first);
    EXPECT_EQ(health.counters[i].count, counters[i].second) << counters[i].first;
  }
}

TEST(LogWatch, ReportsWhenLessThanOneMinuteIsLeft) {
  for (const std::uint64_t free_bytes : {18'000'000U, 17'999'999U}) {
    LogWatch watch{300e3};
    const auto words = watch.update({1, free_bytes}, kStart);
    EXPECT_EQ(words.has_value(), free_bytes < 18'000'000U);
    EXPECT_EQ(watch.health(kStart).counters.at(2).count, 1) << "still written";
  }
  LogWatch watch{300e3};
  EXPECT_TRUE(watch.update({1, 1'000}, kStart));
  EXPECT_EQ(watch.update({2, 900}, kStart), std::nullopt) << "only once";
  EXPECT_EQ(watch.update({3, 1'000'000'000}, kStart), "log: written as usual, with 1000.0 MB free");
}

// Unknown free space gives no warning.
TEST(LogWatch, WorksWithoutAFreeSpaceFigure) {
  LogWatch watch{300e3};
  EXPECT_FALSE(watch.update({1, std::nullopt}, kStart));
  EXPECT_EQ(
      watch.update({1, std::nullopt, true}, kStart + Duration{1'600'000}),
      "LOG NOT WRITTEN for 2 s, with an unknown amount free: the flight continues unrecorded");
  EXPECT_EQ(watch.health(kStart).counters.at(1).count, 0);
  watch.update({1, ~std::uint64_t{0}}, kStart);
  EXPECT_EQ(watch.health(kStart).counters.at(1).count, INT64_MAX) << "the largest possible count";
}

}  // namespace
}  // namespace vantage::logs
