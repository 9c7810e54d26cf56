#pragma once

#include <optional>

#include "drivers/quadrotor/autopilot_link.hpp"
#include "drivers/safety/guard.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Turns where a vehicle is asked to be into what its autopilot is told: place, velocity,
/// acceleration, heading and turn. The autopilot closes the loop. The speed asked for is cut at the
/// vehicle's limit, and the place at kReachM from where the body is seen, so that no error makes it
/// dash.
/// Precondition: asked.kind is kTrack.
Setpoint steer(const FlightSetpoint& asked, const std::optional<BodyState>& seen,
               const models::VehicleLimits& limits);

inline constexpr double kReachM = 0.6;

}  // namespace vantage::drivers
