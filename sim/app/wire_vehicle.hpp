#pragma once

#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "sim/vehicle.hpp"

namespace vantage::sim {

/// A robot of the scenario whose device is `wire`: its truth moves as the device at the end of a
/// real UDP wire does, which its driver at the other end commands.
class WireVehicle : public Vehicle {
 public:
  /// Takes what the driver has sent, sends what is due. To be called at `now`, when the world has
  /// been stepped as far as it will be. Never waits.
  virtual void exchange(Time now) = 0;

  /// What went wrong on the wire, and what was measured there: `wire.ROBOT.…`.
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const = 0;
};

}  // namespace vantage::sim
