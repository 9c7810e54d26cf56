#include "drivers/natnet/tick_clock.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/support/random.hpp"

namespace vantage::drivers::natnet {
namespace {

constexpr std::uint64_t kTicksPerSecond = 3'312'787;  // as recorded from Motive

/// Server with a clock that began `began_s` before the local clock and runs faster by `skew`.
struct Server {
  double began_s = 4'000.0;
  double skew = 0.0;

  [[nodiscard]] std::uint64_t ticks_at(double own_s) const {
    return static_cast<std::uint64_t>(
        std::llround((began_s + own_s) * (1.0 + skew) * kTicksPerSecond));
  }
};

/// Sends a request at `own_s`, which takes `up_s`; its answer takes `down_s`.
void ask(TickClock& clock, const Server& server, double own_s, double up_s, double down_s) {
  clock.on_echo(from_seconds(own_s), from_seconds(own_s + up_s + down_s),
                server.ticks_at(own_s + up_s));
}

double error_s(const TickClock& clock, const Server& server, double own_s) {
  return to_seconds(*clock.steady_at(server.ticks_at(own_s))) - own_s;
}

TEST(TickClock, HasNoTimeBeforeTheFirstAnswer) {
  TickClock clock;
  clock.restart(kTicksPerSecond);
  EXPECT_EQ(clock.steady_at(5), std::nullopt);
  EXPECT_NEAR(clock.seconds_between(0, kTicksPerSecond), 1.0, 1e-12);
  EXPECT_NEAR(clock.seconds_between(kTicksPerSecond, 0), -1.0, 1e-12);
}

// The server reads its clock between request and answer, so the assumed middle is wrong by at most
// half of the round trip. A rate error (skew) adds at most its rate times the age of the answer in
// use.
TEST(TickClock, ErrorIsAtMostHalfOfAShortRoundTrip) {
  test::Random random(5);
  for (const double skew : {0.0, 3e-5, -3e-5}) {
    TickClock clock;
    clock.restart(kTicksPerSecond);
    const Server server{random.uniform(0.0, 1e5), skew};
    double worst_s = 0.0;
    for (double own_s = 10.0; own_s < 130.0; own_s += 0.05) {
      const bool is_slow = random.uniform(0.0, 1.0) < 0.7;
      const double up_s = is_slow ? random.uniform(1e-4, 0.05) : random.uniform(1e-4, 3e-4);
      ask(clock, server, own_s, up_s,
          is_slow ? random.uniform(1e-4, 0.05) : random.uniform(1e-4, 3e-4));
      if (own_s > 12.0) {  // a short round trip has occurred
        worst_s = std::max(worst_s, std::abs(error_s(clock, server, own_s)));
      }
    }
    EXPECT_LT(worst_s, 0.0006) << skew;
  }
}

// All answers wait for 2 s in the same queue as the frames. The clock must not hide this delay: its
// error is at most the travel time of a request.
TEST(TickClock, ShowsTheDelayOfAConstantQueue) {
  TickClock clock;
  clock.restart(kTicksPerSecond);
  const Server server;
  for (double own_s = 10.0; own_s < 20.0; own_s += 0.05) {
    ask(clock, server, own_s, 0.0002, 2.0);
    EXPECT_LE(std::abs(error_s(clock, server, own_s)), TickClock::kRequest_s);
  }
}

TEST(TickClock, FollowsARestartOfTheServer) {
  TickClock clock;
  clock.restart(kTicksPerSecond);
  ask(clock, {4'000.0, 0.0}, 10.0, 0.0001, 0.0001);
  const Server restarted{-10.5, 0.0};
  ask(clock, restarted, 11.0, 0.002, 0.002);
  EXPECT_LT(std::abs(error_s(clock, restarted, 11.0)), 0.0021) << "though the answer was slower";
}

TEST(TickClock, RefusesTicksOfAnotherClock) {
  TickClock clock;
  clock.restart(1);
  clock.on_echo(Duration{0}, Duration{0}, 0);
  EXPECT_EQ(clock.steady_at(~std::uint64_t{0}), std::nullopt);
  clock.on_echo(Duration{10}, Duration{5}, 7);
  EXPECT_EQ(clock.steady_at(0), Duration{0}) << "an answer before its request is ignored";
}

}  // namespace
}  // namespace vantage::drivers::natnet
