#pragma once

#include "core/pose.hpp"
#include "drivers/safety/plan_check.hpp"
#include "models/motion/unicycle.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Gains of a rover's tracking control. As a function of distance driven, a sideways error decays
/// like an oscillator of √side_per_m2 rad/m with damping turn_per_m / (2 √side_per_m2).
struct SteeringGains {
  double along_per_s = 1.5;  ///< K_x in steer(): error along the heading
  double side_per_m2 = 4.0;  ///< K_y in steer(): sideways error
  double turn_per_m = 3.2;   ///< K_θ in steer(): error of the yaw
  double pivot_mps = 0.3;    ///< m/s; replaces the speed when the reference turns in place
};

/// Returns the command that brings a unicycle at `world_from_body` to `reference`, with feedforward
/// of the reference's velocity and yaw rate:
///   v = v_r cos θ_e + K_x x_e,   ω = ω_r + K_y v_r y_e + K_θ (|v_r| + v_p) sin θ_e,
/// (x_e, y_e, θ_e) is the reference in the body's frame; v_p is 0 unless the reference turns or
/// moves. The command is within the vehicle's limits, and its speed never has the opposite sign of
/// the reference's. The reference's velocity is assumed to be along its yaw.
/// Source: Kanayama, Kimura, Miyazaki, Noguchi, A stable tracking control method for an autonomous
/// mobile robot (1990), eq. 8, with v_p added.
models::UnicycleControl steer(const Pose2& world_from_body, const Setpoint& reference,
                              const models::VehicleLimits& limits, const SteeringGains& gains = {});

/// Returns `control` slowed by `brake_mps2` over `dt_s` on the same circle, at most to a stop.
models::UnicycleControl brake_on_circle(const models::UnicycleControl& control, double brake_mps2,
                                        double dt_s);

}  // namespace vantage::drivers
