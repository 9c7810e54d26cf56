#pragma once

#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "tools/console/console.hpp"

namespace vantage::tools {

/// What an operator asks, said when and as it may be said: hold, land and emergency stop at once;
/// the rest once the station is in charge, one each kPace, in the order asked, and not at all when
/// something safer has been asked of the same vehicles meanwhile.
///
/// A robot that was not heard is a typing error: an emergency stop then is of everybody, hold and
/// land are said to that name and reported, anything else is refused. While the station still
/// listens robots may not have spoken yet, so that is judged when it has listened.
class OrderQueue {
 public:
  /// Vehicles take up one order in each turn of theirs.
  static constexpr Duration kPace = std::chrono::milliseconds(100);

  struct Order {
    models::OperatorAction action = models::OperatorAction::kHold;
    std::string robot;  ///< empty: all
  };

  explicit OrderQueue(OperatorDesk& desk) : desk_(desk) {}

  /// What to tell the operator, a line each.
  std::vector<std::string> ask(const Order& order, Time now);
  /// Says what has waited; to be called after each OperatorDesk::tick(). As ask().
  std::vector<std::string> tick(Time now);
  /// Whether anything asked is still to be said, or judged.
  [[nodiscard]] bool is_waiting() const { return !waiting_.empty() || !unheard_.empty(); }
  /// Whether anything asked was not said, or to nobody who was heard.
  [[nodiscard]] bool was_refused() const { return was_refused_; }

 private:
  [[nodiscard]] bool is_listening() const {
    return desk_.station().role() == Station::Role::kListening;
  }
  [[nodiscard]] bool is_heard(const std::string& robot) const;
  std::string ask_now(const Order& order, Time now);
  std::string judge_unheard(const Order& order, Time now);
  std::string say(const Order& order, Time now);
  std::string refuse(std::string words);

  OperatorDesk& desk_;
  std::vector<Order> waiting_;
  std::vector<Order> unheard_;  ///< said while listening, to names that were not heard yet
  Time next_{};
  bool was_refused_ = false;
};

}  // namespace vantage::tools
