#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Selection of one of several publishers of VICON. Subscribe to VICON as a shared channel: the bus
/// then orders the frames of each run separately, and this class chooses the publisher.
///
/// The source is the first run with a frame that contains an accepted pose of the vehicle
/// (confirm()). While the source publishes, other runs are refused. After a gap of kSilentS, the
/// next run with an accepted pose of the vehicle replaces the source; in the air the pose must
/// agree with the prediction. Until it is replaced, the old source is accepted again as soon as it
/// publishes.
///
/// A run is considered only if its stamps are within kFreshS of the local clock, so a replayed log
/// is refused; hosts need a common clock (NTP or PTP). If the source's clock is set, the source
/// stays accepted while its frame numbers continue. Its stamps are then compared with the new
/// clock.
class MocapSource {
 public:
  /// s; longer than the maximum age of a pose, shorter than the time until landing
  static constexpr double kSilentS = 0.3;
  static constexpr double kFreshS = 2.0;
  /// maximum number of frames lost while the source's clock is set
  static constexpr std::int64_t kLostMax = 1000;

  /// Decision about a frame.
  enum class [[nodiscard]] Standing{
      kAccepted,  ///< frame of the source
      /// frame of a run that may become the source: use it only if its pose of the vehicle is
      /// accepted
      kCandidate,
      kRefused,
  };

  Standing judge(const models::MocapFrame& frame, Time now);
  /// Makes the run of a candidate's frame the source, after the pose in the frame was accepted.
  void confirm(const models::MocapFrame& frame, Time now);

  /// Returns a message about frames refused in the last kFreshS; nullptr if none was refused.
  [[nodiscard]] const char* refusal_message(Time now) const;
  /// Appends the number of frames refused because of another source, the number refused because of
  /// their time, and the number of takeovers.
  void count(std::vector<models::NamedCount>& out) const;

 private:
  [[nodiscard]] static bool is_current(Time stamp, Duration ahead, Time now);
  void record_frame(const models::MocapFrame& frame, Time now);

  std::optional<std::int64_t> run_id_;
  Time received_at_{};
  std::int64_t number_ = 0;                ///< number of the source's newest frame
  Duration ahead_{};                       ///< lag of the local clock behind the source's clock
  std::optional<Time> other_received_at_;  ///< time of the last frame of another source
  /// time of the last frame refused because of its stamp
  std::optional<Time> other_time_received_at_;
  std::int64_t others_refused_ = 0;
  std::int64_t other_time_ = 0;
  std::int64_t takeovers_ = 0;
};

}  // namespace vantage::drivers
