#pragma once

#include <cstdint>
#include <memory>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::models {

/// Converts capture times of mocap frames to this host's clock, even when the clock that stamps the
/// frames is set to another time. Every receiver of VICON uses the time that captured() returns
/// instead of the stamp.
///
/// The latency is arrival minus stamp minus the known clock offset. It is valid between 0 and one
/// second plus the latency stated in the frame (`arrival` at the publisher minus its stamp). The
/// stamping clock is assumed to have been set if the latency is invalid, or if a frame with a
/// higher number has an earlier arrival time than the previous one. The frame's capture is then
/// assumed to be one period per frame number after the previous capture. This assumption preserves
/// the known latency and detects a delay that begins when the clock is set.
class MocapClock {
 public:
  /// Processes the next frame of the trusted publisher. A frame with another run_id resets the
  /// state.
  /// @return false if the stamping clock was set since the last frame, or is ahead of this host's
  /// clock
  [[nodiscard]] bool on_frame(const MocapFrame& frame, Time now);
  /// As on_frame(frame, now), for frames of one run. `stated` is the latency stated in the frame; ≥
  /// 0.
  [[nodiscard]] bool on_frame(Time stamp, Time arrival, std::int64_t number, Duration stated = {});
  /// Processes the frame and returns it with its times converted to this host's clock. Returns
  /// `frame` itself unless the stamping clock was set.
  [[nodiscard]] std::shared_ptr<const MocapFrame> on_our_clock(
      const std::shared_ptr<const MocapFrame>& frame, Time now);
  /// Returns the latency of the newest frame, s. An initial clock offset that cannot be a latency
  /// counts as 0.
  [[nodiscard]] double latency_s() const { return to_seconds(latency_); }
  /// Returns the capture time of the newest frame by this host's clock. It equals the stamp unless
  /// the stamping clock was set.
  [[nodiscard]] Time captured() const { return arrival_ - latency_; }

 private:
  bool has_frame_ = false;
  std::int64_t run_id_ = 0;
  Time stamp_{};
  /// time at which the publisher received the frame, by the clock that stamps frames
  Time publisher_arrival_{};
  Time arrival_{};
  std::int64_t number_ = 0;
  /// time between the stamps of consecutive frames; 0 until two frames by the same clock arrived
  Duration period_{};
  Duration offset_{};  ///< clock of `arrival` minus clock of the stamp
  Duration latency_{};
};

}  // namespace vantage::models
