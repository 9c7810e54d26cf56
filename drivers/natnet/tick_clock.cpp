#include "drivers/natnet/tick_clock.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers::natnet {

void TickClock::restart(std::uint64_t ticks_per_s) {
  ticks_per_s_ = static_cast<double>(ticks_per_s);
  best_.reset();
}

double TickClock::seconds_between(std::uint64_t from, std::uint64_t to) const {
  const double ticks =
      to >= from ? static_cast<double>(to - from) : -static_cast<double>(from - to);
  return ticks / ticks_per_s_;
}

std::optional<Duration> TickClock::steady_at(std::uint64_t ticks) const {
  if (!best_) {
    return std::nullopt;
  }
  constexpr double kReach_s = 1e6;  // s; ticks farther away do not belong to this clock
  const double since_s = seconds_between(best_->ticks, ticks);
  return std::abs(since_s) > kReach_s ? std::nullopt
                                      : std::optional(best_->steady + from_seconds(since_s));
}

void TickClock::on_echo(Duration sent, Duration arrived, std::uint64_t ticks) {
  const double round_trip_s = to_seconds(arrived - sent);
  if (round_trip_s < 0.0) {
    return;
  }
  const double request_s = std::min(0.5 * round_trip_s, kRequest_s);
  const Answer answer{sent + from_seconds(request_s), ticks, arrived, 0.5 * round_trip_s};
  if (best_) {
    const double error_s = best_->error_s + kDrift * to_seconds(arrived - best_->arrived);
    const std::optional<Duration> expected = steady_at(ticks);
    const bool is_possible = expected && *expected >= sent - from_seconds(error_s) &&
                             *expected <= arrived + from_seconds(error_s);
    if (is_possible && error_s < answer.error_s) {
      return;
    }
  }
  best_ = answer;
}

}  // namespace vantage::drivers::natnet
