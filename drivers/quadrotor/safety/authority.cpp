#include "drivers/quadrotor/safety/authority.hpp"

#include <cmath>

#include "drivers/quadrotor/safety/inputs.hpp"

namespace vantage::drivers {

bool PlannerLease::admit(std::int64_t run_id, Time now, double lease_s) {
  if (!is_held_ || run_id == holder_ || to_seconds(now - heard_) > lease_s) {
    takeovers_ += is_held_ && run_id != holder_ ? 1 : 0;
    is_held_ = true;
    holder_ = run_id;
    heard_ = now;
    return true;
  }
  other_spoke_ = true;
  other_heard_ = now;
  return false;
}

double PlannerLease::age_s(Time now) const { return is_held_ ? to_seconds(now - heard_) : kNever; }

bool PlannerLease::is_contested(Time now, double lease_s) const {
  return other_spoke_ && to_seconds(now - other_heard_) <= lease_s;
}

bool OperatorAuthority::admit(const models::OperatorCommand& command, Time now, double silent_s) {
  using models::OperatorAction;
  const OperatorAction action = command.action;
  const bool is_fresh = std::abs(to_seconds(now - command.stamp.time)) <= kFreshS;
  const bool takes_over =
      action == OperatorAction::kHeartbeat && is_fresh &&
      (!is_held_ || (command.stamp.run_id != in_charge_ && age_s(now) > silent_s));
  if (takes_over) {
    handovers_ += is_held_ ? 1 : 0;
    is_held_ = true;
    in_charge_ = command.stamp.run_id;
    newest_sequence_ = -1;
  }
  const bool is_new = is_held_ && command.stamp.run_id == in_charge_ && is_fresh &&
                      command.stamp.sequence > newest_sequence_;
  if (is_new) {
    newest_sequence_ = command.stamp.sequence;
    heard_ = now;
  }
  const bool is_safer = action == OperatorAction::kEmergencyStop ||
                        action == OperatorAction::kHold || action == OperatorAction::kLand;
  return is_new || is_safer;
}

double OperatorAuthority::age_s(Time now) const {
  return is_held_ ? to_seconds(now - heard_) : kNever;
}

}  // namespace vantage::drivers
