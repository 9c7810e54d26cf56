#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Which of several publishers of VICON is believed. Subscribe to VICON as a shared channel: the
/// bus then orders the frames of each run by themselves, and it is decided here.
///
/// The source is the first run of which a frame passed as the vehicle's own pose (confirm()). While
/// it is heard nobody else is; silent for kSilentS it is replaced by the next run of which a frame
/// passes, which in the air only one does that sees the vehicle where it is. Until then it takes
/// its place again as soon as it speaks.
///
/// A run is looked at only when its stamps are within kFreshS of our own clock, so a log that is
/// played is nobody; hosts need a common clock (NTP or PTP). The source's clock may be set: it goes
/// on being believed when its frame numbers go on, and its stamps are then held against that clock.
class MocapSource {
 public:
  static constexpr double kSilentS =
      0.3;  ///< longer than a pose is believed, shorter than it lands
  static constexpr double kFreshS = 2.0;
  static constexpr std::int64_t kGoesOnMax = 1000;  ///< frames lost while its clock is set

  /// What may be done with a frame.
  enum class [[nodiscard]] Standing{
      kBelieved,   ///< the source's
      kCandidate,  ///< of a run that may become it: only when it passes as the own pose
      kRefused,
  };

  Standing judge(const models::MocapFrame& frame, Time now);
  /// A candidate's frame has passed.
  void confirm(const models::MocapFrame& frame, Time now);

  /// Who is refused now, in words for people; nullptr: nobody was in the last kFreshS.
  [[nodiscard]] const char* complaint(Time now) const;
  /// Appends what was refused: frames of other sources, frames of other times.
  void count(std::vector<models::NamedCount>& out) const;

 private:
  [[nodiscard]] static bool is_of_now(Time stamp, Duration ahead, Time now);
  void hear(const models::MocapFrame& frame, Time now);

  std::optional<std::int64_t> run_id_;
  Time heard_{};
  std::int64_t number_ = 0;               ///< of its newest frame
  Duration ahead_{};                      ///< of our clock behind its own, since it was set
  std::optional<Time> other_heard_;       ///< another source beside it
  std::optional<Time> other_time_heard_;  ///< a frame of another time
  std::int64_t others_refused_ = 0;
  std::int64_t other_time_ = 0;
  std::int64_t takeovers_ = 0;
};

}  // namespace vantage::drivers
