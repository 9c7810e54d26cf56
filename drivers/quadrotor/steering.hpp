#pragma once

#include <optional>

#include "drivers/quadrotor/autopilot_link.hpp"
#include "drivers/safety/guard.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Returns the autopilot set-point for the motion `commanded`: position, velocity,
/// acceleration, yaw and yaw rate. The autopilot closes the loop. The speed is limited to the
/// vehicle's limit. The position is limited to kReachM from the body seen, so that no error causes
/// a sudden fast motion. Precondition: commanded.kind is kTrack.
Setpoint steer(const FlightSetpoint& commanded, const std::optional<BodyState>& seen,
               const models::VehicleLimits& limits);

inline constexpr double kReachM = 0.6;

}  // namespace vantage::drivers
