#pragma once

#include <cstdint>
#include <memory>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Computes when mocap frames were captured by our clock, though the clock that stamps them may be
/// set at any time. Each receiver of VICON has one, and uses captured() instead of the stamp.
///
/// While arrival less stamp, less what the clocks are known to be apart, is between 0 and a second
/// plus the latency that the frame itself states (its `arrival` at the publisher less its stamp),
/// that is the latency. If not, or if a frame with a higher number reached the publisher earlier
/// than the frame before, the clock was set between the two: the new stamp is then assumed to be
/// where the old clock would have put it, a period later for each frame number. So a latency that
/// was there stays, and one that begins together with the new clock is seen.
class MocapClock {
 public:
  /// Takes the next frame of the trusted publisher. Another run begins anew.
  /// @return false when the clock was set since the last frame, or is ahead of ours
  [[nodiscard]] bool on_frame(const MocapFrame& frame, Time now);
  /// The same of one run. `stated` is the latency that the frame states; ≥ 0.
  [[nodiscard]] bool on_frame(Time stamp, Time arrival, std::int64_t number, Duration stated = {});
  /// The same, and the frame with its times by our clock: `frame` itself unless the clock was set.
  [[nodiscard]] std::shared_ptr<const MocapFrame> on_our_clock(
      const std::shared_ptr<const MocapFrame>& frame, Time now);
  /// Latency of the newest frame; what the clocks were apart at first counts as 0 if it cannot be
  /// latency.
  [[nodiscard]] Duration latency() const { return latency_; }
  [[nodiscard]] double latency_s() const { return to_seconds(latency_); }
  /// Capture of the newest frame by our clock; equal to its stamp unless the clock was set.
  [[nodiscard]] Time captured() const { return arrival_ - latency_; }

 private:
  bool has_frame_ = false;
  std::int64_t run_id_ = 0;
  Time stamp_{};
  Time reached_{};  ///< arrival of the frame at the publisher, by the clock that stamps it
  Time arrival_{};
  std::int64_t number_ = 0;
  Duration period_{};  ///< between stamps; 0 before two frames of one clock
  Duration apart_{};   ///< arrival's clock less the stamp's
  Duration latency_{};
};

}  // namespace vantage::models
