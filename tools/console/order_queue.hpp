#pragma once

#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "tools/console/console.hpp"

namespace vantage::tools {

/// Queue of an operator's orders. Hold, land and emergency stop are sent immediately. Other orders
/// wait until the station has listened for other stations, and are then sent in sequence, one per
/// kPace. Hold, land and emergency stop remove waiting orders to the same vehicles.
///
/// If no message of a robot was ever received, its name in an order is assumed to be a typing
/// error. An emergency stop then goes to all vehicles, hold and land are sent to that name and
/// reported, and other orders are refused. The queue decides this only after the station has
/// listened, because a robot may not have published before that time.
class OrderQueue {
 public:
  /// Time between two orders: a vehicle processes one order per cycle.
  static constexpr Duration kPace = std::chrono::milliseconds(100);

  struct Order {
    models::OperatorAction action = models::OperatorAction::kHold;
    std::string robot;  ///< robot to command; empty: all robots
  };

  explicit OrderQueue(OrderSender& sender) : sender_(sender) {}

  /// Sends or queues an order. Returns the lines to show to the operator.
  std::vector<std::string> add(const Order& order, Time now);
  /// Sends waiting orders that are due. Call after each OrderSender::tick(). Returns the lines to
  /// show to the operator.
  std::vector<std::string> tick(Time now);
  /// True while orders wait to be sent, or names wait to be checked.
  [[nodiscard]] bool is_waiting() const { return !waiting_.empty() || !unknown_.empty(); }
  /// True if an order was not sent, or was sent to a robot from which no message was ever received.
  [[nodiscard]] bool was_refused() const { return was_refused_; }

 private:
  [[nodiscard]] bool is_listening() const {
    return sender_.station().role() == Station::Role::kListening;
  }
  [[nodiscard]] bool is_known(const std::string& robot) const;
  std::string send_at_once(const Order& order, Time now);
  std::string check_unknown(const Order& order, Time now);
  std::string send(const Order& order, Time now);
  std::string refuse(std::string words);

  OrderSender& sender_;
  std::vector<Order> waiting_;
  std::vector<Order> unknown_;  ///< orders sent while listening, to unknown robots
  Time next_{};
  bool was_refused_ = false;
};

}  // namespace vantage::tools
