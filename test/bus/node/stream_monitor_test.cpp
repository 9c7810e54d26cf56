#include "bus/node/stream_monitor.hpp"

#include <algorithm>
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

TEST(StreamMonitor, IgnoresMessagesBeforeTheSubscription) {
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

TEST(StreamMonitor, SubtractsALateMessageFromTheLossOnce) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(3)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kReordered);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().lost, 1);
  EXPECT_EQ(monitor.counts().reordered, 1);
  EXPECT_EQ(monitor.counts().duplicates, 1);
}

TEST(StreamMonitor, RefusesDuplicatesOfNewAndOldMessages) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().duplicates, 2);
}

TEST(StreamMonitor, CountsAMessageBeforeTheFirstAsReordered) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(5)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(4)), Arrival::kReordered);
  EXPECT_EQ(monitor.counts().lost, 0);
}

TEST(StreamMonitor, FollowsARestartAndRefusesTheOldRunAfterwards) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(50, 1, 100)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(0, 2, 100)), Arrival::kFresh) << "equal age is sufficient";
  EXPECT_EQ(monitor.judge(stamp(51, 1, 900)), Arrival::kOldRun) << "an old run stays refused";
  EXPECT_EQ(monitor.judge(stamp(1, 2, 200)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().old_runs, 1);
  EXPECT_EQ(monitor.counts().runs, 2);
  EXPECT_EQ(monitor.counts().lost, 0);
}

TEST(StreamMonitor, CountsTheFirstLossOfAReplacingRun) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(50, 1, 100)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(2, 2, 200)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().lost, 2);
  EXPECT_EQ(monitor.judge(stamp(0, 2, 150)), Arrival::kReordered);
  EXPECT_EQ(monitor.counts().lost, 1);
}

TEST(StreamMonitor, RefusesAnUnknownRunWithOlderContent) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0, 1, 1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(7, 2, 999)), Arrival::kOldRun);
  EXPECT_EQ(monitor.judge(stamp(1, 1, 1001)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(9, 2, 1001)), Arrival::kFresh) << "its content is newer now";
  EXPECT_EQ(monitor.counts().old_runs, 1);
}

TEST(StreamMonitor, ComparesANewRunWithTheNewestReceivedContent) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0, 1, 1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1, 1, 500)), Arrival::kFresh) << "times need not increase";
  EXPECT_EQ(monitor.judge(stamp(0, 2, 700)), Arrival::kOldRun);
}

TEST(StreamMonitor, StaysBoundedUnderHostileSequenceNumbers) {
  StreamMonitor monitor;
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(monitor.judge(stamp(0, 1)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(kMax, 1)), Arrival::kTooFarAhead);
  EXPECT_EQ(monitor.judge(stamp(1, 1)), Arrival::kFresh) << "no stream is blocked";
  EXPECT_EQ(monitor.judge(stamp(kMax, 2)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(kMax, 2)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().lost, 0);
  EXPECT_EQ(monitor.counts().too_far_ahead, 1);
}

TEST(StreamMonitor, AcceptsAGapUpToItsLimit) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(StreamMonitor::kStepMax + 1)), Arrival::kTooFarAhead);
  EXPECT_EQ(monitor.judge(stamp(StreamMonitor::kStepMax)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().lost, StreamMonitor::kStepMax - 1);
}

TEST(StreamMonitor, AcceptsALargeGapAfterSilenceIfTheRunContinues) {
  StreamMonitor monitor;
  const auto judge = [&](std::int64_t sequence, double at_s) {
    const Time now = from_utime(0) + from_seconds(at_s);
    return monitor.judge({now, 1, sequence}, {now, {}});
  };
  EXPECT_EQ(judge(0, 0.0), Arrival::kFresh);
  for (int i = 0; i < 100; ++i) {  // forged messages between genuine ones
    EXPECT_EQ(judge(50'000 + i, 0.01 * i), Arrival::kTooFarAhead);
    EXPECT_EQ(judge(1 + i, 0.01 * i), Arrival::kFresh);
  }
  for (int i = 0; i < 9; ++i) {  // after 500 s without network
    EXPECT_EQ(judge(60'000 + i, 500.0 + i), Arrival::kTooFarAhead);
  }
  EXPECT_EQ(judge(60'009, 509.0), Arrival::kFresh);
  EXPECT_EQ(judge(60'010, 510.0), Arrival::kFresh);
}

TEST(StreamMonitor, ReturnsToTheNumbersBeforeAForgedGap) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(10, 1, 1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(9'000, 1, 1005)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(9, 1, 990)), Arrival::kReordered)
      << "a missing number is still accepted late";
  EXPECT_EQ(monitor.judge(stamp(11, 1, 1010)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(12, 1, 1020)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(12, 1, 1020)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.counts().lost, 0);
}

TEST(StreamMonitor, KeepsARunForItsLease) {
  StreamMonitor monitor;
  const auto judge = [&](std::int64_t run, std::int64_t sequence, double stamp_s, double at_s) {
    return monitor.judge({from_utime(0) + from_seconds(stamp_s), run, sequence},
                         {from_utime(0) + from_seconds(at_s), milliseconds(500)});
  };
  EXPECT_EQ(judge(1, 7, 1.0, 1.0), Arrival::kFresh);
  EXPECT_EQ(judge(2, 0, 1.1, 1.1), Arrival::kOldRun) << "a second run while the first publishes";
  EXPECT_EQ(judge(2, 1, 3e8, 1.2), Arrival::kOldRun) << "dated ten years ahead";
  EXPECT_EQ(judge(1, 8, 1.3, 1.3), Arrival::kFresh);
  EXPECT_EQ(judge(2, 9, 2.0, 2.0), Arrival::kFresh);
  EXPECT_EQ(judge(1, 9, 2.1, 2.1), Arrival::kOldRun);
  EXPECT_EQ(judge(1, 40, 2.7, 2.7), Arrival::kFresh) << "no run is refused permanently";
  EXPECT_EQ(monitor.counts().lost, 9) << "losses of the accepted run";
}

// A stamp in the far future does not block later runs.
TEST(StreamMonitor, IgnoresFutureTimesWhenComparingRuns) {
  StreamMonitor monitor;
  const Time now = from_utime(0) + seconds(100);
  EXPECT_EQ(monitor.judge({now + std::chrono::hours(24), 1, 0}, {now, {}}), Arrival::kFresh);
  EXPECT_EQ(monitor.judge({now + seconds(3), 2, 0}, {now + seconds(3), {}}), Arrival::kFresh);
}

/// Returns the monitor's result for a message that is stamped and received at `at_s`, s, of the
/// listener's clock.
Arrival judged_at(StreamMonitor& monitor, double at_s, std::int64_t run, std::int64_t sequence,
                  Duration lease = {}) {
  const Time now = from_utime(0) + from_seconds(at_s);
  return monitor.judge({now, run, sequence}, {now, lease});
}

TEST(StreamMonitor, KeepsTheNewest256NumbersOfAGap) {
  for (const std::int64_t gap : {255, 256, 257, 1'000}) {
    StreamMonitor monitor;
    EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
    EXPECT_EQ(monitor.judge(stamp(gap + 1)), Arrival::kFresh);
    EXPECT_EQ(monitor.counts().lost, gap);
    const std::int64_t oldest = std::max<std::int64_t>(1, gap + 1 - 256);
    for (std::int64_t late = 1; late <= gap; ++late) {
      ASSERT_EQ(monitor.judge(stamp(late)),
                late < oldest ? Arrival::kDuplicate : Arrival::kReordered)
          << late << " of " << gap;
    }
    EXPECT_EQ(monitor.counts().lost, oldest - 1) << "they remain lost";
    if (oldest == 1) {
      EXPECT_EQ(monitor.judge(stamp(7, 1, 99)), Arrival::kDuplicate)
          << "the number was received, with another time";
    }
  }
}

TEST(StreamMonitor, KeepsTheNewest256NumbersOfManyGaps) {
  StreamMonitor monitor;
  for (std::int64_t i = 0; i <= 300; ++i) {
    EXPECT_EQ(monitor.judge(stamp(2 * i)), Arrival::kFresh);
  }
  EXPECT_EQ(monitor.counts().lost, 300);
  for (std::int64_t i = 0; i < 300; ++i) {
    ASSERT_EQ(monitor.judge(stamp(2 * i + 1)),
              i < 300 - 256 ? Arrival::kDuplicate : Arrival::kReordered)
        << i;
  }
  EXPECT_EQ(monitor.counts().lost, 300 - 256);
}

// Three messages were lost before the forged gap; they remain counted as lost.
TEST(StreamMonitor, KeepsGapsThatPrecedeAForgedGap) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0, 1, 1000)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(4, 1, 1001)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(5'000, 1, 1002)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(4, 1, 1003)), Arrival::kDuplicate) << "the number before the gap";
  EXPECT_EQ(monitor.judge(stamp(7, 1, 1002)), Arrival::kDuplicate) << "its time is not newer";
  EXPECT_EQ(monitor.judge(stamp(7, 1, 1003)), Arrival::kFresh);
  EXPECT_EQ(monitor.counts().lost, 5) << "1, 2, 3 and 5, 6";
  EXPECT_EQ(monitor.judge(stamp(3, 1, 1000)), Arrival::kDuplicate)
      << "older numbers are no longer stored";
  EXPECT_EQ(monitor.judge(stamp(6, 1, 1002)), Arrival::kReordered);
  EXPECT_EQ(monitor.judge(stamp(5'000, 1, 1010)), Arrival::kFresh) << "a second forged gap";
  EXPECT_EQ(monitor.judge(stamp(4'900, 1, 1011)), Arrival::kReordered) << "this number was missing";
  EXPECT_EQ(monitor.judge(stamp(8, 1, 1011)), Arrival::kFresh);
}

TEST(StreamMonitor, AcceptsALargeGapAfterTenConsecutiveMessages) {
  StreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0)), Arrival::kFresh);
  const auto refuse = [&](std::int64_t from, int times) {
    for (int i = 0; i < times; ++i) {
      ASSERT_EQ(monitor.judge(stamp(from + i)), Arrival::kTooFarAhead) << from + i;
    }
  };
  refuse(50'000, 9);
  EXPECT_EQ(monitor.judge(stamp(1)), Arrival::kFresh);
  refuse(50'009, 9);  // an accepted message in between restarts the count
  refuse(50'017, 9);  // a repeated number also restarts the count
  refuse(60'026, 9);  // a step that is one too long also restarts the count
  refuse(40'000, 9);
  EXPECT_EQ(monitor.judge(stamp(40'008 + StreamMonitor::kStepMax)), Arrival::kFresh)
      << "the tenth, just near enough";
  EXPECT_EQ(monitor.counts().too_far_ahead, 45);
}

TEST(StreamMonitor, AcceptsALargeGapAfterTwoSecondsOfSilence) {
  for (const bool is_silent : {false, true}) {
    StreamMonitor monitor;
    EXPECT_EQ(judged_at(monitor, 10.0, 1, 0), Arrival::kFresh);
    for (int i = 0; i < 20; ++i) {
      EXPECT_EQ(judged_at(monitor, 11.0, 1, 50'000 + i), Arrival::kTooFarAhead);
    }
    EXPECT_EQ(judged_at(monitor, is_silent ? 12.0 : 11.999'999, 1, 50'020),
              is_silent ? Arrival::kFresh : Arrival::kTooFarAhead);
  }
}

TEST(StreamMonitor, AcceptsAnotherRunAtTheEndOfTheLease) {
  for (const bool is_over : {false, true}) {
    StreamMonitor monitor;
    EXPECT_EQ(judged_at(monitor, 1.0, 1, 0, milliseconds(500)), Arrival::kFresh);
    EXPECT_EQ(judged_at(monitor, is_over ? 1.5 : 1.499'999, 2, 0, milliseconds(500)),
              is_over ? Arrival::kFresh : Arrival::kOldRun);
  }
}

// When runs are compared, a stamp may be at most two seconds ahead of the listener's clock.
TEST(StreamMonitor, AcceptsAStampTwoSecondsAhead) {
  for (const bool is_older : {false, true}) {
    StreamMonitor monitor;
    const Time now = from_utime(0) + seconds(100);
    EXPECT_EQ(monitor.judge({now + std::chrono::hours(1), 1, 0}, {now, {}}), Arrival::kFresh);
    const Time stamp_time = now + seconds(2) - Duration{is_older ? 1 : 0};
    EXPECT_EQ(monitor.judge({stamp_time, 2, 0}, {now, {}}),
              is_older ? Arrival::kOldRun : Arrival::kFresh);
  }
}

TEST(StreamMonitor, RefusesTheLastSixteenReplacedRuns) {
  StreamMonitor monitor;
  for (std::int64_t run = 1; run <= 17; ++run) {
    EXPECT_EQ(monitor.judge(stamp(0, run, 10)), Arrival::kFresh);
  }
  for (std::int64_t run = 1; run <= 16; ++run) {
    EXPECT_EQ(monitor.judge(stamp(1, run, 10)), Arrival::kOldRun) << run;
  }
  EXPECT_EQ(monitor.judge(stamp(0, 18, 10)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(1, 2, 10)), Arrival::kOldRun);
  EXPECT_EQ(monitor.judge(stamp(1, 1, 10)), Arrival::kFresh) << "too many runs ago";
  EXPECT_EQ(monitor.counts().runs, 19);
  EXPECT_EQ(monitor.counts().old_runs, 17);
}

TEST(StreamMonitor, ExpectsALaterRunToStartAtZeroIfPossible) {
  for (const std::int64_t first : {std::int64_t{0}, std::int64_t{7}, StreamMonitor::kStepMax - 1,
                                   StreamMonitor::kStepMax, 5 * StreamMonitor::kStepMax}) {
    StreamMonitor monitor;
    EXPECT_EQ(monitor.judge(stamp(3, 1)), Arrival::kFresh);
    EXPECT_EQ(monitor.judge(stamp(first, 2)), Arrival::kFresh) << first;
    EXPECT_EQ(monitor.counts().lost, first < StreamMonitor::kStepMax ? first : 0);
  }
}

// A new run starts without history: gaps, missing numbers and times of the previous run are
// dropped.
TEST(StreamMonitor, ResetsItsStateForEachRun) {
  StreamMonitor missing;
  EXPECT_EQ(missing.judge(stamp(0, 1)), Arrival::kFresh);
  EXPECT_EQ(missing.judge(stamp(5, 1)), Arrival::kFresh);
  for (std::int64_t i = 0; i < 5; ++i) {
    EXPECT_EQ(missing.judge(stamp(i, 2)), Arrival::kFresh);
  }
  EXPECT_EQ(missing.judge(stamp(2, 2)), Arrival::kDuplicate);
  EXPECT_EQ(missing.counts().lost, 4) << "losses of the first run";

  StreamMonitor gap;
  EXPECT_EQ(gap.judge(stamp(0, 1, 10)), Arrival::kFresh);
  EXPECT_EQ(gap.judge(stamp(500, 1, 10)), Arrival::kFresh);
  EXPECT_EQ(gap.judge(stamp(0, 2, 10)), Arrival::kFresh);
  EXPECT_EQ(gap.judge(stamp(1, 2, 10)), Arrival::kFresh);
  EXPECT_EQ(gap.judge(stamp(1, 2, 11)), Arrival::kDuplicate);

  StreamMonitor times;
  EXPECT_EQ(judged_at(times, 10.0, 1, 0), Arrival::kFresh);
  EXPECT_EQ(times.judge({from_utime(0), 2, 0}, {from_utime(0) + seconds(20), seconds(1)}),
            Arrival::kFresh);
  EXPECT_EQ(times.judge(stamp(0, 3, 1)), Arrival::kFresh) << "newer than the second";
}

TEST(StreamCounts, AddWithSaturation) {
  StreamCounts sum{1, 2, 3, 4, 5, 6, 7};
  sum.add({10, 20, 30, 40, 50, 60, 70});
  const auto all = [](const StreamCounts& c) {
    return std::vector<std::int64_t>{c.fresh,    c.lost,          c.duplicates, c.reordered,
                                     c.old_runs, c.too_far_ahead, c.runs};
  };
  EXPECT_EQ(all(sum), (std::vector<std::int64_t>{11, 22, 33, 44, 55, 66, 77}));
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  StreamCounts full{kMax - 1, kMax, 0, 0, 0, 0, 0};
  full.add({1, 1, kMax, 0, 0, 0, 0});
  EXPECT_EQ(full.fresh, kMax);
  EXPECT_EQ(full.lost, kMax);
  EXPECT_EQ(full.duplicates, kMax);
}

// A run that was dropped is accepted as if it were new; its counts are kept.
TEST(SharedStreamMonitor, DropsTheLongestSilentOf33Runs) {
  SharedStreamMonitor monitor;
  EXPECT_EQ(monitor.judge(stamp(0, 1)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(3, 1)), Arrival::kFresh);
  for (std::int64_t run = 2; run <= 32; ++run) {
    EXPECT_EQ(monitor.judge(stamp(0, run)), Arrival::kFresh);
  }
  EXPECT_EQ(monitor.judge(stamp(3, 1)), Arrival::kDuplicate)
      << "all runs are remembered; this one sent the last message";
  EXPECT_EQ(monitor.judge(stamp(0, 33)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(3, 1)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.judge(stamp(0, 3)), Arrival::kDuplicate);
  EXPECT_EQ(monitor.judge(stamp(0, 2)), Arrival::kFresh) << "replaces the fourth run";
  EXPECT_EQ(monitor.judge(stamp(0, 4)), Arrival::kFresh);
  EXPECT_EQ(monitor.judge(stamp(2, 1)), Arrival::kReordered);
  const StreamCounts counts = monitor.counts();
  EXPECT_EQ(counts.fresh, 2 + 31 + 1 + 2);
  EXPECT_EQ(counts.duplicates, 3);
  EXPECT_EQ(counts.reordered, 1);
  EXPECT_EQ(counts.lost, 1);
  EXPECT_EQ(counts.runs, 35);
}

// Compares the monitor with a set of all received numbers. Gaps are small enough for the monitor to
// store them.
TEST(StreamMonitor, AgreesWithAReferenceOnShuffledStreams) {
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
