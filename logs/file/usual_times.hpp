#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.hpp"

namespace vantage::logs {

/// Event times of one log, with those left out that are far from the others: of a clock that was
/// not set yet (1970), of another unit, or damaged.
///
/// Times with less than a day from one to the next make a group. A group is outlying when the
/// largest group has at least ten times as many events. So a log that was put together from flights
/// of several days keeps them all, and one broken stamp does not make a flight last for decades.
class UsualTimes {
 public:
  static constexpr Duration kApart = std::chrono::hours(24);
  static constexpr std::int64_t kFewer = 10;

  void add(Time time);

  struct Span {
    Time begin{};
    Time end{};
    std::int64_t outlying = 0;  ///< times that are not within
  };
  /// Returns zeros when no time was added.
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

  std::vector<Group> groups_;   ///< apart from each other; the first has the newest time
  std::int64_t forgotten_ = 0;  ///< events of the smallest groups, when there were too many
};

}  // namespace vantage::logs
