#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace vantage::drivers::vicon {

/// Tells how late a frame came: a stream over TCP stalls for seconds and then delivers what has
/// queued, frame upon frame, and a reader that was stopped finds the same.
///
/// Frames are numbered, or stamped, at an even pace by who makes them. The pace is learned from
/// the arrivals, and with it the line under them: a frame above that line has waited. Frames that
/// go on being late at their own pace have not queued (a server that paused, or counts another
/// way): the line goes through them from then on. Until the pace is known no frame is late.
class FrameClock {
 public:
  /// @param tick     the frame's number, or its maker's stamp in any unit
  /// @param arrival  steady, less what the frame is known to have taken
  /// @return how much later it came than the line says; >= 0
  Duration lateness(std::int64_t tick, Duration arrival);
  /// Ticks begin anew.
  void restart();

 private:
  struct Mark {
    std::int64_t tick = 0;
    double arrival_s = 0.0;
  };
  void learn(const Mark& now, bool is_late);
  [[nodiscard]] bool goes_on_late(const Mark& now);

  std::optional<Mark> last_;
  double line_s_ = 0.0;  ///< the arrival of `last_` had it not waited
  double tick_s_ = 0.0;  ///< 0: not known
  Mark block_;           ///< where the stretch began that the pace is learned from
  int block_frames_ = 0;
  double block_tick_s_ = 0.0;       ///< of the stretch before; 0: none
  std::optional<Mark> late_since_;  ///< the first of the late ones at hand
  int late_frames_ = 0;
};

}  // namespace vantage::drivers::vicon
