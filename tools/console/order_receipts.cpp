#include "tools/console/order_receipts.hpp"

#include <algorithm>

namespace vantage::tools {
namespace {

using models::FlightState;
using models::OperatorAction;

/// True if `state` shows that the vehicle obeys `action`. For arming, the state shows only that the
/// vehicle is still idle.
bool shows(OperatorAction action, FlightState state) {
  switch (action) {
    case OperatorAction::kEmergencyStop:
      return state == FlightState::kKilled;
    case OperatorAction::kLand:
      return state == FlightState::kLand || state == FlightState::kIdle ||
             state == FlightState::kKilled;
    case OperatorAction::kHold:
      return state == FlightState::kHold || state == FlightState::kIdle;
    case OperatorAction::kFollow:
      return state == FlightState::kFollow;
    case OperatorAction::kTakeOff:
      return state == FlightState::kHold || state == FlightState::kFollow;
    case OperatorAction::kArm:
      return state == FlightState::kIdle;
    case OperatorAction::kHeartbeat:
      return false;
  }
  return false;
}

bool is_pending(const std::string& reason) { return reason.find("pending") != std::string::npos; }
bool is_refusal(const std::string& reason) { return reason.find("refused") != std::string::npos; }

}  // namespace

void OrderReceipts::on_order(OperatorAction action, const std::vector<std::string>& robots,
                             Time now) {
  for (const std::string& robot : robots) {
    const auto known = receipts_.find(robot);
    const bool is_stop_awaited = known != receipts_.end() &&
                                 known->second.outcome == Outcome::kAwaited &&
                                 known->second.action == OperatorAction::kEmergencyStop;
    if (!is_stop_awaited || action == OperatorAction::kEmergencyStop) {
      receipts_[robot] = {action, now, Outcome::kAwaited, ""};
    }
  }
}

void OrderReceipts::on_status(const models::VehicleStatus& status, Time received_at) {
  const auto found = receipts_.find(status.robot);
  if (found == receipts_.end() || found->second.outcome != Outcome::kAwaited ||
      received_at <= found->second.sent) {
    return;
  }
  Receipt& receipt = found->second;
  receipt.words = name_of(status.state);
  for (const std::string& reason : status.reasons) {
    receipt.words += ", " + reason;
  }
  const auto has = [&](bool (*is_it)(const std::string&)) {
    return std::any_of(status.reasons.begin(), status.reasons.end(), is_it);
  };
  const bool may_be_refused =
      receipt.action == OperatorAction::kArm || receipt.action == OperatorAction::kTakeOff;
  if (may_be_refused && has(is_refusal)) {
    receipt.outcome = Outcome::kRefused;
  } else if (shows(receipt.action, status.state) &&
             !(receipt.action == OperatorAction::kArm && has(is_pending))) {
    receipt.outcome = Outcome::kConfirmed;
  }
}

void OrderReceipts::tick(Time now) {
  for (auto& [robot, receipt] : receipts_) {
    if (receipt.outcome == Outcome::kAwaited && now - receipt.sent > kPatience) {
      receipt.outcome = Outcome::kUnconfirmed;
      receipt.words = receipt.words.empty() ? "no status received" : receipt.words;
    }
  }
}

const char* name_of(OrderReceipts::Outcome outcome) {
  constexpr const char* kNames[] = {"awaited", "confirmed", "refused", "unconfirmed"};
  return kNames[static_cast<int>(outcome)];
}

}  // namespace vantage::tools
