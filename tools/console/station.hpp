#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::tools {

/// What one operator station may do beside others. COMMAND is open to any number of stations, and
/// an emergency stop is taken from each; so the rules are kept by the stations themselves, and
/// again by every vehicle (drivers::OperatorAuthority).
///
/// A station first listens for kListenS. Hearing no other it takes charge: it beats and may say
/// everything. Hearing another it is refused: it may only stop (emergency stop), unless it was
/// started as an allowed second one; then it may also say hold and land, and takes charge itself
/// once the other has been silent for kSilentS. Of two in charge the one with the smaller run id
/// stays. Only heartbeats of now count: a log that is played is no station.
class Station {
 public:
  static constexpr double kFreshS = 2.0;   ///< as vehicles have it
  static constexpr double kListenS = 0.7;  ///< three heartbeats
  static constexpr double kSilentS = 1.5;  ///< by then every vehicle holds

  enum class Role { kListening, kInCharge, kSecond, kRefused };

  Station(std::int64_t run_id, bool is_allowed_second, Time start)
      : run_id_(run_id), is_allowed_(is_allowed_second), start_(start) {}

  /// A command heard on COMMAND, of whatever station.
  void on_command(const models::OperatorCommand& command, Time now);
  /// Goes on in time. True when the role changed.
  bool tick(Time now);

  /// Whether what is stamped so is said now.
  [[nodiscard]] static bool is_of_now(Time stamp, Time now) {
    return std::abs(to_seconds(now - stamp)) <= kFreshS;
  }
  /// Heartbeats heard that were not of now.
  [[nodiscard]] std::int64_t ignored() const { return ignored_; }
  [[nodiscard]] Role role() const { return role_; }
  [[nodiscard]] bool beats() const { return role_ == Role::kInCharge; }
  [[nodiscard]] bool may_say(models::OperatorAction action) const;

 private:
  std::int64_t run_id_;
  bool is_allowed_;
  Time start_;
  Role role_ = Role::kListening;
  std::optional<Time> other_heard_;
  std::int64_t other_run_id_ = 0;
  std::int64_t ignored_ = 0;
};

/// What a station in that role tells its operator.
const char* explain(Station::Role role);

}  // namespace vantage::tools
