#pragma once

#include <optional>

#include "drivers/safety/setpoint.hpp"
#include "drivers/vehicle/body_tracker.hpp"
#include "models/motion/vehicle_limits.hpp"

namespace vantage::drivers {

/// Returns the autopilot set-point for the motion `commanded`: position, velocity, acceleration,
/// yaw and yaw rate. The autopilot controls the position. The speed is limited to the vehicle's
/// maximum. The position is limited to kReachM from the body's measured position, so that a
/// position error causes no sudden fast motion.
Setpoint steer(const Setpoint& commanded, const std::optional<BodyState>& seen,
               const models::VehicleLimits& limits);

inline constexpr double kReachM = 0.6;

}  // namespace vantage::drivers
