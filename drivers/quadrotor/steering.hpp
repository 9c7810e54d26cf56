#pragma once

#include <optional>

#include "drivers/quadrotor/autopilot_link.hpp"
#include "drivers/quadrotor/body_tracker.hpp"
#include "drivers/quadrotor/safety/guard.hpp"

namespace vantage::drivers {

/// How hard a vehicle is kept to where it is asked to be.
struct SteeringGains {
  double position_per_s = 1.0;
  double yaw_per_s = 1.5;
  double speed_reserve = 1.3;  ///< speeds are cut at this multiple of the vehicle's limits
  double climb_max_mps = 0.7;
};

/// What the autopilot is told so that the body comes to what is asked: a place, when it is asked
/// to stand; else the velocity
///   v = v_asked + k (p_asked − p_mocap),  ω = ω_asked + k_yaw (yaw_asked − yaw_mocap), cut.
/// Without a body that is seen, the feedback is left out. Precondition: asked.kind is kTrack.
Setpoint steer(const FlightSetpoint& asked, const std::optional<BodyState>& body,
               const models::VehicleLimits& limits, const SteeringGains& gains);

}  // namespace vantage::drivers
