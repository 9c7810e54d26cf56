#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::tools {

/// Role of one operator station among several. Any number of stations may publish on COMMAND, and
/// vehicles accept an emergency stop from each station. Stations follow the rules below, and
/// vehicles enforce them (drivers::OperatorAuthority).
///
/// A station first listens for kListenS. If no heartbeat of another station arrives, it takes
/// charge: it sends heartbeats and may send every order. If one arrives, the station is refused and
/// may only send the emergency stop.
///
/// An allowed second station may also send hold and land. It takes charge after kSilentS without a
/// heartbeat of the other station. If two stations are in charge, the station with the smaller run
/// id stays in charge. Only recent heartbeats count, so that a played log is not mistaken for a
/// station.
class Station {
 public:
  static constexpr double kFreshS = 2.0;   ///< s; equal to drivers::OperatorAuthority::kFreshS
  static constexpr double kListenS = 0.7;  ///< s; longer than three heartbeat periods
  /// s; longer than the time without a heartbeat after which every vehicle holds
  static constexpr double kSilentS = 1.5;

  enum class Role { kListening, kInCharge, kSecond, kRefused };

  Station(std::int64_t run_id, bool is_allowed_second, Time start)
      : run_id_(run_id), is_allowed_(is_allowed_second), start_(start) {}

  /// Handles a command received on COMMAND, from any station.
  void on_command(const models::OperatorCommand& command, Time now);
  /// Begins again by listening, after the operator has left and returned.
  void restart(Time start);
  /// Updates the role. Returns true if it changed.
  bool tick(Time now);

  /// True if `stamp` is within kFreshS of `now`.
  [[nodiscard]] static bool is_current(Time stamp, Time now) {
    return std::abs(to_seconds(now - stamp)) <= kFreshS;
  }
  [[nodiscard]] Role role() const { return role_; }
  [[nodiscard]] bool sends_heartbeat() const { return role_ == Role::kInCharge; }
  [[nodiscard]] bool may_send(models::OperatorAction action) const;

 private:
  std::int64_t run_id_;
  bool is_allowed_;
  Time start_;
  Role role_ = Role::kListening;
  std::optional<Time> other_heartbeat_;
  std::int64_t other_run_id_ = 0;
};

/// Returns the sentence that explains a role to the operator.
const char* explain(Station::Role role);

}  // namespace vantage::tools
