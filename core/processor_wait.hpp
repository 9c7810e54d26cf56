#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.hpp"

namespace vantage {

/// Time that a thread waited for a processor within the last second, from readings of the kernel's
/// counter. Pure; constant memory; no allocation.
class ProcessorWait {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(1);

  /// Adds a reading of the counter at `now`. A reading that is lower than the one before, or not
  /// later, starts anew: it is from another counter.
  /// @param waited_us  since the start of the thread
  void add(Time now, std::int64_t waited_us);

  /// Returns the waiting time, s, between the newest reading and the last one that is at least
  /// kWindow older; 0 before two readings. After a gap in the readings this covers more than a
  /// second.
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
