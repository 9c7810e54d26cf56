#include "tools/console/console.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/utf8.hpp"
#include "logs/record/log_space.hpp"
#include "logs/record/recorder.hpp"
#include "tools/console/order_queue.hpp"
#include "tools/console/terminal.hpp"
#include "tools/live/output.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

constexpr const char* kKeys =
    "keys: SPACE emergency stop of ALL;  selected robots: a arm  t take off  f follow  h hold  "
    "l land  e emergency stop;  select: 0 all  1-9 TAB one robot  r NAME ENTER any robot;  q quit";
constexpr const char* kLines =
    "type: arm | take-off | follow | hold | land | estop [robot], help, quit";
constexpr const char* kLacksSignature =
    "vehicles that require signed commands ignore this station: it does not sign; start it with "
    "--scenario FILE";
constexpr const char* kFarewell =
    "quitting: the operator heartbeat stops now; vehicles that need it will land";

/// One run of the console: reads input, sends orders and shows the vehicles.
class ConsoleSession {
 public:
  ConsoleSession(bus::Bus& bus, const bus::Clock& clock, const StationOptions& options)
      : sender_(bus, options, clock.now()), clock_(clock) {
    print_line(terminal_.is_interactive() ? kKeys : kLines);
  }

  void step() {
    if (sender_.tick(clock_.now())) {
      show(explain(sender_.station().role()));
    }
    show(orders_.tick(clock_.now()));
    if (sender_.lacks_signature() && !std::exchange(has_warned_, true)) {
      show(kLacksSignature);
    }
    while (!is_over_) {
      const std::optional<std::string> input = terminal_.read();
      if (!input) {
        break;
      }
      handle(*input);
    }
    is_over_ |= terminal_.is_closed();
    if (terminal_.is_interactive() && clock_.now() >= next_redraw_) {
      std::vector<std::string> lines = sender_.vehicle_table(clock_.now(), selected_);
      lines.push_back(keys_.prompt().empty() ? note_ : keys_.prompt());
      screen_.redraw(lines);
      next_redraw_ = clock_.now() + std::chrono::milliseconds(250);
    }
  }
  /// Sends the repetitions that are due.
  void finish() { sender_.tick(clock_.now()); }
  [[nodiscard]] bool is_repeating() const { return sender_.is_repeating(); }
  [[nodiscard]] bool is_over() const { return is_over_ && !orders_.is_waiting(); }
  [[nodiscard]] bool was_refused() const { return was_refused_ || orders_.was_refused(); }

 private:
  void handle(const std::string& input) {
    if (terminal_.is_interactive()) {
      const bool was_typing = !keys_.prompt().empty();
      if (const auto request = keys_.on_key(input, sender_.robots(), selected_)) {
        handle(*request);
      } else if (!was_typing && keys_.prompt().empty()) {
        show("unknown key; ? lists the keys");
      }
      next_redraw_ = {};
      return;
    }
    if (input.find_first_not_of(" \t\r") == std::string::npos) {
      return;
    }
    const Result<OperatorRequest> request = request_from_line(input);
    if (request.ok()) {
      handle(request.value());
    } else {
      was_refused_ = true;
      show(request.error().message);
    }
  }

  void handle(const OperatorRequest& request) {
    switch (request.kind) {
      case OperatorRequest::Kind::kCommand:
        show(orders_.add({request.action, request.robot}, clock_.now()));
        break;
      case OperatorRequest::Kind::kSelect:
        selected_ = request.robot;
        show("commands go to " + (selected_.empty() ? std::string("all") : selected_));
        break;
      case OperatorRequest::Kind::kNoRobot:
        show("no robot, or more than one, has a name that begins with '" + request.robot +
             "'; commands still go to " + (selected_.empty() ? std::string("all") : selected_));
        break;
      case OperatorRequest::Kind::kHelp:
        show(terminal_.is_interactive() ? kKeys : kLines);
        break;
      case OperatorRequest::Kind::kQuit:
        is_over_ = true;
        break;
    }
  }

  void show(const std::vector<std::string>& lines) {
    for (const std::string& words : lines) {
      show(words);
    }
  }

  void show(const std::string& words) {
    note_ = words;
    if (!terminal_.is_interactive()) {
      print_line(words);
    }
  }

  OrderSender sender_;
  OrderQueue orders_{sender_};
  const bus::Clock& clock_;
  Terminal terminal_;
  KeyInput keys_;
  Screen screen_;
  std::string selected_;
  std::string note_;
  bool was_refused_ = false;  // an input line could not be parsed
  bool has_warned_ = false;
  Time next_redraw_{};
  bool is_over_ = false;
};

}  // namespace

OrderSender::OrderSender(bus::Bus& bus, const StationOptions& options, Time start)
    : bus_(bus),
      authenticator_(options.authenticator),
      station_(bus.run_id(), options.is_allowed_second, start),
      now_(start) {
  bus_.subscribe<models::OperatorCommand>(
      bus::kCommand, [this](const models::OperatorCommand& command) {
        station_.on_command(command, now_ + vehicles_ahead(now_));
      });
  bus_.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"),
                                        [this](const models::VehicleStatus& status) {
                                          if (vehicles_.contains(status.robot) || make_room()) {
                                            vehicles_[status.robot] = {status, now_};
                                          }
                                        });
  const auto on_log = [this](const models::ProcessHealth& health) {
    const bool is_lost = std::any_of(
        health.counters.begin(), health.counters.end(), [](const models::NamedCount& counter) {
          return counter.name == "log.is_written" && counter.count == 0;
        });
    if (!is_lost) {
      log_lost_.erase(health.process);
    } else if (log_lost_.contains(health.process) || log_lost_.size() < kLogsMax) {
      log_lost_[health.process] = now_;
    }
  };
  bus_.subscribe<models::ProcessHealth>(bus::health_channel(logs::kLogHealth), on_log);
  bus_.subscribe<models::ProcessHealth>(bus::health_channel(logs::RecorderNode::kName), on_log);
}

bool OrderSender::make_room() {
  if (vehicles_.size() < kVehiclesMax) {
    return true;
  }
  const auto quietest =
      std::min_element(vehicles_.begin(), vehicles_.end(),
                       [](const auto& a, const auto& b) { return a.second.at < b.second.at; });
  if (to_seconds(now_ - quietest->second.at) <= kKeptS) {
    return false;
  }
  vehicles_.erase(quietest);
  return true;
}

bool OrderSender::set_attended(bool is_attended, Time now) {
  if (is_attended == is_attended_) {
    return false;
  }
  is_attended_ = is_attended;
  station_.restart(now);
  return true;
}

bool OrderSender::tick(Time now) {
  now_ = now;
  const bool changed = is_attended_ && station_.tick(now);
  repeat(now);
  if (is_attended_ && station_.sends_heartbeat() && now >= next_heartbeat_) {
    send(now, models::OperatorAction::kHeartbeat, "");
    next_heartbeat_ = now + from_seconds(kHeartbeatPeriod_s);
  }
  return changed;
}

bool OrderSender::send(Time now, models::OperatorAction action, const std::string& robot) {
  if (!station_.may_send(action)) {
    return false;
  }
  Order order{action, robot, now, ahead_of(now), 1, now + kFirstPause};
  publish_order(order);
  if (action != models::OperatorAction::kHeartbeat) {
    std::erase_if(repeating_, [&order](const Order& earlier) { return ends(order, earlier); });
  }
  if (models::makes_safer(action)) {
    repeating_.push_back(order);
  }
  return true;
}

void OrderSender::publish_order(const Order& order) {
  const Duration ahead = order.ahead.value_or(Duration{});
  publish(order.given + ahead, order.action, order.robot);
  if (order.action == models::OperatorAction::kEmergencyStop && ahead != Duration{}) {
    publish(order.given, order.action, order.robot);
  }
  const std::optional<Duration> stale =
      authenticator_ == nullptr ? std::nullopt : authenticator_->stale_ahead(now_);
  if (stale && models::makes_safer(order.action)) {
    publish(order.given + *stale, order.action, order.robot);
  }
}

void OrderSender::repeat(Time now) {
  for (Order& order : repeating_) {
    if (now >= order.next) {
      // The offset was unknown if no vehicle status had been received.
      order.ahead = order.ahead ? order.ahead : ahead_of(now);
      publish_order(order);
      order.next += kFirstPause * (1 << order.sent);
      ++order.sent;
    }
  }
  std::erase_if(repeating_, [](const Order& order) { return order.sent >= kTransmissions; });
}

bool OrderSender::ends(const Order& later, const Order& earlier) {
  const bool is_of_all_its_vehicles = later.robot.empty() || later.robot == earlier.robot;
  const bool undoes = !models::makes_safer(later.action) &&
                      earlier.action != models::OperatorAction::kEmergencyStop;
  // An order to all vehicles that was revoked for one vehicle is not repeated, because the
  // repetition would cancel the revocation.
  return is_of_all_its_vehicles || (undoes && earlier.robot.empty());
}

void OrderSender::publish(Time stamp, models::OperatorAction action, const std::string& robot) {
  models::OperatorCommand command;
  command.stamp.time = stamp;
  command.action = action;
  command.robot = robot;
  bus_.publish(bus::kCommand, command);
}

std::optional<Duration> OrderSender::ahead_of(Time now) const {
  std::optional<Duration> least;
  for (const auto& [name, received] : vehicles_) {
    const Duration ahead = received.status.stamp.time - received.at;
    const bool is_recent = to_seconds(now - received.at) <= kSilentAfterS;
    if (is_recent && (!least || std::chrono::abs(ahead) < std::chrono::abs(*least))) {
      least = ahead;
    }
  }
  return least && std::abs(to_seconds(*least)) <= kApartMaxS ? Duration{} : least;
}

Duration OrderSender::vehicles_ahead(Time now) const { return ahead_of(now).value_or(Duration{}); }

bool OrderSender::is_log_lost(Time now) const {
  return std::any_of(log_lost_.begin(), log_lost_.end(), [now](const auto& report) {
    return to_seconds(now - report.second) <= kLogReportS;
  });
}

std::vector<std::string> OrderSender::robots() const {
  std::vector<std::string> out;
  for (const auto& [name, received] : vehicles_) {
    out.push_back(name);
  }
  return out;
}

std::string OrderSender::without_effect(Time now, models::OperatorAction action,
                                        const std::string& robot) const {
  std::map<std::string, std::vector<std::string>> robots_by_reason;
  for (const auto& [name, received] : vehicles_) {
    const bool is_recent = to_seconds(now - received.at) <= kSilentAfterS;
    if (!is_recent || (!robot.empty() && robot != name)) {
      continue;
    }
    if (const std::string_view reason = obstacle(action, received.status.state); !reason.empty()) {
      robots_by_reason[std::string(reason)].push_back(readable(name));
    }
  }
  std::string out;
  for (const auto& [reason, robots] : robots_by_reason) {
    out += fmt::format("{}no effect on {}: {}", out.empty() ? "" : "; ", fmt::join(robots, ", "),
                       reason);
  }
  return out;
}

std::vector<std::string> OrderSender::vehicle_table(Time now, const std::string& selected) const {
  std::vector<std::string> out;
  out.push_back(fmt::format("  {:<8} {:>8} {:>8} {:>8} {:>7}  {}", "robot", "state", "battery",
                            "round", "age", "reasons"));
  for (const auto& [name, received] : vehicles_) {
    const models::VehicleStatus& status = received.status;
    std::string reasons;
    for (const std::string& reason : status.reasons) {
      reasons += (reasons.empty() ? "" : ", ") + readable(reason);
    }
    const bool is_silent = to_seconds(now - received.at) > kSilentAfterS;
    const bool is_selected = selected.empty() || selected == name;
    out.push_back(fmt::format(
        "{} {:<8} {:>8} {:>6.0f} % {:>8} {:>5.1f} s  {}", is_selected ? '>' : ' ', readable(name),
        is_silent ? "SILENT" : name_of(status.state), 100.0 * status.battery_share,
        models::round_text(status.plan_round), to_seconds(now - received.at), reasons));
  }
  if (vehicles_.empty()) {
    out.emplace_back("  no vehicle status received yet");
  }
  if (authenticator_ != nullptr) {
    if (const auto stale = authenticator_->stale_ahead(now)) {
      out.push_back(fmt::format(
          "! vehicle statuses refused: {:.1f} s ahead of this station's clock; a log is "
          "played, or the clocks differ (vehicles with refused statuses obey only hold, land and "
          "emergency stop)",
          to_seconds(*stale)));
    }
  }
  if (lacks_signature()) {
    out.push_back(std::string("! ") + kLacksSignature);
  }
  if (is_log_lost(now)) {
    out.emplace_back("! the log is not being written: this flight is not recorded");
  }
  return out;
}

bool run_console(bus::Bus& bus, const bus::Clock& clock, const StationOptions& options,
                 const std::function<bool()>& stop) {
  bool was_refused = false;
  {
    const NonBlockingOutput output;
    ConsoleSession session(bus, clock, options);
    while (!session.is_over() && !stop()) {
      bus.handle(std::chrono::milliseconds(20));
      session.step();
    }
    while (session.is_repeating()) {
      bus.handle(std::chrono::milliseconds(20));
      session.finish();
    }
    was_refused = session.was_refused();
  }
  print_line(kFarewell);
  return !was_refused;
}

}  // namespace vantage::tools
