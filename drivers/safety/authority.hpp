#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Which of several planners of one robot is obeyed: the first heard, until it has been silent for
/// the lease. Its place is then taken by whoever speaks next, and it is refused if it comes back.
class PlannerLease {
 public:
  /// True when a plan of `run_id` may be judged at all.
  [[nodiscard]] bool admit(std::int64_t run_id, Time now, double lease_s);
  /// Since the holder spoke; kNever before anyone did.
  [[nodiscard]] double age_s(Time now) const;
  /// True for the one that holds it, and for anyone before somebody does.
  [[nodiscard]] bool is_holder(std::int64_t run_id) const { return !is_held_ || run_id == holder_; }
  /// True when another run spoke within the last `lease_s`.
  [[nodiscard]] bool is_contested(Time now, double lease_s) const;
  [[nodiscard]] std::int64_t takeovers() const { return takeovers_; }

 private:
  bool is_held_ = false;
  std::int64_t holder_ = 0;
  Time heard_{};
  bool other_spoke_ = false;
  Time other_heard_{};
  std::int64_t takeovers_ = 0;
};

/// Which of several operator stations is in charge: the first whose heartbeat is heard, until it
/// has been silent for `silent_s`. Any station may make the vehicle safer (hold, land, emergency
/// stop), only the one in charge may arm, take off or follow, and only its heartbeat counts.
///
/// What is said is obeyed when it is of now: stamped within kFreshS of our clock, or of the clock
/// of a station that is known. A station is known once a heartbeat of it was of now by our clock;
/// when its clock is set after that, the next heartbeat in its numbering says by how much. So a log
/// that is played, or a packet of yesterday, says nothing here; neither do old words of a station
/// that is alive; and one whose clock is set goes on being heard. What makes the vehicle safer is
/// also taken late from a known station, if it was not heard before by its number.
class OperatorAuthority {
 public:
  static constexpr double kFreshS = 2.0;
  /// True when the command may act.
  [[nodiscard]] bool admit(const models::OperatorCommand& command, Time now, double silent_s);
  /// Since the heartbeat of the station in charge; kNever before any.
  [[nodiscard]] double age_s(Time now) const;
  [[nodiscard]] std::int64_t handovers() const { return handovers_; }
  /// Appends handovers, commands and heartbeats that were not of now, and how often the clock of a
  /// known station was set.
  void count(std::vector<models::NamedCount>& out) const;

 private:
  static constexpr std::size_t kStationsMax = 8;
  static constexpr std::int64_t kGoesOnMax = 100;  ///< messages lost while a clock is set

  /// One that has beaten in this session.
  struct Station {
    std::int64_t run_id = 0;
    std::int64_t sequence = 0;  ///< newest number heard
    Time stamp{};               ///< newest time, by its own clock
    Time heard{};
    Duration ahead{};  ///< of our clock behind its own
  };
  Station* find(std::int64_t run_id);
  /// The place of a new station: a free one, or that of the one silent longest and not in charge.
  Station& place();
  [[nodiscard]] static bool is_of_now(Time stamp, Duration ahead, Time now);
  /// Follows a clock that was set; learns a new station. nullptr: not known.
  Station* learn(const models::OperatorCommand& command, Time now);

  bool is_held_ = false;
  std::int64_t in_charge_ = 0;
  Time heard_{};
  std::array<Station, kStationsMax> stations_{};
  std::size_t station_count_ = 0;
  std::int64_t handovers_ = 0;
  std::int64_t not_of_now_ = 0;
  std::int64_t clocks_set_ = 0;
};

}  // namespace vantage::drivers
