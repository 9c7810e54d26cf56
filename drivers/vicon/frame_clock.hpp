#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace vantage::drivers::vicon {

/// Computes how long each frame has waited in a queue between the server and us.
///
/// The server numbers or stamps its frames at an even pace. From the pace follows a line: the
/// arrival of each frame if it had not waited. A frame above the line has waited for the
/// difference. An early frame lowers the line at once. The line rises by kDrift of the time that
/// passes, which is more than two clocks differ; a queue that grows faster is reported as lateness.
///
/// The pace is the one that the server states. Where it states none, the pace is learned from the
/// arrivals: until then no frame is late, and a line that is slow from its first frame on is not
/// noticed. A pause of the server without new numbers looks like a queue. The echo of a ping
/// decides between the two: it comes behind the frames of the same queue.
class FrameClock {
 public:
  /// Share of the time that passes by which the line may rise.
  static constexpr double kDrift = 0.0005;

  /// Returns by how much the frame is later than the line; ≥ 0.
  /// @param tick           the frame's number, or its server's stamp
  /// @param arrival        steady, less the latency that the server states
  /// @param stated_tick_s  between two ticks by the server's word; 0: not stated
  Duration lateness(std::int64_t tick, Duration arrival, double stated_tick_s);
  /// Takes the echo of a ping that arrived behind the newest frame: that frame has not waited for
  /// longer than `round_trip`, and it has waited when several round trips are long.
  void on_echo(Duration round_trip);
  /// True if the newest frames are late and do not become less so: the queue stands. Frames of a
  /// queue that empties are followed at once by newer ones.
  [[nodiscard]] bool is_standing() const { return is_standing_; }
  /// Begins anew: the next frame is not late.
  void restart();

 private:
  static constexpr std::size_t kEchoes = 3;
  struct Mark {
    std::int64_t tick = 0;
    double arrival_s = 0.0;
  };
  void learn(const Mark& now);
  void watch_queue(const Mark& now, double late_s);

  std::optional<Mark> last_;
  double line_s_ = 0.0;      ///< arrival of `last_` if it had not waited
  double tick_s_ = 0.0;      ///< pace in use; 0: not known
  double stated_s_ = 0.0;    ///< pace by the server's word; 0: not stated
  bool is_refuted_ = false;  ///< echoes have shown that the stated pace is wrong

  Mark block_;  ///< begin of the stretch from which the pace is learned
  int block_frames_ = 0;
  double block_tick_s_ = 0.0;  ///< pace of the stretch before; 0: none

  std::optional<double> window_begin_s_;  ///< of the stretch in which the queue is watched
  double window_late_s_ = 0.0;            ///< lateness at its begin
  int window_frames_ = 0;
  bool is_standing_ = false;

  std::array<double, kEchoes> round_trips_s_{};
  std::size_t echoes_ = 0;
  double least_round_trip_s_ = 0.0;
  std::optional<Mark> echo_mark_;  ///< newest frame at the echo before
  int refutations_ = 0;            ///< in a row
};

}  // namespace vantage::drivers::vicon
