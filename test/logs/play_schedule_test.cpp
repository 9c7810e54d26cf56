#include "logs/play/play_schedule.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

constexpr std::int64_t kMs = 1'000'000;  // ns
constexpr Time kBegin = from_utime(1'700'000'000'000'000);

Time after_ms(std::int64_t ms) { return kBegin + Duration{1'000 * ms}; }

TEST(PlaySchedule, WaitsUntilResumedAndKeepsItsSpeed) {
  for (const double speed : {0.5, 1.0, 4.0}) {
    PlaySchedule schedule(kBegin, speed);
    EXPECT_TRUE(schedule.is_paused());
    EXPECT_EQ(schedule.speed(), speed);
    EXPECT_EQ(schedule.position(7'000 * kMs), kBegin);
    schedule.resume(1'000 * kMs);
    schedule.resume(1'300 * kMs);  // no effect: it is not paused
    EXPECT_FALSE(schedule.is_paused());
    EXPECT_EQ(schedule.position(1'000 * kMs), kBegin);
    EXPECT_EQ(schedule.position(1'400 * kMs), after_ms(static_cast<std::int64_t>(400 * speed)));
    EXPECT_EQ(schedule.due_ns(kBegin), 1'000 * kMs);
    EXPECT_EQ(schedule.due_ns(after_ms(200)), 1'000 * kMs + std::llround(200 * kMs / speed));
    EXPECT_EQ(schedule.due_ns(after_ms(-200)), 1'000 * kMs - std::llround(200 * kMs / speed));
  }
}

// position() and due_ns() are inverse to each other after any sequence of operations.
TEST(PlaySchedule, PositionInvertsDueTime) {
  PlaySchedule schedule(kBegin, 2.0);
  std::int64_t now_ns = 5'000 * kMs;
  const auto expect_at = [&](std::int64_t at_ms) {
    EXPECT_EQ(schedule.position(now_ns), after_ms(at_ms));
    if (!schedule.is_paused()) {
      EXPECT_EQ(schedule.due_ns(after_ms(at_ms)), now_ns);
      EXPECT_EQ(schedule.position(schedule.due_ns(after_ms(at_ms + 40))), after_ms(at_ms + 40));
    }
  };
  schedule.resume(now_ns);
  now_ns += 100 * kMs;
  expect_at(200);
  schedule.set_speed(0.5, now_ns);
  expect_at(200);
  now_ns += 100 * kMs;
  expect_at(250);
  schedule.pause(now_ns);
  EXPECT_TRUE(schedule.is_paused());
  now_ns += 900 * kMs;
  expect_at(250);
  schedule.set_speed(4.0, now_ns);
  expect_at(250);
  now_ns += 50 * kMs;
  expect_at(250);
  schedule.resume(now_ns);
  expect_at(250);
  now_ns += 10 * kMs;
  expect_at(290);
  schedule.seek(after_ms(-30), now_ns);
  expect_at(-30);
  now_ns += 5 * kMs;
  expect_at(-10);
  schedule.pause(now_ns);
  schedule.seek(after_ms(70), now_ns);
  now_ns += 5 * kMs;
  expect_at(70);
  EXPECT_TRUE(schedule.is_paused()) << "a seek does not start playback";
}

}  // namespace
}  // namespace vantage::logs
