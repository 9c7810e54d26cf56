#pragma once

#include <cstdint>

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
/// What is not fresh (older or newer than `kFreshS` by the stack's clock: a log being played, a
/// network that delays) makes nothing less safe and is no heartbeat.
class OperatorAuthority {
 public:
  static constexpr double kFreshS = 2.0;
  /// True when the command may act.
  [[nodiscard]] bool admit(const models::OperatorCommand& command, Time now, double silent_s);
  /// Since the heartbeat of the station in charge; kNever before any.
  [[nodiscard]] double age_s(Time now) const;
  [[nodiscard]] std::int64_t handovers() const { return handovers_; }

 private:
  bool is_held_ = false;
  std::int64_t in_charge_ = 0;
  std::int64_t newest_sequence_ = -1;
  Time heard_{};
  std::int64_t handovers_ = 0;
};

}  // namespace vantage::drivers
