#pragma once

#include "models/exchange/messages.hpp"

namespace vantage::sim {

/// Returns the state after an operator's command. The more severe state applies and latches: follow
/// → hold → land → killed. A hold ends by kFollow, a landing on the ground (idle), and an emergency
/// stop by kArm on the ground. An idle vehicle takes off into a hold.
models::FlightState after_command(models::FlightState state, models::OperatorAction action,
                                  bool on_ground);

}  // namespace vantage::sim
