#pragma once

#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "sim/vehicle.hpp"

namespace vantage::sim {

/// Robot of the scenario with the device `wire`: its true state is the state of an emulated device,
/// which its driver commands over UDP.
class WireVehicle : public Vehicle {
 public:
  /// Receives the driver's messages and sends the messages that are due. Call at `now`, after the
  /// world has been stepped for this tick. Never blocks.
  virtual void exchange(Time now) = 0;

  /// Returns the error counters and latencies of the connection: `wire.ROBOT.…`.
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const = 0;
};

}  // namespace vantage::sim
