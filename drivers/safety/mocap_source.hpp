#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Selection of one of several publishers of VICON. Subscribe to VICON as a shared channel: the bus
/// then orders the frames of each run separately, and the publisher is chosen here.
///
/// The source is the first run with a frame that passed as the vehicle's own pose (confirm()).
/// While it is received, other runs are refused. After a silence of kSilentS, the next run with a
/// frame that passes replaces it; in the air this requires that it shows the vehicle where it is.
/// Until then the old source is accepted again as soon as it returns.
///
/// A run is considered only if its stamps are within kFreshS of our own clock, so a replayed log is
/// refused; hosts need a common clock (NTP or PTP). The source's clock may be set: the source stays
/// accepted if its frame numbers continue, and its stamps are then compared with the new clock.
class MocapSource {
 public:
  /// s; longer than a pose is accepted, shorter than the time to land
  static constexpr double kSilentS = 0.3;
  static constexpr double kFreshS = 2.0;
  /// frames that may be lost while its clock is set
  static constexpr std::int64_t kGoesOnMax = 1000;

  /// Treatment of a frame.
  enum class [[nodiscard]] Standing{
      kAccepted,   ///< of the source
      kCandidate,  ///< of a run that may become the source: use it only if it passes as the own
                   ///< pose
      kRefused,
  };

  Standing judge(const models::MocapFrame& frame, Time now);
  /// Makes the run of a candidate's frame the source, after the frame has passed.
  void confirm(const models::MocapFrame& frame, Time now);

  /// Returns a message about what was refused in the last kFreshS; nullptr if nothing was.
  [[nodiscard]] const char* refusal_message(Time now) const;
  /// Appends the number of frames refused from other sources and with other times, and of
  /// takeovers.
  void count(std::vector<models::NamedCount>& out) const;

 private:
  [[nodiscard]] static bool is_current(Time stamp, Duration ahead, Time now);
  void record_frame(const models::MocapFrame& frame, Time now);

  std::optional<std::int64_t> run_id_;
  Time received_at_{};
  std::int64_t number_ = 0;  ///< number of its newest frame
  Duration ahead_{};         ///< lag of our clock behind the source's, since that was set
  std::optional<Time> other_received_at_;       ///< last frame of another source
  std::optional<Time> other_time_received_at_;  ///< last frame with another time
  std::int64_t others_refused_ = 0;
  std::int64_t other_time_ = 0;
  std::int64_t takeovers_ = 0;
};

}  // namespace vantage::drivers
