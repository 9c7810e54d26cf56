#pragma once

#include "models/exchange/messages.hpp"

namespace vantage::sim {

/// Returns the state after an operator's command. The more severe state applies and latches: follow
/// → hold → land → killed. kFollow ends a hold. A landing ends on the ground (idle). kArm on the
/// ground ends an emergency stop. An idle vehicle takes off into a hold.
models::FlightState after_command(models::FlightState state, models::OperatorAction action,
                                  bool on_ground);

}  // namespace vantage::sim
