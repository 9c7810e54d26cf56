#pragma once

#include <optional>

#include "drivers/quadrotor/autopilot_link.hpp"
#include "drivers/quadrotor/body_tracker.hpp"
#include "drivers/quadrotor/safety/guard.hpp"

namespace vantage::drivers {

/// How hard a vehicle is kept to where it is asked to be.
struct SteeringGains {
  double position_per_s = 1.2;
  double yaw_per_s = 1.5;
  double lead_s = 0.5;         ///< about the time constant with which velocities are answered
  double speed_reserve = 2.6;  ///< speeds are cut at this multiple of the vehicle's limits
  double climb_max_mps = 0.7;
};

/// Turns where a vehicle is asked to be into what its autopilot is told: a place, when it is asked
/// to stand; else the velocity
///   v = v_asked + T a_asked + k (p_asked − p_mocap),  ω = ω_asked + k_yaw (yaw error),
/// cut at the vehicle's limits: an autopilot that answers velocities with a lag of T then keeps to
/// the way. Without a body that is seen the feedback is left out.
class Steering {
 public:
  Steering(const models::VehicleLimits& limits, const SteeringGains& gains)
      : limits_(limits), gains_(gains) {}

  /// Precondition: asked.kind is kTrack.
  [[nodiscard]] Setpoint steer(const FlightSetpoint& asked,
                               const std::optional<BodyState>& body) const;

 private:
  models::VehicleLimits limits_;
  SteeringGains gains_;
};

}  // namespace vantage::drivers
