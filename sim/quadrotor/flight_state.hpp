#pragma once

#include "models/exchange/messages.hpp"

namespace vantage::sim {

/// Returns the state after an operator's command. The more severe state wins and latches: follow →
/// hold → land → killed. A hold ends with kFollow; a landing ends on the ground (idle); an
/// emergency stop ends with kArm on the ground; an idle vehicle takes off into a hold.
models::FlightState after_command(models::FlightState state, models::OperatorAction action,
                                  bool on_ground);

}  // namespace vantage::sim
