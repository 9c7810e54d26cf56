#include "bus/node/clock.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/deadline.hpp"

namespace vantage::bus {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// A machine with a monotonic clock and a wall clock that the test can set.
struct Machine {
  Duration since_boot = hours(5);
  Duration set{};  ///< total change of its wall clock by setting
  SteadyClock clock{[this] { return std::chrono::nanoseconds(since_boot).count(); },
                    [this] { return kStart + since_boot - hours(5) + set; }};
  void pass(Duration duration) { since_boot += duration; }
};

TEST(SteadyClock, StartsAtWallTimeAndAdvancesMonotonically) {
  Machine machine;
  EXPECT_EQ(machine.clock.now(), kStart);
  machine.pass(seconds(100));
  EXPECT_EQ(machine.clock.now(), kStart + seconds(100));
  EXPECT_EQ(machine.clock.wall_offset(), Duration{0});
}

TEST(SteadyClock, IgnoresASetWallClock) {
  for (const Duration set : {Duration(-seconds(3)), Duration(-hours(1)), Duration(hours(1))}) {
    Machine machine;
    machine.set = set;
    for (int i = 0; i < 1000; ++i) {
      machine.pass(milliseconds(100));
      EXPECT_EQ(machine.clock.now(), kStart + (i + 1) * milliseconds(100));
    }
    EXPECT_EQ(machine.clock.wall_offset(), set);
  }
}

TEST(SteadyClock, ApproachesANearWallClockWithoutGoingBack) {
  std::mt19937_64 rng(3);
  Machine machine;
  Time last = machine.clock.now();
  for (int i = 0; i < 20'000; ++i) {
    if (i % 4000 == 0) {
      machine.set = milliseconds(std::uniform_int_distribution<int>(-200, 200)(rng));
    }
    const Duration step{std::uniform_int_distribution<int>(0, 60'000)(rng)};
    machine.pass(step);
    const Time now = machine.clock.now();
    const double rate_s = to_seconds(now - last) - to_seconds(step);
    EXPECT_GE(now, last);
    EXPECT_LE(std::abs(rate_s), SteadyClock::kSlewPerS * to_seconds(step) + 2e-6);
    last = now;
    if (i % 4000 == 3999) {
      EXPECT_LE(std::abs(to_seconds(machine.clock.wall_offset())), 2e-6);
    }
  }
}

// The clock is slewed by 5 ms per second and checked every 20 ms. The clock follows wall-clock
// offsets up to half a second and ignores larger ones.
TEST(SteadyClock, ApproachesAtTheStatedRateAndRange) {
  for (const int sign : {-1, 1}) {
    for (const int apart_ms : {10, 100, 500}) {
      Machine machine;
      machine.set = sign * milliseconds(apart_ms);
      machine.pass(milliseconds(20));
      EXPECT_EQ(machine.clock.now(), kStart + milliseconds(20)) << "slews from now on";
      machine.pass(seconds(4));
      const Duration drawn = sign * milliseconds(std::min(apart_ms, 4 * 5));
      EXPECT_EQ(machine.clock.now(), kStart + milliseconds(20) + seconds(4) + drawn) << apart_ms;
      EXPECT_EQ(machine.clock.wall_offset(), machine.set - drawn);
    }
    Machine far;
    far.set = sign * (milliseconds(500) + Duration{1});
    far.pass(milliseconds(20));
    static_cast<void>(far.clock.now());
    far.pass(seconds(4));
    EXPECT_EQ(far.clock.now(), kStart + milliseconds(20) + seconds(4));
  }
}

TEST(SteadyClock, ReadsTheWallClockEvery20Milliseconds) {
  for (const bool is_early : {true, false}) {
    Machine machine;
    machine.set = milliseconds(100);
    machine.pass(milliseconds(20) - (is_early ? Duration{1} : Duration{0}));
    const Time at = machine.clock.now();
    machine.pass(milliseconds(10));
    EXPECT_EQ(machine.clock.now(), at + milliseconds(10) + Duration{is_early ? 0 : 50});
  }
}

// The offset that a child process receives includes the slewing so far.
TEST(SteadyClock, PassesItsOffsetToChildren) {
  Machine machine;
  machine.set = milliseconds(100);
  machine.pass(milliseconds(20));
  static_cast<void>(machine.clock.now());
  machine.pass(seconds(2));
  machine.clock.export_offset();
  const Duration ahead = machine.clock.now() - Time{machine.since_boot};
  EXPECT_EQ(std::string(std::getenv(SteadyClock::kOffsetVariable)), std::to_string(ahead.count()));
  EXPECT_EQ(ahead, kStart.time_since_epoch() - hours(5) + milliseconds(10));
  for (const char* const other : {"-5000000", "5000000 ", "0x5", ""}) {
    ASSERT_EQ(::setenv(SteadyClock::kOffsetVariable, other, 1), 0);
    const bool is_number = *other == '-';
    const double apart_s = to_seconds(SteadyClock().now() - Time{Duration{monotonic_ns() / 1'000}});
    EXPECT_EQ(std::abs(apart_s + 5.0) < 1.0, is_number) << other;
  }
  ASSERT_EQ(::unsetenv(SteadyClock::kOffsetVariable), 0);
}

TEST(SteadyClock, RefusesAnImpossibleOffset) {
  for (const char* const offset :
       {"9223372036854775807", "-9223372036854775808", "7258118400000001", "-100000000000001"}) {
    ASSERT_EQ(::setenv(SteadyClock::kOffsetVariable, offset, 1), 0);
    EXPECT_THROW(SteadyClock(), StartupError) << offset;
  }
  ASSERT_EQ(::unsetenv(SteadyClock::kOffsetVariable), 0);
}

TEST(Clocks, ReportWhetherTheyAreRealTime) {
  EXPECT_TRUE(SystemClock().is_real_time());
  EXPECT_TRUE(SteadyClock().is_real_time());
  VirtualClock clock(kStart);
  EXPECT_FALSE(clock.is_real_time());
  EXPECT_EQ(clock.now(), kStart);
  clock.set(kStart + seconds(1));
  EXPECT_EQ(clock.now(), kStart + seconds(1));
  EXPECT_GT(SystemClock().now(), kStart);
}

TEST(SteadyClock, ContinuesFromAPassedOffset) {
  ASSERT_EQ(::setenv(SteadyClock::kOffsetVariable, "3600000000", 1), 0);
  const SteadyClock parent;
  parent.export_offset();
  EXPECT_EQ(std::string(std::getenv(SteadyClock::kOffsetVariable)), "3600000000");
  const Time before{Duration{monotonic_ns() / 1'000} + hours(1)};
  const Time now = parent.now();
  const Time after{Duration{monotonic_ns() / 1'000} + hours(1)};
  EXPECT_LE(before, now);
  EXPECT_LE(now, after);
  ASSERT_EQ(::setenv(SteadyClock::kOffsetVariable, "soon", 1), 0);
  EXPECT_LE(std::abs(to_seconds(SteadyClock().wall_offset())), 0.5)
      << "a text that is not a number is ignored";
  ASSERT_EQ(::unsetenv(SteadyClock::kOffsetVariable), 0);
}

}  // namespace
}  // namespace vantage::bus
