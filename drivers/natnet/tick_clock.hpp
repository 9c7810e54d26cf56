#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace vantage::drivers::natnet {

/// Estimator of the local steady time at a tick of the server's clock, from the answers to echo
/// requests.
///
/// The server's clock showed the returned ticks after the request was sent and before the answer
/// arrived. The estimate is the middle of this interval. If the interval is long, an earlier time
/// is used: the answer waited in the same queue as the frames, and a frame must not appear newer
/// than it is. The answer with the smallest error is kept. The error of a kept answer grows with
/// its age, because the two clocks have slightly different rates.
class TickClock {
 public:
  /// Growth of the error of an answer, s per s.
  static constexpr double kDrift = 1e-4;
  /// Longest time from the sending of a request to its arrival at the server, s: requests are short
  /// and rare, so they do not queue.
  static constexpr double kRequest_s = 0.0025;

  /// Forgets all answers. @param ticks_per_s  rate of the server's clock, Hz; > 0
  void restart(std::uint64_t ticks_per_s);
  /// Processes an answer that contained `ticks`. An answer that contradicts the estimate replaces
  /// it: the server's clock was restarted.
  void on_echo(Duration sent, Duration arrived, std::uint64_t ticks);
  /// Returns the steady time at `ticks`; nullopt before the first answer.
  [[nodiscard]] std::optional<Duration> steady_at(std::uint64_t ticks) const;
  /// Returns the time between two ticks of the server, s; negative if `to` is before `from`.
  [[nodiscard]] double seconds_between(std::uint64_t from, std::uint64_t to) const;

 private:
  struct Answer {
    Duration steady{};  ///< estimated local time at `ticks`
    std::uint64_t ticks = 0;
    Duration arrived{};
    double error_s = 0.0;
  };

  double ticks_per_s_ = 1.0;
  std::optional<Answer> best_;
};

}  // namespace vantage::drivers::natnet
