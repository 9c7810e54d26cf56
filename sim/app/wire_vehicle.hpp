#pragma once

#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "sim/vehicle.hpp"

namespace vantage::sim {

/// A robot of the scenario whose device is `wire`: its truth is the state of an emulated device on
/// a UDP wire, which its driver commands.
class WireVehicle : public Vehicle {
 public:
  /// Receives the driver's messages and sends the messages that are due. Call at `now`, after the
  /// world has been stepped for this tick. Never waits.
  virtual void exchange(Time now) = 0;

  /// Returns the error counters and measurements of the wire: `wire.ROBOT.…`.
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const = 0;
};

}  // namespace vantage::sim
