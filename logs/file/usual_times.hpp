#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.hpp"

namespace vantage::logs {

/// Range of the event times of one log without outliers. Outliers come from a clock that was not
/// set yet (1970), from another unit or from damage.
///
/// Times that are less than a day apart form a group. A group is outlying if the largest group has
/// at least ten times as many events. So a log that was concatenated from flights on several days
/// keeps them all, and one damaged time stamp does not extend a flight to decades.
class UsualTimes {
 public:
  static constexpr Duration kApart = std::chrono::hours(24);
  static constexpr std::int64_t kFewer = 10;

  void add(Time time);

  struct Span {
    Time begin{};
    Time end{};
    std::int64_t outlying = 0;  ///< number of event times outside the span
  };
  /// Returns the range without outliers; zeros when no time was added.
  [[nodiscard]] Span span() const;

 private:
  static constexpr std::size_t kGroupsMax = 64;
  struct Group {
    Time begin{};
    Time end{};
    std::int64_t events = 0;
    [[nodiscard]] bool reaches(Time time) const;
  };
  void add_to_others(Time time);

  /// Separate groups; the first one contains the most recently added time.
  std::vector<Group> groups_;
  /// Events of the smallest groups, which are dropped when there are too many groups.
  std::int64_t dropped_events_ = 0;
};

}  // namespace vantage::logs
