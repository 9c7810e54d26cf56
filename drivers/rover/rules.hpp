#pragma once

#include <span>

#include "drivers/safety/conditions.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/ladder.hpp"
#include "drivers/safety/limits.hpp"

// What stops a rover. Its safe state is standing still, so the ladder is short: FOLLOW → HOLD →
// KILL; `land` is a stop that ends disarmed.

namespace vantage::drivers {

/// Everything that stops a rover or keeps it from being armed, most severe first. The columns are
/// those of the quadrotor's conditions(); no row has the severity kLand.
std::span<const Condition> rover_conditions();

/// What the ladder asks beyond SafetyInputs.
struct RoverFacts {
  bool stands = false;        ///< its wheels are known to stand
  bool stop_latched = false;  ///< by the rover's own word
};

/// One tick: the most severe condition wins. kIdle does not drive; kHold brakes and stands; kLand
/// brakes and becomes kIdle once it stands; kKilled ends by `arm`, standing, with the rover's own
/// stop released. Pure; constant time; allocates nothing.
LadderState step_rover_ladder(const LadderState& before, const SafetyInputs& inputs,
                              const RoverFacts& facts, const SafetyLimits& limits);

/// True while commands to drive are sent: following, holding or stopping for good.
bool is_driving(models::FlightState state);

}  // namespace vantage::drivers
