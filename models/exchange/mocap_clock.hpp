#pragma once

#include <cstdint>
#include <memory>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Converter of mocap capture times to the local clock, tolerant of a mocap clock that is set at
/// any time. Each receiver of VICON has one and uses captured() instead of the stamp.
///
/// The latency is the arrival time minus the stamp, minus the known offset of the clocks. It is
/// accepted while it is between 0 and a second plus the latency that the frame states (its
/// `arrival` at the publisher minus its stamp). Otherwise the clock was set between two frames. The
/// same holds if a frame with a higher number reached the publisher earlier than the frame before.
/// The new stamp is then assumed to be where the old clock would have put it, one period later per
/// frame number. So an existing latency is kept, and a latency that begins together with the new
/// clock is detected.
class MocapClock {
 public:
  /// Processes the next frame of the trusted publisher. Starts anew for another run of the
  /// publisher.
  /// @return false when the clock was set since the last frame, or is ahead of the local clock
  [[nodiscard]] bool on_frame(const MocapFrame& frame, Time now);
  /// Processes the next frame of the same run. `stated` is the latency that the frame states; ≥ 0.
  [[nodiscard]] bool on_frame(Time stamp, Time arrival, std::int64_t number, Duration stated = {});
  /// Processes the next frame and returns it with its times on the local clock: `frame` itself
  /// unless the clock was set.
  [[nodiscard]] std::shared_ptr<const MocapFrame> on_our_clock(
      const std::shared_ptr<const MocapFrame>& frame, Time now);
  /// Returns the latency of the newest frame. An initial clock offset counts as 0 if it cannot be
  /// latency.
  [[nodiscard]] Duration latency() const { return latency_; }
  [[nodiscard]] double latency_s() const { return to_seconds(latency_); }
  /// Returns the capture time of the newest frame on the local clock; equal to its stamp unless the
  /// clock was set.
  [[nodiscard]] Time captured() const { return arrival_ - latency_; }

 private:
  bool has_frame_ = false;
  std::int64_t run_id_ = 0;
  Time stamp_{};
  Time reached_{};  ///< arrival of the frame at the publisher, on the clock of the stamps
  Time arrival_{};
  std::int64_t number_ = 0;
  Duration period_{};  ///< between stamps; 0 before two frames of one clock
  Duration apart_{};   ///< local clock minus the clock of the stamps
  Duration latency_{};
};

}  // namespace vantage::models
