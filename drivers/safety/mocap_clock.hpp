#pragma once

#include <cstdint>

#include "core/time.hpp"

namespace vantage::drivers {

/// How late mocap's frames are, though the clock that stamps them may be set at any time.
///
/// While arrival less stamp is between 0 and a second, beyond what the clocks are known to be
/// apart, that is the latency. If not, the clock was set between two frames: the new stamp is then
/// taken to be where the old clock would have put it, a period later for each frame number, so that
/// a latency that was there stays, and one that begins together with the new clock is seen.
class MocapClock {
 public:
  /// False when the clock was set since the last frame, or is ahead of ours.
  [[nodiscard]] bool on_frame(Time stamp, Time arrival, std::int64_t number);
  /// Of the newest frame; what the clocks were apart at first counts as 0 if it cannot be latency.
  [[nodiscard]] double latency_s() const { return latency_s_; }

 private:
  bool has_frame_ = false;
  Time stamp_{};
  Time arrival_{};
  std::int64_t number_ = 0;
  double period_s_ = 0.0;  ///< between stamps; 0 before two frames of one clock
  double apart_s_ = 0.0;   ///< arrival's clock less the stamp's
  double latency_s_ = 0.0;
};

}  // namespace vantage::drivers
