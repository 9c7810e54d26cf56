#include "tools/console/operator_desk.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/random.h>

#include "core/check.hpp"
#include "core/utf8.hpp"

namespace vantage::tools {
namespace {

using Json = nlohmann::json;
using models::OperatorAction;

constexpr std::array kActions{OperatorAction::kArm,    OperatorAction::kTakeOff,
                              OperatorAction::kFollow, OperatorAction::kHold,
                              OperatorAction::kLand,   OperatorAction::kEmergencyStop};

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

DeskAnswer refuse(int code, const std::string& why) { return {code, text_of({{"error", why}})}; }

/// Returns the order in a request; an Error states what is wrong with it.
Result<OrderQueue::Order> order_of(std::string_view body) {
  constexpr std::size_t kNameBytesMax = 64;
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || !json.contains("action") || !json["action"].is_string() ||
      !json.contains("robot") || !json["robot"].is_string()) {
    return Error{"an order is {\"action\": WORD, \"robot\": NAME or \"\" for all}"};
  }
  const auto action = json["action"].get<std::string>();
  const auto robot = json["robot"].get<std::string>();
  if (robot.size() > kNameBytesMax || action.find(' ') != std::string::npos) {
    return Error{"the robot's name is too long, or the action is not one word"};
  }
  const Result<OperatorRequest> request = request_from_line(action);
  if (!request.ok()) {
    return request.error();
  }
  if (request.value().kind != OperatorRequest::Kind::kCommand) {
    return Error{"'" + action +
                 "' is not an order: use arm, take-off, follow, hold, land or estop"};
  }
  return OrderQueue::Order{request.value().action, robot};
}

Json vehicle_json(const OrderSender::ReceivedStatus& received, Time now) {
  const models::VehicleStatus& status = received.status;
  Json reasons = Json::array();
  for (const std::string& reason : status.reasons) {
    reasons.push_back(readable(reason));
  }
  Json obstacles = Json::object();
  for (const OperatorAction action : kActions) {
    if (const std::string_view why = obstacle(action, status.state); !why.empty()) {
      obstacles[word_for(action)] = std::string(why);
    }
  }
  const double age_s = to_seconds(now - received.at);
  return {{"robot", readable(status.robot)},
          {"state", name_of(status.state)},
          {"battery_share", status.battery_share},
          {"round", models::round_text(status.plan_round)},
          {"age_s", age_s},
          {"is_silent", age_s > OrderSender::kSilentAfterS},
          {"reasons", std::move(reasons)},
          {"obstacles", std::move(obstacles)}};
}

}  // namespace

std::string new_secret() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw StartupError("the system has no random numbers for the operator page's key");
  }
  std::string out;
  for (const unsigned char byte : bytes) {
    out += fmt::format("{:02x}", byte);
  }
  return out;
}

OperatorDesk::OperatorDesk(OperatorLink& link, std::string key)
    : link_(link),
      key_(std::move(key)),
      start_(link.clock().now()),
      sender_(link.bus(), {false, link.authenticator()}, start_),
      thread_([this] { run(); }) {}

OperatorDesk::~OperatorDesk() {
  is_over_ = true;
  thread_.join();
}

std::string OperatorDesk::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void OperatorDesk::run() {
  try {
    sender_.set_attended(false, link_.clock().now());
    while (!is_over_) {
      link_.bus().handle(std::chrono::milliseconds(20));
      step();
    }
    while (sender_.is_repeating()) {
      link_.bus().handle(std::chrono::milliseconds(20));
      sender_.tick(link_.clock().now());
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.what();
  }
}

std::vector<std::string> OperatorDesk::robots_of(const std::string& robot) const {
  // If the name is unknown, OrderQueue sends an emergency stop to all vehicles. Any other order
  // with this name reaches no vehicle.
  return sender_.vehicles().contains(robot) ? std::vector<std::string>{robot} : sender_.robots();
}

void OperatorDesk::note(const std::vector<std::string>& lines, Time now) {
  for (const std::string& words : lines) {
    journal_.push_back({++lines_, to_seconds(now - start_), words});
    if (journal_.size() > kJournalMax) {
      journal_.pop_front();
    }
  }
}

void OperatorDesk::send_pending(Time now) {
  std::vector<OrderQueue::Order> pending;
  {
    const std::lock_guard lock(mutex_);
    pending.swap(pending_);
  }
  for (const OrderQueue::Order& order : pending) {
    note(orders_.add(order, now), now);
    const bool is_known = order.robot.empty() || sender_.vehicles().contains(order.robot);
    if (is_known || order.action == OperatorAction::kEmergencyStop) {
      receipts_.on_order(order.action, robots_of(order.robot), now);
    }
  }
}

void OperatorDesk::step() {
  const Time now = link_.clock().now();
  const bool is_attended = [&] {
    const std::lock_guard lock(mutex_);
    return claim_.is_held(now);
  }();
  if (sender_.set_attended(is_attended, now)) {
    note({is_attended ? "a page operates" : "no page operates: the heartbeat has ended"}, now);
  }
  if (sender_.tick(now) && is_attended) {
    note({explain(sender_.station().role())}, now);
  }
  send_pending(now);
  note(orders_.tick(now), now);
  for (const auto& [robot, received] : sender_.vehicles()) {
    receipts_.on_status(received.status, received.at);
  }
  receipts_.tick(now);
  write_state(now);
}

void OperatorDesk::write_state(Time now) {
  constexpr const char* kRoles[] = {"listening", "in charge", "standby", "refused"};
  const Station::Role role = sender_.station().role();
  Json vehicles = Json::array();
  for (const auto& [robot, received] : sender_.vehicles()) {
    vehicles.push_back(vehicle_json(received, now));
  }
  Json receipts = Json::object();
  for (const auto& [robot, receipt] : receipts_.receipts()) {
    receipts[readable(robot)] = {{"action", word_for(receipt.action)},
                                 {"outcome", name_of(receipt.outcome)},
                                 {"words", readable(receipt.words)},
                                 {"age_s", to_seconds(now - receipt.sent)}};
  }
  Json journal = Json::array();
  for (const Line& line : journal_) {
    journal.push_back(
        {{"number", line.number}, {"at_s", line.at_s}, {"words", readable(line.words)}});
  }
  std::string text = text_of({{"role", kRoles[static_cast<int>(role)]},
                              {"words", explain(role)},
                              {"lacks_signature", sender_.lacks_signature()},
                              {"is_log_lost", sender_.is_log_lost(now)},
                              {"vehicles", std::move(vehicles)},
                              {"receipts", std::move(receipts)},
                              {"journal", std::move(journal)}});
  const std::lock_guard lock(mutex_);
  state_ = std::move(text);
}

DeskAnswer OperatorDesk::order(std::string_view token, std::string_view body, Time now) {
  const Result<OrderQueue::Order> order = order_of(body);
  if (!order.ok()) {
    return refuse(400, order.error().message);
  }
  const bool is_stop = order.value().action == OperatorAction::kEmergencyStop;
  if (!is_stop && !claim_.touch(token, now)) {
    return refuse(409, "not sent: another page operates, or this page's claim has ended");
  }
  if (is_stop) {
    // An emergency stop is never refused because of a full queue: it replaces the waiting orders.
    std::erase_if(pending_, [&](const OrderQueue::Order& earlier) {
      return order.value().robot.empty() || earlier.robot == order.value().robot;
    });
    pending_.push_back(order.value());
  } else if (pending_.size() >= kPendingMax) {
    return refuse(429, "not sent: too many orders at once");
  } else {
    pending_.push_back(order.value());
  }
  return {200, "{}"};
}

DeskAnswer OperatorDesk::answer(std::string_view what, std::string_view key, std::string_view token,
                                std::string_view body) {
  if (!is_same_secret(key, key_)) {
    return refuse(403, "wrong key: open the address that `vantage view --operate` has printed");
  }
  if (body.size() > kBodyBytesMax) {
    return refuse(400, "the request is too long");
  }
  const Time now = link_.clock().now();
  if (what == "claim") {
    std::string secret = new_secret();
    const std::lock_guard lock(mutex_);
    if (!claim_.claim(secret, now)) {
      return refuse(409, "another page operates; this page can only send the emergency stop");
    }
    return {200, text_of({{"token", secret}})};
  }
  const std::lock_guard lock(mutex_);
  if (what == "state") {
    const bool is_operator = claim_.touch(token, now);
    return {200, std::string(is_operator ? R"({"is_operator":true,"station":)"
                                         : R"({"is_operator":false,"station":)") +
                     state_ + "}"};
  }
  if (what == "order") {
    return order(token, body, now);
  }
  if (what == "release") {
    claim_.release(token);
    return {200, "{}"};
  }
  return refuse(400, "unknown request");
}

}  // namespace vantage::tools
