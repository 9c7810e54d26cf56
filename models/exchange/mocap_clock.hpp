#pragma once

#include <cstdint>
#include <memory>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Converter of capture times of mocap frames to our clock, which works even when the clock that
/// stamps them is set. Each receiver of VICON has one, and uses captured() instead of the stamp.
///
/// The latency is arrival minus stamp minus the known clock offset. It is valid between 0 and one
/// second plus the latency stated in the frame (`arrival` at the publisher minus its stamp). The
/// clock was set if the latency is invalid, or if a frame with a higher number reached the
/// publisher earlier than the previous one. The capture is then assumed to be one period per frame
/// number after the previous capture. So an existing latency is preserved, and a delay that begins
/// together with the new clock is detected.
class MocapClock {
 public:
  /// Processes the next frame of the trusted publisher. Another run resets the state.
  /// @return false when the clock was set since the last frame, or is ahead of ours
  [[nodiscard]] bool on_frame(const MocapFrame& frame, Time now);
  /// As above, for one run. `stated` is the latency that the frame states; ≥ 0.
  [[nodiscard]] bool on_frame(Time stamp, Time arrival, std::int64_t number, Duration stated = {});
  /// Processes the frame and returns it with its times by our clock: `frame` itself unless the
  /// clock was set.
  [[nodiscard]] std::shared_ptr<const MocapFrame> on_our_clock(
      const std::shared_ptr<const MocapFrame>& frame, Time now);
  /// Returns the latency of the newest frame. An initial clock offset that cannot be a latency
  /// counts as 0.
  [[nodiscard]] Duration latency() const { return latency_; }
  [[nodiscard]] double latency_s() const { return to_seconds(latency_); }
  /// Returns the capture time of the newest frame by our clock; its stamp unless the clock was set.
  [[nodiscard]] Time captured() const { return arrival_ - latency_; }

 private:
  bool has_frame_ = false;
  std::int64_t run_id_ = 0;
  Time stamp_{};
  Time publisher_arrival_{};  ///< arrival of the frame at the publisher, by the stamping clock
  Time arrival_{};
  std::int64_t number_ = 0;
  Duration period_{};  ///< between stamps; 0 before two frames by the same clock
  Duration offset_{};  ///< offset: arrival's clock minus the stamp's
  Duration latency_{};
};

}  // namespace vantage::models
