#include "tools/console/order_queue.hpp"

#include <algorithm>
#include <utility>

#include "tools/console/operator_input.hpp"

namespace vantage::tools {

using models::OperatorAction;

bool OrderQueue::is_known(const std::string& robot) const {
  const std::vector<std::string> robots = sender_.robots();
  return robot.empty() || std::find(robots.begin(), robots.end(), robot) != robots.end();
}

std::string OrderQueue::refuse(std::string words) {
  was_refused_ = true;
  return words;
}

std::string OrderQueue::send(const Order& order, Time now) {
  if (!sender_.send(now, order.action, order.robot)) {
    return refuse(std::string("not sent: ") + explain(sender_.station().role()));
  }
  const std::string ignored = sender_.without_effect(now, order.action, order.robot);
  return "sent " + word_for(order.action) + " to " + (order.robot.empty() ? "all" : order.robot) +
         (ignored.empty() ? "" : "; " + ignored);
}

std::string OrderQueue::check_unknown(const Order& order, Time now) {
  if (is_known(order.robot)) {
    return {};
  }
  if (order.action == OperatorAction::kEmergencyStop) {
    return send({order.action, ""}, now) + ": no message received from robot '" + order.robot + "'";
  }
  return refuse("no message received from robot '" + order.robot + "': " + word_for(order.action) +
                " was sent anyway");
}

std::string OrderQueue::send_at_once(const Order& order, Time now) {
  std::erase_if(waiting_, [&order](const Order& earlier) {
    return order.robot.empty() || order.robot == earlier.robot;
  });
  // A waiting order to all vehicles would cancel this order, so this order is sent again
  // afterwards.
  if (std::any_of(waiting_.begin(), waiting_.end(),
                  [](const Order& earlier) { return earlier.robot.empty(); })) {
    waiting_.push_back(order);
  }
  if (is_known(order.robot) || !sender_.station().may_send(order.action)) {
    return send(order, now);
  }
  if (is_listening()) {
    unknown_.push_back(order);
    return send(order, now);
  }
  if (order.action != OperatorAction::kEmergencyStop) {
    send(order, now);
  }
  return check_unknown(order, now);
}

std::vector<std::string> OrderQueue::add(const Order& order, Time now) {
  if (models::makes_safer(order.action)) {
    return {send_at_once(order, now)};
  }
  waiting_.push_back(order);
  return tick(now);
}

std::vector<std::string> OrderQueue::tick(Time now) {
  std::vector<std::string> out;
  if (is_listening()) {
    return out;
  }
  for (const Order& order : std::exchange(unknown_, {})) {
    if (std::string words = check_unknown(order, now); !words.empty()) {
      out.push_back(std::move(words));
    }
  }
  while (!waiting_.empty() && now >= next_) {
    const Order order = waiting_.front();
    waiting_.erase(waiting_.begin());
    const bool may_exist = is_known(order.robot) || sender_.robots().empty();
    out.push_back(may_exist ? send(order, now)
                            : refuse("unknown robot '" + order.robot + "': not sent"));
    next_ = now + kPace;
  }
  return out;
}

}  // namespace vantage::tools
