#include "models/exchange/mocap_clock.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "test/support/random.hpp"

namespace vantage::models {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kPeriodS = 0.01;

Time after(double seconds_s) { return kStart + from_seconds(seconds_s); }

// The reported latency is the true one, despite lost frames, jitter and a clock that is set
// repeatedly.
TEST(MocapClock, ReportsTrueLatencyThroughClockChanges) {
  test::Random random(5);
  MocapClock clock;
  double ahead_s = 0.0;
  int sets = 0;
  for (int i = 0; i < 5000; ++i) {
    const bool is_lost = i > 10 && random.uniform(0.0, 1.0) < 0.2;
    if (is_lost) {
      continue;
    }
    const bool is_set = i > 10 && random.uniform(0.0, 1.0) < 0.05;
    if (is_set) {
      const double before_s = ahead_s;
      while (std::abs(ahead_s - before_s) < 1.5) {
        ahead_s = random.uniform(-5000.0, 5000.0);
      }
      ++sets;
    }
    const double latency_s = random.uniform(0.0, 0.2);
    const double taken_s = kPeriodS * i;
    EXPECT_EQ(clock.on_frame(after(taken_s + ahead_s), after(taken_s + latency_s), i), !is_set);
    EXPECT_NEAR(clock.latency_s(), latency_s, 1e-5);
  }
  EXPECT_GT(sets, 50);
}

TEST(MocapClock, ReportsLatencyThatBeginsWithAClockChange) {
  MocapClock clock;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(clock.on_frame(after(kPeriodS * i), after(kPeriodS * i + 0.005), i));
  }
  EXPECT_FALSE(clock.on_frame(after(kPeriodS * 10 + 3600.0), after(kPeriodS * 10 + 0.155), 10));
  EXPECT_NEAR(clock.latency_s(), 0.155, 1e-6);
  EXPECT_TRUE(clock.on_frame(after(kPeriodS * 11 + 3600.0), after(kPeriodS * 11 + 0.155), 11));
  EXPECT_NEAR(clock.latency_s(), 0.155, 1e-6);
}

// A clock that is set back by up to a second looks like additional latency. It is detected because,
// by the publisher's clock, later frames then arrive before earlier ones.
TEST(MocapClock, KeepsTheLatencyWhenTheClockIsSetBackByASecondOrLess) {
  for (const double set_s : {-0.02, -0.1, -0.5, -0.99, -1.0}) {
    for (const int lost : {0, 1, 50}) {
      MocapClock clock;
      for (int i = 0; i < 10; ++i) {
        EXPECT_TRUE(clock.on_frame(after(kPeriodS * i), after(kPeriodS * i + 0.005), i));
      }
      for (int i = 10 + lost; i < 300; ++i) {
        const double captured_s = kPeriodS * i;
        const bool goes_back = set_s + kPeriodS * (lost + 1) < 0.0;
        const bool is_first = i == 10 + lost;
        EXPECT_EQ(clock.on_frame(after(captured_s + set_s), after(captured_s + 0.005), i),
                  !is_first || !goes_back);
        if (goes_back) {
          EXPECT_NEAR(clock.latency_s(), 0.005, 1e-6) << set_s << " " << lost;
        }
      }
    }
  }
}

// If the clocks of the two computers are not synchronised, only changes of their offset count as
// latency.
TEST(MocapClock, MeasuresLatencyFromTheFirstFrameWhenTheClocksDiffer) {
  MocapClock clock;
  EXPECT_FALSE(clock.on_frame(after(-7200.0), after(0.0), 0));
  EXPECT_EQ(clock.latency_s(), 0.0);
  EXPECT_TRUE(clock.on_frame(after(-7200.0 + kPeriodS), after(kPeriodS + 0.12), 1));
  EXPECT_NEAR(clock.latency_s(), 0.12, 1e-6);
}

// Impossible latencies are limited. A frame that arrives before its capture has a latency of 0 s;
// after a clock change the maximum is 1 s.
TEST(MocapClock, LimitsLatencyAtAClockChange) {
  MocapClock clock;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(clock.on_frame(after(kPeriodS * i), after(kPeriodS * i + 0.005), i));
  }
  EXPECT_FALSE(clock.on_frame(after(0.10 + 3600.0), after(0.0955), 10)) << "9.5 ms too early";
  EXPECT_EQ(clock.latency_s(), 0.0);
  EXPECT_TRUE(clock.on_frame(after(0.11 + 3600.0), after(0.1055), 11));
  EXPECT_EQ(clock.latency_s(), 0.0);
  EXPECT_FALSE(clock.on_frame(after(10.0 - 7200.0), after(10.0), 1000)) << "after a long silence";
  EXPECT_EQ(clock.latency_s(), 1.0);
}

// If the clock is set while frames are lost, the time of up to a hundred missing frames is
// subtracted from the gap, and the rest is latency. With more missing frames nothing is subtracted.
TEST(MocapClock, AccountsForUpToAHundredLostFrames) {
  for (const auto& [frames, due] :
       {std::pair{1, 1}, {99, 99}, {100, 100}, {101, 0}, {0, 0}, {-1, 0}}) {
    MocapClock clock;
    for (int i = 0; i < 10; ++i) {
      EXPECT_TRUE(clock.on_frame(after(kPeriodS * i), after(kPeriodS * i + 0.005), i));
    }
    // The next frame arrives 0.2 s later than the missing frames explain.
    const double gap_s = kPeriodS * due + 0.2;
    const double at_s = kPeriodS * 9 + 0.005 + gap_s;
    EXPECT_FALSE(clock.on_frame(after(at_s + 3600.0), after(at_s), 9 + frames)) << frames;
    EXPECT_NEAR(clock.latency_s(), 0.205, 1e-6) << frames;
  }
}

// The frame period is computed from stamps that advance by less than 1 s and frame numbers that
// advance by 1 to 100. Other frames leave it unchanged: after pauses, with stamps that do not
// advance, or with numbers that repeat, restart or jump.
TEST(MocapClock, EstimatesThePeriodFromAdvancingFrames) {
  struct Frame {
    std::int64_t numbers;  // difference of the frame number from the previous frame
    double stamps_s;
    double period_s;  // s; expected estimate of the period
  };
  for (const Frame& odd :
       {Frame{1, 0.02, 0.02}, Frame{4, 0.08, 0.02}, Frame{100, 2.0, 0.02}, Frame{1, 0.9, 0.9},
        Frame{1, 0.0, kPeriodS}, Frame{0, -0.02, kPeriodS}, Frame{-3, -0.3, kPeriodS},
        Frame{1, 1.0, kPeriodS}, Frame{1, 5.0, kPeriodS}, Frame{0, 0.5, kPeriodS},
        Frame{0, 0.0, kPeriodS}, Frame{-9, 0.5, kPeriodS}, Frame{101, 0.5, kPeriodS},
        Frame{5000, 0.5, kPeriodS}}) {
    SCOPED_TRACE(testing::Message() << odd.numbers << " in " << odd.stamps_s << " s");
    MocapClock clock;
    for (int i = 0; i < 10; ++i) {
      EXPECT_TRUE(clock.on_frame(after(kPeriodS * i), after(kPeriodS * i + 0.005), i));
    }
    const double stamp_s = 9 * kPeriodS + odd.stamps_s;
    EXPECT_TRUE(clock.on_frame(after(stamp_s), after(stamp_s + 0.5), 9 + odd.numbers));
    EXPECT_NEAR(clock.latency_s(), 0.5, 1e-6);
    // The clock is set before the next frame, which arrives 0.2 s late.
    const double gap_s = odd.period_s + 0.2;
    EXPECT_FALSE(
        clock.on_frame(after(stamp_s + 3600.0), after(stamp_s + 0.5 + gap_s), 9 + odd.numbers + 1));
    EXPECT_NEAR(clock.latency_s(), 0.7, 1e-6);
  }
}

// A single frame does not define a period, for any start time of its clock. All time after it
// counts as latency.
TEST(MocapClock, HasNoPeriodAfterOneFrame) {
  for (const std::int64_t number : {0, 1, 7, 100, 101}) {
    MocapClock clock;
    const Time on{};
    EXPECT_TRUE(clock.on_frame(on + from_seconds(0.5), on + from_seconds(0.505), number));
    EXPECT_NEAR(clock.latency_s(), 0.005, 1e-9);
    EXPECT_FALSE(clock.on_frame(on + from_seconds(900.0), on + from_seconds(0.605), number + 1));
    EXPECT_NEAR(clock.latency_s(), 0.105, 1e-9) << number;
  }
}

// Latencies from 0 to 1 s are accepted. Any other value means that the clock was set.
TEST(MocapClock, AcceptsLatenciesUpToASecond) {
  for (const auto& [latency_s, is_believed] :
       {std::pair{0.0, true}, {1e-6, true}, {1.0, true}, {-1e-6, false}, {1.0 + 1e-6, false}}) {
    MocapClock clock;
    EXPECT_TRUE(clock.on_frame(after(0.0), after(0.5), 0));
    EXPECT_EQ(clock.on_frame(after(1.0), after(1.0 + latency_s), 1), is_believed) << latency_s;
  }
}

}  // namespace
}  // namespace vantage::models
