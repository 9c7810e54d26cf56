#include "tools/supervisor/restart_schedule.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t seconds(double s) { return static_cast<std::int64_t>(s * 1e9); }

TEST(RestartSchedule, DoublesItsBackOffUpToTheCap) {
  RestartSchedule schedule(RestartPolicy{
      .backoff_first_s = 0.25, .backoff_max_s = 1.5, .restarts_max = 100, .window_s = 1000.0});
  schedule.on_start(0);
  std::int64_t now_ns = 0;
  for (const double backoff_s : {0.25, 0.5, 1.0, 1.5, 1.5}) {
    const auto next_ns = schedule.on_end(now_ns);
    ASSERT_TRUE(next_ns);
    EXPECT_EQ(*next_ns - now_ns, seconds(backoff_s));
    now_ns = *next_ns;
    schedule.on_start(now_ns);
  }
  EXPECT_EQ(schedule.restarts(), 5);
}

TEST(RestartSchedule, ResetsAfterAStableRun) {
  RestartSchedule schedule;  // stable after 10 s
  schedule.on_start(0);
  ASSERT_EQ(schedule.on_end(kSecond_ns), kSecond_ns + seconds(0.2));
  schedule.on_start(2 * kSecond_ns);
  ASSERT_EQ(schedule.on_end(3 * kSecond_ns), 3 * kSecond_ns + seconds(0.4));
  schedule.on_start(4 * kSecond_ns);
  EXPECT_EQ(schedule.on_end(14 * kSecond_ns), 14 * kSecond_ns + seconds(0.2));
}

TEST(RestartSchedule, NeverAbandonsAFlyingVehiclesDriver) {
  RestartSchedule schedule;
  schedule.on_start(0);
  std::int64_t now_ns = 0;
  for (int death = 0; death < 1'000; ++death) {
    const auto next_ns = schedule.on_end(now_ns, true);
    ASSERT_TRUE(next_ns);
    ASSERT_LE(*next_ns - now_ns, seconds(RestartSchedule::kNeededBackoffMaxS));
    now_ns = *next_ns;
    schedule.on_start(now_ns);
  }
  EXPECT_FALSE(schedule.on_end(now_ns, false)) << "on the ground it may be abandoned";
}

TEST(RestartSchedule, AbandonsAProcessThatFailsImmediately) {
  RestartSchedule schedule;
  schedule.on_start(0);
  std::int64_t now_ns = 0;
  int deaths = 0;
  while (const auto next_ns = schedule.on_end(now_ns)) {
    ++deaths;
    now_ns = *next_ns;
    schedule.on_start(now_ns);
  }
  EXPECT_EQ(deaths, 5);
  EXPECT_EQ(schedule.restarts(), 5);
  EXPECT_EQ(now_ns, seconds(0.2 + 0.4 + 0.8 + 1.6 + 3.2)) << "time until the process is abandoned";
}

TEST(RestartSchedule, KeepsRestartingAProcessThatFailsRarely) {
  RestartSchedule schedule;  // allows 5 restarts in 60 s
  schedule.on_start(0);
  std::int64_t now_ns = 0;
  for (int death = 0; death < 1000; ++death) {
    now_ns += 15 * kSecond_ns;
    const auto next_ns = schedule.on_end(now_ns);
    ASSERT_TRUE(next_ns) << "death " << death;
    EXPECT_EQ(*next_ns - now_ns, seconds(0.2));
    now_ns = *next_ns;
    schedule.on_start(now_ns);
  }
  EXPECT_EQ(schedule.restarts(), 1000);
}

TEST(RestartSchedule, ForgetsRestartsOutsideTheWindow) {
  RestartSchedule schedule(RestartPolicy{.restarts_max = 2, .window_s = 60.0});
  schedule.on_start(0);
  ASSERT_TRUE(schedule.on_end(0));
  schedule.on_start(1 * kSecond_ns);
  ASSERT_TRUE(schedule.on_end(1 * kSecond_ns));
  schedule.on_start(2 * kSecond_ns);
  EXPECT_TRUE(schedule.on_end(61 * kSecond_ns)) << "the first restart is 60 s old";
  schedule.on_start(62 * kSecond_ns);
  EXPECT_TRUE(schedule.on_end(62 * kSecond_ns)) << "so is the second";
  schedule.on_start(63 * kSecond_ns);
  EXPECT_FALSE(schedule.on_end(63 * kSecond_ns)) << "two restarts within two seconds";
}

TEST(RestartSchedule, AllowsNoRestartIfTheLimitIsZero) {
  RestartSchedule schedule(RestartPolicy{.restarts_max = 0});
  schedule.on_start(0);
  EXPECT_FALSE(schedule.on_end(1000 * kSecond_ns));
}

TEST(RestartSchedule, SumsDownTime) {
  RestartSchedule schedule;
  schedule.on_start(5 * kSecond_ns);
  EXPECT_EQ(schedule.down_s(6 * kSecond_ns), 0.0);
  ASSERT_TRUE(schedule.on_end(10 * kSecond_ns));
  EXPECT_EQ(schedule.down_s(12 * kSecond_ns), 2.0);
  schedule.on_start(13 * kSecond_ns);
  EXPECT_EQ(schedule.down_s(20 * kSecond_ns), 3.0);
  ASSERT_TRUE(schedule.on_end(20 * kSecond_ns));
  EXPECT_EQ(schedule.down_s(21 * kSecond_ns), 4.0);
}

}  // namespace
}  // namespace vantage::tools
