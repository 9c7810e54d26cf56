#pragma once

#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "scenario/scenario.hpp"
#include "tools/console/console.hpp"
#include "tools/up/flight_program.hpp"

namespace vantage::tools {

/// The operator of an unattended trial, on the bus: a FlightProgram and the station it speaks from.
class Pilot {
 public:
  /// Of all robots that a driver flies.
  /// @throws StartupError when one of them is real: a person arms it.
  Pilot(bus::Bus& bus, const scenario::Scenario& scenario, Time start);
  Pilot(const Pilot&) = delete;
  Pilot& operator=(const Pilot&) = delete;
  Pilot(Pilot&&) = delete;
  Pilot& operator=(Pilot&&) = delete;
  ~Pilot() = default;

  /// Beats and says what is due; what there is to tell the person, usually nothing.
  std::string tick(Time now);
  [[nodiscard]] FlightProgram& program() { return program_; }

 private:
  Time now_;
  OperatorDesk desk_;
  FlightProgram program_;
};

}  // namespace vantage::tools
