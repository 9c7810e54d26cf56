#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::tools {

/// Confirmations of orders by the vehicles' own statuses. An order is confirmed by a vehicle that
/// reports the state which the order leads to. It is refused if the vehicle reports a refusal, and
/// unconfirmed if the vehicle reports neither within kPatience. Each vehicle has one receipt, which
/// a later order replaces. While an emergency stop is awaited, only another emergency stop replaces
/// it.
class OrderReceipts {
 public:
  /// Longer than a vehicle's report period, and longer than the 0.75 s for which an emergency stop
  /// is repeated.
  static constexpr Duration kPatience = std::chrono::seconds(2);
  enum class Outcome { kAwaited, kConfirmed, kRefused, kUnconfirmed };

  struct Receipt {
    models::OperatorAction action = models::OperatorAction::kHold;
    Time sent{};
    Outcome outcome = Outcome::kAwaited;
    std::string words;  ///< the vehicle's state and reasons when the outcome was decided
  };

  /// Notes an order that was sent at `now` to these robots.
  void on_order(models::OperatorAction action, const std::vector<std::string>& robots, Time now);
  /// Notes a status that was received at `received_at`.
  void on_status(const models::VehicleStatus& status, Time received_at);
  /// Ends the receipts that were awaited for too long.
  void tick(Time now);
  /// Returns the newest receipt of each robot that was commanded.
  [[nodiscard]] const std::map<std::string, Receipt>& receipts() const { return receipts_; }

 private:
  std::map<std::string, Receipt> receipts_;
};

/// Returns "awaited", "confirmed", "refused" or "unconfirmed".
const char* name_of(OrderReceipts::Outcome outcome);

}  // namespace vantage::tools
