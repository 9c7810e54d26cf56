#include "bus/node/stream_monitor.hpp"

#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace vantage::bus {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

models::Stamp stamp(std::int64_t sequence, std::int64_t run_id = 1, std::int64_t utime = 0) {
  return {from_utime(utime), run_id, sequence};
}

TEST(StreamMonitor, CountsNothingLostInAnUnbrokenStream) {
  StreamMonitor monitor;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(monitor.judge(stamp(i)), Arrival::kFresh);
  }
  EXPECT_EQ(monitor.counts().fresh, 100);
  EXPECT_EQ(monitor.counts().lost, 0);
  EXPECT_EQ(monitor.counts().runs, 1);
}

TEST(StreamMonitor, DoesNotCountWhatCameBeforeItListened) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().lost, 0);
}

TEST(StreamMonitor, CountsAGap) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(4)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().lost, 3);
}

TEST(StreamMonitor, TakesALateMessageOffTheLostOnesOnceOnly) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(3)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kReordered);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().lost, 1);
  EXPECT_EQ(monitor.counts().reordered, 1);
  EXPECT_EQ(monitor.counts().duplicates, 1);
}

TEST(StreamMonitor, RefusesDuplicatesOfTheNewestAndOfOlderOnes) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().duplicates, 2);
}

TEST(StreamMonitor, CallsReorderedWhatOvertakesTheVeryFirst) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(5)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(4)), Arrival::kReordered);
  EXPECT_EQ(monitor.counts().lost, 0);
}

TEST(StreamMonitor, FollowsARestartAndRefusesTheOldRunForGood) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(50, 1, 100)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(0, 2, 100)), Arrival::kFresh) << "not older is enough";
  EXPECT_EQ(monitor.judge(stamp(51, 1, 900)), Arrival::kOldRun) << "newer content does not help";
  EXPECT_EQ(monitor.judge(stamp(1, 2, 200)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().old_runs, 1);
  EXPECT_EQ(monitor.counts().runs, 2);
  EXPECT_EQ(monitor.counts().lost, 0);
}

TEST(StreamMonitor, CountsWhatAReplacingRunLostBeforeItWasHeard) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(50, 1, 100)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(2, 2, 200)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().lost, 2);
  EXPECT_EQ(monitor.judge(stamp(0, 2, 150)), Arrival::kReordered);
  EXPECT_EQ(monitor.counts().lost, 1);
}

TEST(StreamMonitor, IsNotTakenOverByAnUnknownRunWithOlderContent) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0, 1, 1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(7, 2, 999)), Arrival::kOldRun);
  EXPECT_EQ(monitor.judge(stamp(1, 1, 1001)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(9, 2, 1001)), Arrival::kFresh) << "once its content is newer";
  EXPECT_EQ(monitor.counts().old_runs, 1);
}

TEST(StreamMonitor, ComparesANewRunWithTheNewestContentHeard) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0, 1, 1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1, 1, 500)), Arrival::kFresh) << "times need not ascend";
  EXPECT_EQ(monitor.judge(stamp(0, 2, 700)), Arrival::kOldRun);
}

TEST(StreamMonitor, StaysBoundedUnderHostileSequenceNumbers) {
  StreamMonitor monitor;
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(monitor.judge(stamp(0, 1)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(kMax, 1)), Arrival::kTooFarAhead);
  EXPECT_EQ(monitor.judge(stamp(1, 1)), Arrival::kFresh) << "nobody is silenced";
  EXPECT_EQ(monitor.judge(stamp(kMax, 2)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(kMax, 2)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().lost, 0);
  EXPECT_EQ(monitor.counts().too_far_ahead, 1);
}

TEST(StreamMonitor, TakesAStepUpToItsBound) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(StreamMonitor::kStepMax + 1)), Arrival::kTooFarAhead);
  EXPECT_EQ(monitor.judge(stamp(StreamMonitor::kStepMax)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().lost, StreamMonitor::kStepMax - 1);
}

TEST(StreamMonitor, BelievesAFarStepThatGoesOnOnceTheRunIsSilent) {
  StreamMonitor monitor;
  const auto judge = [&](std::int64_t sequence, double at_s) {
    const Time now = from_utime(0) + from_seconds(at_s);
    return monitor.judge({now, 1, sequence}, {now, {}});
  };
  EXPECT_EQ(judge(0, 0.0), Arrival::kFresh);
  for (int i = 0; i < 100; ++i) {  // forged beside the true ones
    EXPECT_EQ(judge(50'000 + i, 0.01 * i), Arrival::kTooFarAhead);
    EXPECT_EQ(judge(1 + i, 0.01 * i), Arrival::kFresh);
  }
  for (int i = 0; i < 9; ++i) {  // a network that was away for 500 s
    EXPECT_EQ(judge(60'000 + i, 500.0 + i), Arrival::kTooFarAhead);
  }
  EXPECT_EQ(judge(60'009, 509.0), Arrival::kFresh);
  EXPECT_EQ(judge(60'010, 510.0), Arrival::kFresh);
}

TEST(StreamMonitor, GoesBackBeforeAGapThatWasForged) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(10, 1, 1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(9'000, 1, 1005)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(9, 1, 990)), Arrival::kReordered) << "an old one stays old";
  EXPECT_EQ(monitor.judge(stamp(11, 1, 1010)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(12, 1, 1020)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(12, 1, 1020)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().lost, 0);
}

TEST(StreamMonitor, KeepsARunWithinItsLeaseAndTakesTheNextOneAfterIt) {
  StreamMonitor monitor;
  const auto judge = [&](std::int64_t run, std::int64_t sequence, double stamp_s, double at_s) {
    return monitor.judge({from_utime(0) + from_seconds(stamp_s), run, sequence},
                         {from_utime(0) + from_seconds(at_s), milliseconds(500)});
  };
  EXPECT_EQ(judge(1, 7, 1.0, 1.0), Arrival::kFresh);
  EXPECT_EQ(judge(2, 0, 1.1, 1.1), Arrival::kOldRun) << "a second one beside it";
  EXPECT_EQ(judge(2, 1, 3e8, 1.2), Arrival::kOldRun) << "dated ten years ahead";
  EXPECT_EQ(judge(1, 8, 1.3, 1.3), Arrival::kFresh);
  EXPECT_EQ(judge(2, 9, 2.0, 2.0), Arrival::kFresh);
  EXPECT_EQ(judge(1, 9, 2.1, 2.1), Arrival::kOldRun);
  EXPECT_EQ(judge(1, 40, 2.7, 2.7), Arrival::kFresh) << "nobody is refused for good";
  EXPECT_EQ(monitor.counts().lost, 9) << "of the run that began";
}

// A stamp of the far future keeps no later run out.
TEST(StreamMonitor, ComparesRunsByNoTimeInTheFuture) {
  StreamMonitor monitor;
  const Time now = from_utime(0) + seconds(100);
  EXPECT_EQ(monitor.judge({now + std::chrono::hours(24), 1, 0}, {now, {}}), Arrival::kFresh);
  EXPECT_EQ(monitor.judge({now + seconds(3), 2, 0}, {now + seconds(3), {}}), Arrival::kFresh);
}

// A set of everything seen is the oracle; gaps stay below what the monitor remembers.
TEST(StreamMonitor, AgreesWithFullBookkeepingOnShuffledStreams) {
  std::mt19937_64 rng(7);
  for (int trial = 0; trial < 50; ++trial) {
    StreamMonitor monitor;
    std::set<std::int64_t> seen;
    std::int64_t newest = 0;
    EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
    seen.insert(0);
    for (int i = 0; i < 400; ++i) {
      const std::int64_t offset = std::uniform_int_distribution<std::int64_t>(-6, 4)(rng);
      const std::int64_t sequence = std::max<std::int64_t>(0, newest + offset);
      const Arrival expected = sequence > newest         ? Arrival::kFresh
                               : seen.contains(sequence) ? Arrival::kDuplicate
                                                         : Arrival::kReordered;
      ASSERT_EQ(monitor.judge(stamp(sequence)), expected);
      seen.insert(sequence);
      newest = std::max(newest, sequence);
      ASSERT_EQ(monitor.counts().lost, newest + 1 - static_cast<std::int64_t>(seen.size()));
    }
  }
}

}  // namespace
}  // namespace vantage::bus
