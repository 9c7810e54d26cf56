#pragma once

#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "scenario/scenario.hpp"
#include "tools/console/console.hpp"
#include "tools/up/flight_program.hpp"

namespace vantage::tools {

/// Operator of an unattended trial: connects a FlightProgram to the bus by an operator station.
class Pilot {
 public:
  /// Commands all robots that have a driver.
  /// @throws StartupError if one of these robots is real: only a person may arm it.
  Pilot(bus::Bus& bus, const scenario::Scenario& scenario, Time start);
  Pilot(const Pilot&) = delete;
  Pilot& operator=(const Pilot&) = delete;
  Pilot(Pilot&&) = delete;
  Pilot& operator=(Pilot&&) = delete;
  ~Pilot() = default;

  /// Sends the heartbeat and the orders that are due. Returns a message for the user, usually
  /// empty.
  std::string tick(Time now);
  [[nodiscard]] FlightProgram& program() { return program_; }

 private:
  Time now_;
  OrderSender sender_;
  FlightProgram program_;
};

}  // namespace vantage::tools
