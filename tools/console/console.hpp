#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "models/exchange/messages.hpp"
#include "tools/console/operator_input.hpp"
#include "tools/console/station.hpp"

namespace vantage::tools {

/// How a station was started.
struct DeskRules {
  bool is_allowed_second = false;  ///< Station: it stands by while another is in charge
  /// What the bus signs with, which must outlive the desk; nullptr: it signs nothing.
  const bus::auth::Authenticator* authenticator = nullptr;
};

/// The operator's end of COMMAND: sends what is asked and what its station may say, and, in charge,
/// the heartbeat whose silence makes every vehicle land. Learns the robots from VEHICLE_*.
///
/// Vehicles obey what is said now, so everything is stamped by the vehicles' own clock: where the
/// nearest of those heard in the last second differs from ours by more than kApartMaxS, by that.
/// An emergency stop is said by our own clock as well. Where statuses are refused as stale, because
/// the station's clock is wrong or a log is played, hold, land and emergency stop are also stamped
/// by their clock: a stop that is too much does no harm.
///
/// A datagram may get lost, so hold, land and emergency stop are said kSaid times: the second time
/// after kSayAgain, then after twice as long each time, which outlasts a burst of losses of half a
/// second. A repetition is the same order with the same stamp; obeying it twice does no harm. What
/// was said before any vehicle was heard is repeated by their clock. What
/// is ordered of the same vehicles later ends it, so that `hold`, `follow` ends with following; an
/// emergency stop of all gives way to no order of one.
class OperatorDesk {
 public:
  static constexpr double kHeartbeatPeriod_s = 0.2;
  static constexpr double kApartMaxS = 1.0;
  static constexpr double kLogHeardS = 3.0;
  static constexpr std::size_t kVehiclesMax = 1024;
  static constexpr double kKeptS = 3.0;  ///< a vehicle received within this keeps its place
  static constexpr int kSaid = 5;
  static constexpr Duration kSayAgain = std::chrono::milliseconds(50);

  OperatorDesk(bus::Bus& bus, const DeskRules& rules, Time start);
  OperatorDesk(const OperatorDesk&) = delete;
  OperatorDesk& operator=(const OperatorDesk&) = delete;
  OperatorDesk(OperatorDesk&&) = delete;
  OperatorDesk& operator=(OperatorDesk&&) = delete;
  ~OperatorDesk() = default;

  /// Sends the heartbeat, and says again what is to be repeated, when it is time. True when the
  /// station's role changed.
  bool tick(Time now);
  /// False, and nothing sent, when the station may not say that.
  bool send(Time now, models::OperatorAction action, const std::string& robot);
  /// Whether something is still to be said again.
  [[nodiscard]] bool is_saying() const { return !saying_.empty(); }
  /// Others sign what they say, and this station does not: who requires it does not hear it.
  [[nodiscard]] bool is_unheard() const { return bus_.hears_signed(); }
  [[nodiscard]] const Station& station() const { return station_; }
  /// By how much the vehicles' clock is ahead of ours; 0 when it is about the same, or unknown.
  [[nodiscard]] Duration vehicles_ahead(Time now) const;
  [[nodiscard]] std::vector<std::string> robots() const;
  /// Whether somebody who records has said within kLogHeardS that he cannot.
  [[nodiscard]] bool is_log_lost(Time now) const;
  /// One line for each vehicle heard, selected ones marked; what has not been
  /// heard for a second is SILENT, whatever it said last. One more when a log is not written.
  [[nodiscard]] std::vector<std::string> vehicle_table(Time now, const std::string& selected) const;

 private:
  struct Order {
    models::OperatorAction action = models::OperatorAction::kHold;
    std::string robot;
    Time given{};
    std::optional<Duration> ahead;  ///< of the vehicles' clock, once any was heard
    int said = 0;
    Time next{};
  };
  [[nodiscard]] std::optional<Duration> ahead_of(Time now) const;
  void say(const Order& order);
  void say_again(Time now);
  [[nodiscard]] static bool ends(const Order& later, const Order& earlier);
  void publish(Time stamp, models::OperatorAction action, const std::string& robot);
  /// Whether one more vehicle has a place, if need be that of one that fell silent.
  bool make_room();

  static constexpr std::size_t kLogsMax = 64;  ///< processes that report a log
  std::vector<Order> saying_;
  bus::Bus& bus_;
  const bus::auth::Authenticator* authenticator_;
  Station station_;
  Time now_;
  Time next_heartbeat_{};
  struct Heard {
    models::VehicleStatus status;
    Time at{};
  };
  std::map<std::string, Heard> vehicles_;
  std::map<std::string, Time> log_lost_;  ///< who said last that it is not written, and when
};

/// Runs the console on standard input and output until quit, end of input or `stop`; orders are
/// sent as an OrderQueue sends them. In each round heartbeat and orders leave before the screen is
/// drawn, and no output waits (NonBlockingOutput). False when a request was refused or not
/// understood.
bool run_console(bus::Bus& bus, const bus::Clock& clock, const DeskRules& rules,
                 const std::function<bool()>& stop);

}  // namespace vantage::tools
