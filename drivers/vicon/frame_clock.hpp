#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "drivers/vicon/tick_period_fit.hpp"

namespace vantage::drivers::vicon {

/// Time of a frame by its server, and a lower bound of its sending time.
struct FrameTiming {
  std::int64_t tick = 0;       ///< frame number, or the server's stamp
  double stated_tick_s = 0.0;  ///< s; time between two ticks stated by the server; 0: not stated
  /// Sending time of the ping for the newest echo before this frame. The server sent the frame
  /// after this time.
  std::optional<Duration> pinged;
  std::optional<Duration> sent;  ///< sending time; only if the server's clock is known
};

/// Estimator of the time that each frame waited in a queue between the server and this driver.
///
/// The server numbers or stamps its frames with a constant tick period. The period gives a line:
/// the arrival time of each frame if no frame had waited. A frame that arrives later than the line
/// has waited for the difference. A frame that arrives earlier lowers the line immediately. The
/// line rises by the period, and by the possible error of the period (kDrift); a delay that grows
/// faster is reported as lateness.
///
/// A pause of the server must not be mistaken for a queue: no frames arrive in both cases. The echo
/// of a ping distinguishes pause and queue, because the server sends the echo after the previous
/// frames. Each frame that arrives after the echo was sent after the ping.
///
/// If the sending time of a frame is known, the line is that time, and lateness includes the
/// duration of the transmission.
///
/// The period stated by the server is used until echoes show for kRefuted_s that it is wrong. If no
/// period is stated, it is estimated (TickPeriodFit). Until the period is known, lateness is 0, and
/// a queue that exists from the first frame on is not detected.
class FrameClock {
 public:
  /// Largest relative error of a known tick period.
  static constexpr double kDrift = 0.0005;
  /// Shortest duration of data from which a tick period is estimated, s.
  static constexpr double kLearn_s = 2.0;
  static constexpr double kRefuted_s = 3.0;

  /// Returns the lateness of the frame relative to the line; ≥ 0.
  /// @param arrival  arrival time by the steady clock
  /// @param latency  latency stated by the server; subtracted from `arrival`
  Duration lateness(const FrameTiming& frame, Duration arrival, Duration latency);
  /// Processes a new echo, which arrived after the newest frame. Consistently slow echoes reveal a
  /// queue that existed before the first frame.
  void on_echo(Duration sent, Duration arrived);
  /// True if the newest frames are late and their lateness does not decrease: the queue is not
  /// emptying. In a queue that empties, newer frames arrive immediately.
  [[nodiscard]] bool is_standing() const { return is_standing_; }
  /// Restarts the estimator: the next frame counts as not late.
  void restart() { *this = {}; }

 private:
  void begin(const FrameMark& now, double stated_tick_s);
  void learn(const FrameMark& now, double late_s);
  void check_stated(const FrameMark& now);
  void watch_queue(const FrameMark& now, double late_s);

  std::optional<FrameMark> last_;
  double line_s_ = 0.0;    ///< s; arrival time of `last_` if that frame had not waited
  double tick_s_ = 0.0;    ///< s; tick period in use; 0: unknown
  double stated_s_ = 0.0;  ///< s; tick period stated by the server; 0: not stated
  double drift_ = kDrift;
  /// the period is estimated, because the server states none or a wrong one
  bool is_learned_ = false;

  TickPeriodFit fit_;
  double next_fit_s_ = 0.0;         ///< s; time span of data at which the fit is computed again
  std::optional<FrameMark> block_;  ///< start of the check whether the tick period is too long
  double block_late_s_ = 0.0;

  /// a fast echo (with a short round trip) arrived since the last frame
  bool is_after_echo_ = false;
  double round_trip_s_ = 0.0;           ///< s; round trip of the newest echo
  std::optional<FrameMark> echo_mark_;  ///< first frame after a fast echo
  double refuted_tick_s_ = 0.0;         ///< s; tick period that contradicts the stated period
  int refutations_ = 0;                 ///< number of consecutive intervals with that tick period

  std::optional<Duration> slow_since_;  ///< sending time of the first of the consecutive slow pings
  double least_slow_s_ = 0.0;

  std::optional<double> window_begin_s_;  ///< start of the check whether lateness decreases
  double window_late_s_ = 0.0;            ///< s; lateness at the start of that check
  int window_frames_ = 0;
  bool is_standing_ = false;
};

}  // namespace vantage::drivers::vicon
