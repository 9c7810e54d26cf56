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

// Lower bound: allows a wall clock that started in 1970. Upper bound: the year 2200.
constexpr Duration::rep kOffsetMin_us = -100'000'000'000'000;
constexpr Duration::rep kOffsetMax_us = 7'258'118'400'000'000;

std::optional<Duration> offset_from_environment() {
  const char* const given = std::getenv(SteadyClock::kOffsetVariable);
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
    throw StartupError(std::string(SteadyClock::kOffsetVariable) + " is " + text +
                       ", but must be from " + std::to_string(kOffsetMin_us) + " to " +
                       std::to_string(kOffsetMax_us) +
                       "; unset the variable, or restart the programs");
  }
  return Duration{offset_us};
}

}  // namespace

Time SystemClock::now() const { return wall_clock(); }

SteadyClock::SteadyClock() : SteadyClock([] { return vantage::monotonic_ns(); }, wall_clock) {
  offset_ = offset_from_environment().value_or(offset_);
}

SteadyClock::SteadyClock(MonotonicNs monotonic_ns, WallClock wall)
    : monotonic_ns_(std::move(monotonic_ns)),
      wall_(std::move(wall)),
      compared_(monotonic()),
      offset_(wall_() - compared_) {}

Duration SteadyClock::offset_at(Time monotonic) const {
  const Duration most = from_seconds(kSlewPerS * to_seconds(monotonic - compared_));
  return offset_ + std::clamp(slew_, -most, most);
}

Time SteadyClock::now() const {
  const std::lock_guard lock(mutex_);
  const Time steady = monotonic();
  const Duration offset = offset_at(steady);
  if (steady - compared_ >= kComparePeriod) {
    const Duration difference = wall_() - (steady + offset);
    compared_ = steady;
    offset_ = offset;
    slew_ = std::chrono::abs(difference) <= kFollowMax ? difference : Duration{};
  }
  return steady + offset;
}

void SteadyClock::export_offset() const {
  const std::lock_guard lock(mutex_);
  ::setenv(kOffsetVariable, std::to_string(offset_at(monotonic()).count()).c_str(), 1);
}

}  // namespace vantage::bus
