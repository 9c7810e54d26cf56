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
class OperatorDesk {
 public:
  static constexpr double kHeartbeatPeriod_s = 0.2;

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
  [[nodiscard]] std::vector<std::string> robots() const;
  /// One line for each vehicle heard, selected ones marked.
  [[nodiscard]] std::vector<std::string> vehicle_table(Time now, const std::string& selected) const;

 private:
  bus::Bus& bus_;
  Station station_;
  Time now_;
  Time next_heartbeat_{};
  std::map<std::string, models::VehicleStatus> vehicles_;
};

/// Runs the console on standard input and output until quit, end of input or `stop`. What may not
/// be said while the station still listens for others waits until it knows; an emergency stop never
/// waits. False when something that was asked was refused.
bool run_console(bus::Bus& bus, const bus::Clock& clock, bool is_allowed_second,
                 const std::function<bool()>& stop);

}  // namespace vantage::tools
