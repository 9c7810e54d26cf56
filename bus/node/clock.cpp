#include "bus/node/clock.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "core/check.hpp"
#include "core/deadline.hpp"

namespace vantage::bus {
namespace {

constexpr Duration kComparePeriod = std::chrono::milliseconds(20);

Time wall_clock() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return Time{std::chrono::duration_cast<Duration>(since_epoch)};
}

// Lower bound: the wall clock started at 1970. Upper bound: the year 2200.
constexpr Duration::rep kOffsetMin_us = -100'000'000'000'000;
constexpr Duration::rep kOffsetMax_us = 7'258'118'400'000'000;

std::optional<Duration> handed_on() {
  const char* const given = std::getenv(SteadyClock::kHandedOn);
  if (given == nullptr) {
    return std::nullopt;
  }
  const std::string text(given);
  Duration::rep offset_us = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), offset_us);
  const bool is_number = parsed.ec == std::errc() && parsed.ptr == text.data() + text.size();
  if (!is_number) {
    return std::nullopt;
  }
  if (offset_us < kOffsetMin_us || offset_us > kOffsetMax_us) {
    throw StartupError(std::string(SteadyClock::kHandedOn) + " is " + text + ", and must be from " +
                       std::to_string(kOffsetMin_us) + " to " + std::to_string(kOffsetMax_us) +
                       ": unset it, or restart the programs");
  }
  return Duration{offset_us};
}

}  // namespace

Time SystemClock::now() const { return wall_clock(); }

SteadyClock::SteadyClock() : SteadyClock([] { return vantage::monotonic_ns(); }, wall_clock) {
  ahead_ = handed_on().value_or(ahead_);
}

SteadyClock::SteadyClock(MonotonicNs monotonic_ns, WallClock wall)
    : monotonic_ns_(std::move(monotonic_ns)),
      wall_(std::move(wall)),
      compared_(monotonic()),
      ahead_(wall_() - compared_) {}

Duration SteadyClock::ahead_at(Time monotonic) const {
  const Duration most = from_seconds(kSlewPerS * to_seconds(monotonic - compared_));
  return ahead_ + std::clamp(draw_, -most, most);
}

Time SteadyClock::now() const {
  const std::lock_guard lock(mutex_);
  const Time steady = monotonic();
  const Duration ahead = ahead_at(steady);
  if (steady - compared_ >= kComparePeriod) {
    const Duration apart = wall_() - (steady + ahead);
    compared_ = steady;
    ahead_ = ahead;
    draw_ = std::chrono::abs(apart) <= kFollowMax ? apart : Duration{};
  }
  return steady + ahead;
}

void SteadyClock::hand_on() const {
  const std::lock_guard lock(mutex_);
  ::setenv(kHandedOn, std::to_string(ahead_at(monotonic()).count()).c_str(), 1);
}

}  // namespace vantage::bus
