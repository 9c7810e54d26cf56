#pragma once

#include <span>

#include "drivers/safety/conditions.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/ladder.hpp"
#include "drivers/safety/limits.hpp"

// Conditions and ladder of a rover. The safe state is standstill, so the ladder is short: FOLLOW →
// HOLD → KILL. `land` stops and then disarms the rover.

namespace vantage::drivers {

/// Returns the conditions that stop a rover or forbid arming, most severe first. The rows have the
/// fields of the quadrotor's conditions(); no row has severity kLand.
std::span<const Condition> rover_conditions();

/// Inputs of the ladder in addition to SafetyInputs.
struct RoverFacts {
  bool is_stationary = false;  ///< the wheels are known to be stationary
  bool stop_latched = false;   ///< the rover reports that its own stop is latched
};

/// Computes one tick: the most severe condition decides. kIdle does not drive; kHold brakes and
/// stays stationary; kLand brakes and becomes kIdle at standstill. kKilled ends by `arm` at
/// standstill, once the rover's own stop is released. Pure; constant time; allocates no memory.
LadderState step_rover_ladder(const LadderState& before, const SafetyInputs& inputs,
                              const RoverFacts& facts, const SafetyLimits& limits);

/// True if commands to drive are sent: follow, hold or land.
bool is_driving(models::FlightState state);

}  // namespace vantage::drivers
