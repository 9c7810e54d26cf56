#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "drivers/vicon/pace_fit.hpp"

namespace vantage::drivers::vicon {

/// Time of a frame by its server, and bounds of it.
struct FrameTiming {
  std::int64_t tick = 0;       ///< the frame's number, or its server's stamp
  double stated_tick_s = 0.0;  ///< time between two ticks that the server states; 0: not stated
  /// Sending of the ping of the newest echo that arrived before this frame. The server sent the
  /// frame after that.
  std::optional<Duration> pinged;
};

/// Computes how long each frame has waited in a queue between the server and us.
///
/// The server numbers or stamps its frames at an even pace. From the pace follows a line: the
/// arrival of each frame if it had not waited. A frame above the line has waited for the
/// difference. An early frame lowers the line at once. The line rises by the pace, and by the error
/// that the pace may have (kDrift); a queue that grows faster is reported as lateness.
///
/// A line that is too low would report a pause of the server as a queue: numbers stand still in
/// both. The echo of a ping decides between the two, because the server sends it behind the frames
/// before it: no frame that arrives after the echo was sent before the ping.
///
/// The pace is the one that the server states, until echoes show for kRefuted_s that the numbers
/// have another. Where none is stated, the pace is learned (PaceFit): until it is known no frame is
/// late, and a line that is slow from its first frame on is not noticed.
class FrameClock {
 public:
  /// Greatest error of a pace that is known, as a share.
  static constexpr double kDrift = 0.0005;
  /// A pace is learned from so long a stretch at least.
  static constexpr double kLearn_s = 2.0;
  static constexpr double kRefuted_s = 3.0;

  /// Returns by how much the frame is later than the line; ≥ 0.
  /// @param arrival  steady, less the latency that the server states
  Duration lateness(const FrameTiming& frame, Duration arrival, Duration latency);
  /// Takes a new echo, which arrived behind the newest frame. Echoes that all took long show a
  /// queue that stood before the first frame.
  void on_echo(Duration sent, Duration arrived);
  /// True if the newest frames are late and do not become less so: the queue stands. Frames of a
  /// queue that empties are followed at once by newer ones.
  [[nodiscard]] bool is_standing() const { return is_standing_; }
  /// Begins anew: the next frame is not late.
  void restart() { *this = {}; }

 private:
  void begin(const FrameMark& now, double stated_tick_s);
  void learn(const FrameMark& now, double late_s);
  void check_stated(const FrameMark& now);
  void watch_queue(const FrameMark& now, double late_s);

  std::optional<FrameMark> last_;
  double line_s_ = 0.0;    ///< arrival of `last_` if it had not waited
  double tick_s_ = 0.0;    ///< pace in use; 0: not known
  double stated_s_ = 0.0;  ///< pace by the server's word; 0: not stated
  double drift_ = kDrift;
  bool is_learned_ = false;  ///< the pace is learned: none is stated, or the stated one is wrong

  PaceFit fit_;
  double next_fit_s_ = 0.0;         ///< span at which the fit is computed again
  std::optional<FrameMark> block_;  ///< begin of the second in which frames may come too fast
  double block_late_s_ = 0.0;

  bool is_after_echo_ = false;          ///< a fast echo arrived since the last frame
  double round_trip_s_ = 0.0;           ///< of that echo
  std::optional<FrameMark> echo_mark_;  ///< first frame behind a fast echo
  double refuted_tick_s_ = 0.0;         ///< pace of the stretches that refute the stated one
  int refutations_ = 0;                 ///< in a row

  std::optional<Duration> slow_since_;  ///< sending of the first ping of slow echoes in a row
  double least_slow_s_ = 0.0;

  std::optional<double> window_begin_s_;  ///< of the stretch in which the queue is watched
  double window_late_s_ = 0.0;            ///< lateness at its begin
  int window_frames_ = 0;
  bool is_standing_ = false;
};

}  // namespace vantage::drivers::vicon
