#include "drivers/quadrotor/steering.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers {
namespace {

constexpr double kStandingMps = 0.02;
constexpr double kStandingRadps = 0.02;

}  // namespace

Setpoint Steering::steer(const FlightSetpoint& asked, const std::optional<BodyState>& body) const {
  Setpoint out;
  if (asked.velocity_world_mps.norm() < kStandingMps &&
      std::abs(asked.yaw_rate_radps) < kStandingRadps) {
    out.position_world_m = asked.position_world_m;
    out.yaw_rad = asked.yaw_rad;
    return out;
  }
  out.is_velocity = true;
  out.velocity_world_mps = asked.velocity_world_mps + gains_.lead_s * asked.acceleration_world_mps2;
  out.yaw_rate_radps = asked.yaw_rate_radps;
  if (body) {
    out.velocity_world_mps +=
        gains_.position_per_s * (asked.position_world_m - body->world_from_body.translation_m);
    out.yaw_rate_radps +=
        gains_.yaw_per_s * wrap_to_pi(asked.yaw_rad - flatten(body->world_from_body).yaw_rad);
  }
  const double speed_max_mps = gains_.speed_reserve * limits_.speed_max_mps;
  const double speed_mps = out.velocity_world_mps.head<2>().norm();
  if (speed_mps > speed_max_mps) {
    out.velocity_world_mps.head<2>() *= speed_max_mps / speed_mps;
  }
  out.velocity_world_mps.z() =
      std::clamp(out.velocity_world_mps.z(), -gains_.climb_max_mps, gains_.climb_max_mps);
  const double yaw_rate_max_radps = gains_.speed_reserve * limits_.yaw_rate_max_radps;
  out.yaw_rate_radps = std::clamp(out.yaw_rate_radps, -yaw_rate_max_radps, yaw_rate_max_radps);
  return out;
}

}  // namespace vantage::drivers
