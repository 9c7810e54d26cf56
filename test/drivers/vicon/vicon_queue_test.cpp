// Tests of frames that arrive through a queue, and of servers that pause or change their rate.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "test/drivers/vicon/filter_bench.hpp"

namespace vantage::drivers::vicon {
namespace {

// Regression, seen in a flight: a driver that was stalled for 0.6 s read thirty queued frames. All
// were stamped with the time of reading, so the autopilot received velocities of several metres per
// second.
TEST(FrameFilter, StampsQueuedFramesAtCaptureOrDropsThem) {
  for (const bool is_stamped : {false, true}) {
    for (const double stall_s : {0.03, 0.06, 0.6, 2.0, 40.0}) {
      FilterBench bench;
      const auto stall = from_seconds(stall_s);
      const Duration begins = std::chrono::seconds(5);
      int published = 0;
      int fresh = 0;
      for (int k = 0; k < 100 * (10 + static_cast<int>(stall_s)); ++k) {
        bench.begin();
        const Duration captured = bench.elapsed - Duration{4'000};
        Duration arrival = bench.elapsed + Duration{(k * 7919) % 1000};  // up to 1 ms of jitter
        if (bench.elapsed > begins && bench.elapsed <= begins + stall) {
          arrival = begins + stall + kPeriod / 2;
        }
        bench.seen.arrival = {kEpoch + arrival, arrival};
        if (is_stamped) {
          bench.seen.number.reset();
          bench.seen.server_time_us = 77'000'000'000 + captured.count();
        }
        bench.add("A", bench.moving_pose());
        const std::int64_t before = bench.filter.counts().frames;
        bench.filter.accept(bench.seen);
        if (bench.filter.counts().frames == before) {
          continue;
        }
        ++published;
        fresh += arrival - captured < Duration{10'000} ? 1 : 0;
        EXPECT_NEAR(to_seconds(bench.out.stamp.time - kEpoch), to_seconds(captured),
                    0.0025 + 0.002 * stall_s)
            << k << " " << stall_s;
        EXPECT_LE(arrival - captured, FrameFilter::kQueuedMax + Duration{6'000});
        EXPECT_FALSE(bench.out.bodies.at(0).occluded && stall_s < 0.3);
      }
      const std::int64_t queued = bench.filter.counts().frames_queued;
      EXPECT_NEAR(static_cast<double>(queued), std::max(0.0, 100.0 * stall_s - 9.0),
                  1.0 + 0.2 * stall_s);
      EXPECT_EQ(published + queued, 100 * (10 + static_cast<int>(stall_s)));
      EXPECT_GT(fresh, static_cast<double>(published + queued) - 100.0 * stall_s - 10.0);
    }
  }
}

/// A server that pauses and changes its rate.
struct ChangingServer {
  FilterBench bench;
  Duration arrival{};
  bool states_rate = false;
  bool answers_pings = false;

  void run(int frames, Duration period, std::uint32_t step = 1) {
    for (int k = 0; k < frames; ++k) {
      arrival += period;
      bench.next_number += step - 1;
      bench.begin().arrival = {kEpoch + arrival, arrival};
      bench.seen.rate_hz = states_rate ? step / to_seconds(period) : 0.0;
      if (answers_pings && k % 5 == 4) {
        bench.seen.echo = Echo{arrival - Duration{1'500}, arrival - Duration{500}};
      }
      bench.filter.accept(bench.seen);
    }
  }
  double age_s() const { return to_seconds(bench.out.arrival - bench.out.stamp.time); }
  std::int64_t dropped() const { return bench.filter.counts().frames_queued; }
};

// After a gap in the frame numbers, a fast ping reply shows that no frames are queued.
TEST(FrameFilter, RecoversAfterAPauseWhenAPingReplyIsFast) {
  ChangingServer server;
  server.states_rate = server.answers_pings = true;
  server.run(500, kPeriod);
  ASSERT_EQ(server.dropped(), 0);
  for (const double pause_s : {0.05, 0.5, 5.0}) {
    server.arrival += from_seconds(pause_s);
    const std::int64_t before = server.dropped();
    server.run(300, kPeriod);
    EXPECT_LE(server.dropped() - before, 7) << pause_s;
    EXPECT_LE(server.age_s(), 0.008) << pause_s;
    EXPECT_FALSE(server.bench.filter.is_behind());
  }
}

// Without a ping reply, a pause cannot be distinguished from a queue. The latency is reported until
// the next connection.
TEST(FrameFilter, ReportsLatencyAfterAPauseUntilAReconnect) {
  for (const double pause_s : {0.15, 0.5, 5.0}) {
    ChangingServer server;
    server.run(500, kPeriod);
    server.arrival += from_seconds(pause_s);
    server.run(100, kPeriod);
    EXPECT_NEAR(server.age_s(), pause_s, 0.02);
    EXPECT_TRUE(server.bench.filter.is_behind());
    server.bench.filter.on_opened();
    EXPECT_FALSE(server.bench.filter.is_behind());
    server.run(300, kPeriod);
    EXPECT_LE(server.age_s(), 0.005);
  }
}

TEST(FrameFilter, UsesTheServersStatedRate) {
  for (const bool answers_pings : {false, true}) {
    ChangingServer server;
    server.states_rate = true;
    server.answers_pings = answers_pings;
    for (const Duration period : {kPeriod, 2 * kPeriod, kPeriod / 2, kPeriod}) {
      server.run(600, period);
      EXPECT_LE(server.age_s(), 0.006) << period.count();
    }
    server.run(300, 5 * kPeriod, 5);  // only every fifth frame, after a jump of the numbers
    server.bench.next_number += 2000;
    server.run(300, 5 * kPeriod, 5);
    server.run(300, kPeriod);
    EXPECT_LE(server.age_s(), 0.006);
    EXPECT_EQ(server.dropped(), 0);
  }
}

// If the stated rate differs from the rate of the frame numbers, ping replies reveal this within
// three seconds.
TEST(FrameFilter, PrefersPingRepliesToTheStatedRate) {
  for (const double stated_share : {0.5, 0.999, 1.001, 2.0, 10.0}) {
    FilterBench bench;
    double worst_late_s = 0.0;
    for (int k = 0; k < 3000; ++k) {
      bench.begin().rate_hz = 100.0 * stated_share;
      if (k % 5 == 4) {
        bench.seen.echo = Echo{bench.elapsed - Duration{1'500}, bench.elapsed - Duration{500}};
      }
      bench.filter.accept(bench.seen);
      if (k > 600) {
        worst_late_s = std::max(worst_late_s, to_seconds(bench.out.arrival - bench.out.stamp.time));
      }
    }
    EXPECT_LT(worst_late_s, 0.03) << stated_share;
  }
}

// The period of an object stream is estimated from arrival times with jitter. The first frame may
// be late.
TEST(FrameFilter, ReportsNoQueueForJitter) {
  for (const double jitter_s : {0.001, 0.004, 0.015}) {
    FilterBench bench;
    std::uint32_t draw = 7;
    double worst_s = 0.0;
    for (int k = 0; k < 12'000; ++k) {
      bench.begin();
      draw = draw * 1'664'525U + 1'013'904'223U;
      // Every hundredth frame, including the first, has the maximum delay.
      const double share = k % 100 == 0 ? 1.0 : (draw >> 8U) / 16'777'216.0;
      const Duration late = from_seconds(share * jitter_s);
      bench.seen.arrival = {kEpoch + bench.elapsed + late, bench.elapsed + late};
      bench.filter.accept(bench.seen);
      const double waited_s = to_seconds(bench.filter.waited() - late);
      worst_s = std::max(worst_s, std::abs(k < 300 ? std::max(0.0, waited_s) : waited_s));
    }
    EXPECT_LT(worst_s, 0.002 + 0.2 * jitter_s) << jitter_s;
    EXPECT_EQ(bench.filter.counts().frames_queued, 0);
  }
}

// The server states no rate, and its rate decreases. This cannot be distinguished from a slow
// connection.
TEST(FrameFilter, EstimatesTheRateAgainOnANewConnection) {
  ChangingServer server;
  server.run(500, kPeriod);
  server.run(100, 2 * kPeriod);
  EXPECT_TRUE(server.bench.filter.is_behind());
  server.bench.filter.on_opened();
  server.run(600, 2 * kPeriod);
  EXPECT_LE(server.age_s(), 0.006);
  server.run(600, kPeriod);
  EXPECT_LE(server.age_s(), 0.006);
  EXPECT_FALSE(server.bench.filter.is_behind());
}

// The queue grows too slowly to be detected from the frame numbers. A ping reply passes through the
// same queue and reveals the delay.
TEST(FrameFilter, ReportsAQueueThatOnlyPingRepliesReveal) {
  FilterBench bench;
  for (int k = 0; k < 500; ++k) {
    bench.begin();
    if (k % 100 == 99) {
      bench.seen.echo = Echo{bench.elapsed - Duration{400'000}, bench.elapsed - Duration{500}};
    }
    bench.filter.accept(bench.seen);
  }
  EXPECT_NEAR(to_seconds(bench.out.arrival - bench.out.stamp.time), 0.4, 0.055);
  EXPECT_TRUE(bench.filter.is_behind());
}

}  // namespace
}  // namespace vantage::drivers::vicon
