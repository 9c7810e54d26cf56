#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.hpp"

namespace vantage {

/// Computes how long a thread waited for a processor in the last second, from readings of the
/// kernel's counter. Constant memory, no allocation.
class ProcessorWait {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(1);

  /// Adds a reading of the counter at `now`. If `now` is not later than at the previous reading, or
  /// the value is lower, the counter is assumed to be a new one: all previous readings are
  /// discarded.
  /// @param waited_us waiting time since the start of the thread, µs
  void add(Time now, std::int64_t waited_us);

  /// Returns the waiting time, s, between the newest reading and the last reading that is at least
  /// kWindow older; 0 if there are fewer than two readings. After a gap in the readings, this
  /// interval is longer than a second.
  [[nodiscard]] double recent_s() const;

 private:
  static constexpr std::size_t kReadingsMax = 32;
  struct Reading {
    Time time{};
    std::int64_t waited_us = 0;
  };
  [[nodiscard]] const Reading& at(std::size_t i) const {
    return readings_[(first_ + i) % kReadingsMax];
  }

  std::array<Reading, kReadingsMax> readings_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace vantage
