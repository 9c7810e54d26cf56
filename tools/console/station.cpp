#include "tools/console/station.hpp"

namespace vantage::tools {

using models::OperatorAction;

void Station::on_command(const models::OperatorCommand& command, Time now) {
  if (command.stamp.run_id == run_id_ || command.action != OperatorAction::kHeartbeat ||
      !is_current(command.stamp.time, now)) {
    return;
  }
  other_heartbeat_ = now;
  other_run_id_ = command.stamp.run_id;
}

void Station::restart(Time start) {
  start_ = start;
  role_ = Role::kListening;
}

bool Station::tick(Time now) {
  const bool is_other_active = other_heartbeat_ && to_seconds(now - *other_heartbeat_) < kSilentS;
  const Role before = role_;
  switch (role_) {
    case Role::kListening:
      if (is_other_active) {
        role_ = is_allowed_ ? Role::kSecond : Role::kRefused;
      } else if (to_seconds(now - start_) >= kListenS) {
        role_ = Role::kInCharge;
      }
      break;
    case Role::kInCharge:
      if (is_other_active && other_run_id_ < run_id_) {
        role_ = is_allowed_ ? Role::kSecond : Role::kRefused;
      }
      break;
    case Role::kSecond:
      if (!is_other_active) {
        role_ = Role::kInCharge;
      }
      break;
    case Role::kRefused:
      break;  // the refusal is permanent: the station was not started as a second station
  }
  return role_ != before;
}

bool Station::may_send(OperatorAction action) const {
  switch (action) {
    case OperatorAction::kEmergencyStop:
      return true;
    case OperatorAction::kHold:
    case OperatorAction::kLand:
      return role_ != Role::kRefused;
    case OperatorAction::kHeartbeat:
    case OperatorAction::kArm:
    case OperatorAction::kTakeOff:
    case OperatorAction::kFollow:
      return role_ == Role::kInCharge;
  }
  return false;
}

const char* explain(Station::Role role) {
  switch (role) {
    case Station::Role::kListening:
      return "listening for other stations; meanwhile only hold, land and emergency stop are sent";
    case Station::Role::kInCharge:
      return "this station is in charge";
    case Station::Role::kSecond:
      return "another station is in charge; this one can hold, land and emergency stop, and takes "
             "over when the other stops sending";
    case Station::Role::kRefused:
      return "refused: another station is in charge. Only the emergency stop works here; start "
             "with --second to run as standby";
  }
  return "";
}

}  // namespace vantage::tools
