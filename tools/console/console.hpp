#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "models/exchange/messages.hpp"
#include "tools/console/operator_input.hpp"
#include "tools/console/station.hpp"

namespace vantage::tools {

/// The operator's end of COMMAND: sends what is asked and what its station may say, and, in charge,
/// the heartbeat whose silence makes every vehicle land. Learns the robots from QUADROTOR_*.
///
/// Vehicles obey what is said now, so everything is stamped by the vehicles' own clock: where the
/// nearest of those heard in the last second differs from ours by more than kApartMaxS, by that.
/// An emergency stop is said by our own clock as well.
class OperatorDesk {
 public:
  static constexpr double kHeartbeatPeriod_s = 0.2;
  static constexpr double kApartMaxS = 1.0;

  OperatorDesk(bus::Bus& bus, bool is_allowed_second, Time start);
  OperatorDesk(const OperatorDesk&) = delete;
  OperatorDesk& operator=(const OperatorDesk&) = delete;
  OperatorDesk(OperatorDesk&&) = delete;
  OperatorDesk& operator=(OperatorDesk&&) = delete;
  ~OperatorDesk() = default;

  /// Sends the heartbeat when it is time. True when the station's role changed.
  bool tick(Time now);
  /// False, and nothing sent, when the station may not say that.
  bool send(Time now, models::OperatorAction action, const std::string& robot);
  [[nodiscard]] const Station& station() const { return station_; }
  /// By how much the vehicles' clock is ahead of ours; 0 when it is about the same, or unknown.
  [[nodiscard]] Duration vehicles_ahead(Time now) const;
  [[nodiscard]] std::vector<std::string> robots() const;
  /// One line for each vehicle heard, selected ones marked.
  [[nodiscard]] std::vector<std::string> vehicle_table(Time now, const std::string& selected) const;

 private:
  void publish(Time stamp, models::OperatorAction action, const std::string& robot);

  bus::Bus& bus_;
  Station station_;
  Time now_;
  Time next_heartbeat_{};
  struct Heard {
    models::VehicleStatus status;
    Time at{};
  };
  std::map<std::string, Heard> vehicles_;
};

/// Runs the console on standard input and output until quit, end of input or `stop`. What may not
/// be said while the station still listens for others waits until it knows; an emergency stop never
/// waits. False when something that was asked was refused.
bool run_console(bus::Bus& bus, const bus::Clock& clock, bool is_allowed_second,
                 const std::function<bool()>& stop);

}  // namespace vantage::tools
