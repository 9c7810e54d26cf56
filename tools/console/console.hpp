#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "models/exchange/messages.hpp"
#include "tools/console/operator_input.hpp"

namespace vantage::tools {

/// The operator's end of COMMAND: sends what is asked, and the heartbeat whose silence makes every
/// vehicle land. Learns the robots from QUADROTOR_*.
class OperatorDesk {
 public:
  static constexpr double kHeartbeatPeriod_s = 0.2;

  explicit OperatorDesk(bus::Bus& bus);
  OperatorDesk(const OperatorDesk&) = delete;
  OperatorDesk& operator=(const OperatorDesk&) = delete;
  OperatorDesk(OperatorDesk&&) = delete;
  OperatorDesk& operator=(OperatorDesk&&) = delete;
  ~OperatorDesk() = default;

  /// Sends the heartbeat when it is time.
  void tick(Time now);
  void send(Time now, models::OperatorAction action, const std::string& robot);
  [[nodiscard]] std::vector<std::string> robots() const;
  /// One line for each vehicle heard, selected ones marked.
  [[nodiscard]] std::vector<std::string> vehicle_table(Time now, const std::string& selected) const;

 private:
  bus::Bus& bus_;
  Time next_heartbeat_{};
  std::map<std::string, models::VehicleStatus> vehicles_;
};

/// Runs the console on standard input and output until quit, end of input or `stop`.
void run_console(bus::Bus& bus, const bus::Clock& clock, const std::function<bool()>& stop);

}  // namespace vantage::tools
