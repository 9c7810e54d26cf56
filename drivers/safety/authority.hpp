#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "drivers/safety/inputs.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Lease that selects one of several planners of a robot. The planner that sends the first plan
/// holds the lease until it has sent nothing for the lease time. The next planner that sends a plan
/// then takes the lease; later plans of the earlier planner are refused.
class PlannerLease {
 public:
  /// True if a plan of `run_id` may be checked. The run then takes or renews the lease.
  [[nodiscard]] bool admit(std::int64_t run_id, Time now, double lease_s);
  /// Returns the time since the holder's last message, s; kNever before the first.
  [[nodiscard]] double age_s(Time now) const { return time_since_s(received_at_, now); }
  /// True if `run_id` holds the lease, or if no run does.
  [[nodiscard]] bool is_holder(std::int64_t run_id) const {
    return !received_at_ || run_id == holder_;
  }
  /// True if another run published within the last `lease_s`.
  [[nodiscard]] bool is_contested(Time now, double lease_s) const {
    return other_received_at_ && time_since_s(other_received_at_, now) <= lease_s;
  }
  [[nodiscard]] std::int64_t takeovers() const { return takeovers_; }

 private:
  std::int64_t holder_ = 0;
  std::optional<Time> received_at_;  ///< time of the holder's last message; nullopt: no holder
  std::optional<Time> other_received_at_;
  std::int64_t takeovers_ = 0;
};

/// Selection of the operator station in charge: the first station that sends a heartbeat, until it
/// has sent nothing for `silent_s`. Any station may make the vehicle safer (hold, land, emergency
/// stop). Only the station in charge may send arm, take-off and follow, and only its heartbeat
/// counts.
///
/// A command is obeyed only if its stamp is current: within kFreshS of the local clock or of the
/// clock of a known station. A station becomes known by a heartbeat that is current by the local
/// clock. If the station's clock is set later, its next heartbeat with a continuous sequence number
/// gives the new offset, so the station stays accepted. Replayed logs, delayed packets and old
/// messages of a live station are therefore refused. Hold, land and emergency stop of a known
/// station are also accepted late, if their sequence number is new.
class OperatorAuthority {
 public:
  static constexpr double kFreshS = 2.0;
  /// True if the command may be executed.
  [[nodiscard]] bool admit(const models::OperatorCommand& command, Time now, double silent_s);
  /// Returns the time since the last heartbeat of the station in charge, s; kNever before the
  /// first.
  [[nodiscard]] double age_s(Time now) const { return time_since_s(received_at_, now); }
  [[nodiscard]] std::int64_t handovers() const { return handovers_; }
  /// Appends the number of handovers, of messages refused because they were not current, and of
  /// clock changes of known stations.
  void count(std::vector<models::NamedCount>& out) const;

 private:
  static constexpr std::size_t kStationsMax = 8;
  /// maximum loss of messages while a clock is set
  static constexpr std::int64_t kLostMax = 100;

  /// Station that has sent a heartbeat in this session.
  struct Station {
    std::int64_t run_id = 0;
    std::int64_t sequence = 0;  ///< newest sequence number received
    Time stamp{};               ///< newest stamp, by the station's clock
    Time received_at{};
    Duration ahead{};  ///< lag of the local clock behind the station's clock
  };
  Station* find(std::int64_t run_id);
  /// Returns an entry for a new station: a free entry, or the entry of the station with the oldest
  /// last message. The station in charge keeps its entry.
  Station& new_station();
  [[nodiscard]] static bool is_current(Time stamp, Duration ahead, Time now);
  /// Updates the clock offset of the sender or adds a new station. Returns nullptr if the sender
  /// remains unknown.
  Station* learn(const models::OperatorCommand& command, Time now);

  std::int64_t in_charge_ = 0;
  std::optional<Time> received_at_;  ///< last message of the station in charge; nullopt: none
  std::array<Station, kStationsMax> stations_{};
  std::size_t station_count_ = 0;
  std::int64_t handovers_ = 0;
  std::int64_t not_current_ = 0;
  std::int64_t clocks_set_ = 0;
};

}  // namespace vantage::drivers
