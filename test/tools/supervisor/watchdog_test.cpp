#include "tools/supervisor/watchdog.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

constexpr Time at(double s) { return from_utime(static_cast<std::int64_t>(s * 1e6)); }
using Names = std::vector<std::string>;

/// Checks every 0.1 s from `begin_s` to `end_s`. Returns all overdue processes.
Names overdue_between(Watchdog& dog, double begin_s, double end_s) {
  Names out;
  for (double now_s = begin_s; now_s < end_s + 0.05; now_s += 0.1) {
    for (const std::string& name : dog.overdue(at(std::min(now_s, end_s)))) {
      out.push_back(name);
    }
  }
  return out;
}

TEST(Watchdog, ReportsASilentProcessOnce) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.watch("b", 3.0);
  dog.on_sign("a", at(0.0));
  dog.on_sign("b", at(0.0));
  EXPECT_EQ(overdue_between(dog, 0.0, 1.0), Names{});
  EXPECT_EQ(dog.overdue(at(1.001)), Names{"a"});
  EXPECT_EQ(overdue_between(dog, 1.1, 3.0), Names{});
  EXPECT_EQ(dog.overdue(at(3.001)), Names{"b"});
}

TEST(Watchdog, WaitsForTheFirstHeartbeatWithoutLimit) {
  Watchdog dog;
  dog.watch("a", 1.0);
  EXPECT_EQ(overdue_between(dog, 0.0, 100.0), Names{});
  dog.on_start("a", at(100.0));  // `a` may be a process that sends no heartbeats
  EXPECT_EQ(overdue_between(dog, 100.0, 200.0), Names{});
}

// A restarted planner that hangs before its first heartbeat must also be detected.
TEST(Watchdog, LimitsTheTimeToTheFirstHeartbeatAfterARestart) {
  Watchdog dog;
  dog.watch("a", 1.0);
  for (const double begin_s : {100.0, 200.0}) {  // the second round must give the same result
    dog.on_sign("a", at(begin_s));
    EXPECT_EQ(overdue_between(dog, begin_s, begin_s + 1.5), Names{"a"});
    dog.on_end("a");
    EXPECT_EQ(overdue_between(dog, begin_s + 1.6, begin_s + 40.0), Names{})
        << "the process does not run";
    for (const double start_s : {begin_s + 40.0, begin_s + 60.0}) {
      dog.on_start("a", at(start_s));
      EXPECT_EQ(overdue_between(dog, start_s, start_s + Watchdog::kFirstSignS), Names{});
      EXPECT_EQ(dog.overdue(at(start_s + Watchdog::kFirstSignS + 0.001)), Names{"a"});
      EXPECT_EQ(overdue_between(dog, start_s + Watchdog::kFirstSignS + 0.1, start_s + 19.9),
                Names{})
          << "reported once";
    }
    dog.on_start("a", at(begin_s + 80.0));
    dog.on_sign("a", at(begin_s + 81.0));
    EXPECT_EQ(overdue_between(dog, begin_s + 80.0, begin_s + 81.9), Names{});
    EXPECT_EQ(overdue_between(dog, begin_s + 82.0, begin_s + 82.1), Names{"a"})
        << "its own time limit applies from now on";
  }
}

TEST(Watchdog, ARestartResetsTheTime) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.on_sign("a", at(0.0));
  EXPECT_EQ(overdue_between(dog, 0.0, 0.5), Names{});
  dog.on_start("a", at(0.5));
  EXPECT_EQ(overdue_between(dog, 0.5, 10.0), Names{});
}

TEST(Watchdog, IgnoresHeartbeatsOfUnknownProcesses) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.on_sign("x", at(0.0));
  EXPECT_EQ(overdue_between(dog, 0.0, 10.0), Names{});
}

// A supervisor that does not run (Ctrl-Z, suspend, no processor) receives no heartbeats. This time
// does not count as silence of the processes.
TEST(Watchdog, DoesNotCountPausesOfTheSupervisorAsSilence) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.watch("b", 1.0);
  double now_s = 0.0;
  for (const double away_s : {0.9, 5.0, 3600.0}) {  // with growing pauses
    dog.on_sign("a", at(now_s));
    dog.on_start("b", at(now_s));
    dog.on_sign("b", at(now_s));
    EXPECT_EQ(overdue_between(dog, now_s, now_s + 0.5), Names{});
    now_s += 0.5 + away_s;
    EXPECT_EQ(dog.overdue(at(now_s)), Names{}) << "after " << away_s << " s";
    // Heartbeats that arrived during the pause are handled after it; `b` sends none before or after
    // the pause.
    dog.on_sign("a", at(now_s));
    const double left_s = 1.0 - 0.5 - Watchdog::kPollS;
    EXPECT_EQ(overdue_between(dog, now_s, now_s + left_s - 0.01), Names{});
    EXPECT_EQ(dog.overdue(at(now_s + left_s + 0.01)), Names{"b"}) << "after " << away_s << " s";
    now_s += 100.0;
    EXPECT_EQ(dog.overdue(at(now_s)), Names{});
  }
}

// The heartbeat is handled at the end of the pause, before the check that detects the pause.
TEST(Watchdog, TreatsHeartbeatsFromTheFutureAsPresent) {
  Watchdog dog;
  dog.watch("a", 1.0);
  EXPECT_EQ(dog.overdue(at(0.0)), Names{});
  dog.on_sign("a", at(5.0));
  EXPECT_EQ(overdue_between(dog, 5.0, 6.0), Names{});
  EXPECT_EQ(dog.overdue(at(6.01)), Names{"a"});
}

TEST(Watchdog, CountsNoTimeBetweenDistantChecks) {
  Watchdog dog;
  dog.watch("a", 1.0);
  dog.on_sign("a", at(0.0));
  dog.on_start("a", at(0.0));
  EXPECT_EQ(overdue_between(dog, 0.0, 1.0), Names{});
  EXPECT_EQ(dog.overdue(at(101.0)), Names{}) << "a hundred seconds without a check";
  const double left_s = Watchdog::kFirstSignS - 1.0 - Watchdog::kPollS;
  EXPECT_EQ(overdue_between(dog, 101.0, 101.0 + left_s - 0.01), Names{});
  EXPECT_EQ(dog.overdue(at(101.0 + left_s + 0.01)), Names{"a"});
}

}  // namespace
}  // namespace vantage::tools
