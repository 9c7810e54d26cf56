#include "bus/node/clock.hpp"

#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/deadline.hpp"

namespace vantage::bus {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// A machine whose wall clock somebody sets.
struct Machine {
  Duration since_boot = hours(5);
  Duration set{};  ///< by how much its wall clock was set since its start
  SteadyClock clock{[this] { return std::chrono::nanoseconds(since_boot).count(); },
                    [this] { return kStart + since_boot - hours(5) + set; }};
  void pass(Duration duration) { since_boot += duration; }
};

TEST(SteadyClock, BeginsWithTheWallClockAndGoesOnWithTheMonotonicOne) {
  Machine machine;
  EXPECT_EQ(machine.clock.now(), kStart);
  machine.pass(seconds(100));
  EXPECT_EQ(machine.clock.now(), kStart + seconds(100));
  EXPECT_EQ(machine.clock.apart(), Duration{0});
}

TEST(SteadyClock, DoesNotFollowAWallClockThatIsSet) {
  for (const Duration set : {Duration(-seconds(3)), Duration(-hours(1)), Duration(hours(1))}) {
    Machine machine;
    machine.set = set;
    for (int i = 0; i < 1000; ++i) {
      machine.pass(milliseconds(100));
      EXPECT_EQ(machine.clock.now(), kStart + (i + 1) * milliseconds(100));
    }
    EXPECT_EQ(machine.clock.apart(), set);
  }
}

TEST(SteadyClock, IsDrawnToAWallClockThatIsNearAndNeverGoesBack) {
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
      EXPECT_LE(std::abs(to_seconds(machine.clock.apart())), 2e-6);
    }
  }
}

TEST(SteadyClock, GoesOnFromWhatWasHandedOn) {
  ASSERT_EQ(::setenv(SteadyClock::kHandedOn, "3600000000", 1), 0);
  const SteadyClock parent;
  parent.hand_on();
  EXPECT_EQ(std::string(std::getenv(SteadyClock::kHandedOn)), "3600000000");
  const Time before{Duration{monotonic_ns() / 1'000} + hours(1)};
  const Time now = parent.now();
  const Time after{Duration{monotonic_ns() / 1'000} + hours(1)};
  EXPECT_LE(before, now);
  EXPECT_LE(now, after);
  ASSERT_EQ(::setenv(SteadyClock::kHandedOn, "soon", 1), 0);
  EXPECT_LE(std::abs(to_seconds(SteadyClock().apart())), 0.5) << "what is no number is ignored";
  ASSERT_EQ(::unsetenv(SteadyClock::kHandedOn), 0);
}

}  // namespace
}  // namespace vantage::bus
