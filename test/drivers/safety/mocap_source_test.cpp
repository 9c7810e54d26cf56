#include "drivers/safety/mocap_source.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::drivers {
namespace {

using Standing = MocapSource::Standing;
constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kHourS = 3600.0;

Time at(double seconds_s) { return kStart + from_seconds(seconds_s); }

class MocapSourceTest : public testing::Test {
 protected:
  /// Delivers a frame of run `run` at time `at_s`. The publisher's clock is `ahead_s` ahead of the
  /// local clock.
  Standing standing_of(std::int64_t run, double at_s, double ahead_s = 0.0,
                       std::int64_t number = -1) {
    models::MocapFrame frame;
    frame.stamp.run_id = run;
    frame.stamp.time = at(at_s + ahead_s);
    frame.frame_number = number >= 0 ? number : number_++;
    const Standing standing = source.judge(frame, at(at_s));
    if (standing == Standing::kCandidate && shows_body) {
      source.confirm(frame, at(at_s));
    }
    return standing;
  }

  MocapSource source;
  bool shows_body = true;
  std::int64_t number_ = 0;
};

TEST_F(MocapSourceTest, IsTheFirstPublisherOfTheBody) {
  shows_body = false;
  EXPECT_EQ(standing_of(1, 0.0), Standing::kCandidate);
  shows_body = true;
  EXPECT_EQ(standing_of(2, 0.01), Standing::kCandidate);
  EXPECT_EQ(standing_of(2, 0.02), Standing::kAccepted);
  EXPECT_EQ(standing_of(1, 0.03), Standing::kRefused);
  EXPECT_NE(source.refusal_message(at(0.1)), nullptr);
  EXPECT_EQ(source.refusal_message(at(2.1)), nullptr);
}

TEST_F(MocapSourceTest, IsReplacedWhenSilent) {
  EXPECT_EQ(standing_of(1, 0.0), Standing::kCandidate);
  EXPECT_EQ(standing_of(2, 0.29), Standing::kRefused);
  shows_body = false;
  EXPECT_EQ(standing_of(3, 0.35), Standing::kCandidate);
  EXPECT_EQ(standing_of(1, 0.36), Standing::kAccepted)
      << "the source returns before another is confirmed";
  shows_body = true;
  EXPECT_EQ(standing_of(2, 0.70), Standing::kCandidate);
  EXPECT_EQ(standing_of(2, 0.71), Standing::kAccepted);
  EXPECT_EQ(standing_of(1, 0.72), Standing::kRefused);
}

TEST_F(MocapSourceTest, RefusesOldStamps) {
  for (const double ahead_s : {-24.0 * kHourS, -2.1, 2.1, 10.0 * 365.0 * 24.0 * kHourS}) {
    EXPECT_EQ(standing_of(1, 0.0, ahead_s), Standing::kRefused);
  }
  EXPECT_NE(source.refusal_message(at(0.1)), nullptr);
  EXPECT_EQ(standing_of(1, 0.0, -1.9), Standing::kCandidate);
}

TEST_F(MocapSourceTest, StaysAcceptedAfterAClockChange) {
  EXPECT_EQ(standing_of(1, 0.0), Standing::kCandidate);
  double at_s = 0.0;
  for (const double ahead_s : {-kHourS, 2.0 * kHourS, 0.0, -3.0}) {
    for (int i = 0; i < 100; ++i) {
      at_s += 0.01;
      EXPECT_EQ(standing_of(1, at_s, ahead_s), Standing::kAccepted);
    }
  }
  EXPECT_EQ(standing_of(1, at_s, -kHourS, 5), Standing::kRefused) << "its frames of an hour ago";
  EXPECT_EQ(standing_of(1, at_s, -3.0, 5), Standing::kAccepted)
      << "new numbers with the known clock";
  EXPECT_EQ(standing_of(2, at_s + 1.0, -3.0), Standing::kRefused)
      << "a new source must agree with the local clock";
  EXPECT_EQ(standing_of(2, at_s + 1.0), Standing::kCandidate);
}

TEST_F(MocapSourceTest, AcceptsAClockChangeWhenFramesContinue) {
  EXPECT_EQ(standing_of(1, 0.0, 0.0, 10), Standing::kCandidate);
  std::int64_t number = 10;
  double ahead_s = -kHourS;
  for (const std::int64_t lost : {std::int64_t{0}, MocapSource::kLostMax}) {
    const std::int64_t far = number + MocapSource::kLostMax + 1;
    EXPECT_EQ(standing_of(1, 0.1, ahead_s, far), Standing::kRefused) << "too many lost";
    EXPECT_EQ(standing_of(1, 0.1, ahead_s, number), Standing::kRefused) << "repeated number";
    number += std::max<std::int64_t>(1, lost);
    EXPECT_EQ(standing_of(1, 0.1, ahead_s, number), Standing::kAccepted);
    ahead_s = 2.0 * kHourS;
  }
}

TEST_F(MocapSourceTest, CountsRefusalsAndTakeovers) {
  const auto count = [&](const std::string& name) {
    std::vector<models::NamedCount> counts;
    source.count(counts);
    const auto found = std::find_if(counts.begin(), counts.end(),
                                    [&](const auto& each) { return each.name == name; });
    return found == counts.end() ? -1 : found->count;
  };
  EXPECT_EQ(standing_of(1, 0.0), Standing::kCandidate);
  EXPECT_EQ(count("mocap.takeovers"), 0) << "the first source is no takeover";
  for (std::int64_t time = 1; time <= 2; ++time) {
    const double begin_s = 10.0 * static_cast<double>(time);
    EXPECT_EQ(standing_of(10 * time, begin_s), Standing::kCandidate)
        << "the previous source is silent";
    EXPECT_EQ(count("mocap.takeovers"), time);
    EXPECT_EQ(standing_of(1, begin_s + 0.01), Standing::kRefused);
    EXPECT_EQ(count("mocap.other_source"), time);
    EXPECT_EQ(standing_of(1, begin_s + 0.02, -kHourS), Standing::kRefused);
    EXPECT_EQ(count("mocap.other_time"), time);
  }
}

// Tests both sides of the limits for stamps (2 s) and silence (0.3 s), also after a take-over.
TEST_F(MocapSourceTest, HasTheStatedTimeLimits) {
  shows_body = false;
  for (const double side : {1.0, -1.0}) {
    EXPECT_EQ(standing_of(7, 0.0, side * 1.99), Standing::kCandidate);
    EXPECT_EQ(standing_of(7, 0.0, side * 2.01), Standing::kRefused);
  }
  for (const std::int64_t run : {1, 2}) {
    const double begin_s = 10.0 * static_cast<double>(run);
    shows_body = true;
    EXPECT_EQ(standing_of(run, begin_s), Standing::kCandidate);
    EXPECT_EQ(standing_of(run, begin_s + 1.0), Standing::kAccepted);
    shows_body = false;
    EXPECT_EQ(standing_of(9, begin_s + 1.299), Standing::kRefused);
    EXPECT_EQ(standing_of(9, begin_s + 1.301), Standing::kCandidate);
  }
}

// A refusal of a second source, or of a second clock, is reported for two seconds. If both were
// refused, the second source is reported first.
TEST_F(MocapSourceTest, ReportsRefusalsForTwoSeconds) {
  const std::string second = "messages from a second VICON source are rejected";
  const std::string other_time = "VICON messages from another clock or a log are rejected";
  const auto refusal_message = [&](double at_s) {
    const char* const text = source.refusal_message(at(at_s));
    return text == nullptr ? std::string() : text;
  };
  EXPECT_EQ(refusal_message(0.0), "");
  EXPECT_EQ(standing_of(1, 0.0), Standing::kCandidate);
  EXPECT_EQ(refusal_message(0.0), "");
  for (const double begin_s : {0.1, 10.1}) {
    EXPECT_EQ(standing_of(1, begin_s), Standing::kAccepted);
    EXPECT_EQ(standing_of(2, begin_s + 0.1, kHourS), Standing::kRefused);
    EXPECT_EQ(refusal_message(begin_s + 0.1), other_time);
    EXPECT_EQ(standing_of(2, begin_s + 0.2), Standing::kRefused);
    EXPECT_EQ(refusal_message(begin_s + 0.2), second);
    EXPECT_EQ(standing_of(2, begin_s + 0.25, kHourS), Standing::kRefused);
    EXPECT_EQ(refusal_message(begin_s + 2.19), second);
    EXPECT_EQ(refusal_message(begin_s + 2.21), other_time);
    EXPECT_EQ(refusal_message(begin_s + 2.24), other_time);
    EXPECT_EQ(refusal_message(begin_s + 2.26), "");
  }
  // After the take-over, the new source is no longer reported as a second source.
  EXPECT_EQ(standing_of(2, 20.0), Standing::kCandidate);
  EXPECT_EQ(refusal_message(20.0), "");
}

// Frames of the accepted source that have an old stamp and a discontinuous number are counted and
// reported, each time.
TEST_F(MocapSourceTest, RefusesOldDiscontinuousFramesOfTheAcceptedPublisher) {
  EXPECT_EQ(standing_of(1, 0.0, 0.0, 100), Standing::kCandidate);
  for (std::int64_t time = 1; time <= 2; ++time) {
    const double at_s = 10.0 * static_cast<double>(time);
    EXPECT_EQ(standing_of(1, at_s, 0.0, 100 + time), Standing::kAccepted);
    EXPECT_EQ(source.refusal_message(at(at_s)), nullptr);
    EXPECT_EQ(standing_of(1, at_s, -kHourS, 50), Standing::kRefused);
    EXPECT_NE(source.refusal_message(at(at_s)), nullptr);
    std::vector<models::NamedCount> counts;
    source.count(counts);
    EXPECT_TRUE(std::any_of(counts.begin(), counts.end(), [&](const auto& each) {
      return each.name == "mocap.other_time" && each.count == time;
    }));
    EXPECT_EQ(standing_of(1, at_s, 0.0, 50), Standing::kAccepted)
        << "restarted numbers with a current stamp";
  }
}

// A changed clock of the source is accepted until it is set back. It does not apply to other
// sources.
TEST_F(MocapSourceTest, AcceptsOneClockChangeUntilItIsReverted) {
  EXPECT_EQ(standing_of(1, 0.0, 0.0, 100), Standing::kCandidate);
  EXPECT_EQ(standing_of(1, 0.1, kHourS, 101), Standing::kAccepted);
  EXPECT_EQ(standing_of(1, 0.2, kHourS, 5), Standing::kAccepted)
      << "restarted numbers with the known clock";
  EXPECT_EQ(standing_of(1, 0.3, 0.0, 3), Standing::kAccepted)
      << "clock set back and numbers restarted";
  EXPECT_EQ(standing_of(1, 0.4, kHourS, 2), Standing::kRefused) << "the previous clock";
  EXPECT_EQ(standing_of(1, 0.5, kHourS, 7), Standing::kAccepted) << "the clock is set again";
  EXPECT_EQ(standing_of(2, 1.0), Standing::kCandidate);
  EXPECT_EQ(standing_of(2, 1.1, kHourS, 0), Standing::kRefused)
      << "the clock of the previous source";
}

TEST_F(MocapSourceTest, AcceptsACandidateAtTimeZero) {
  models::MocapFrame frame;
  frame.stamp.run_id = 1;
  frame.stamp.time = Time{} + from_seconds(0.1);
  EXPECT_EQ(source.judge(frame, Time{} + from_seconds(0.1)), Standing::kCandidate);
}

}  // namespace
}  // namespace vantage::drivers
