#include "drivers/rover/steering.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers {
namespace {

constexpr double kStillMps = 0.02;
constexpr double kStillRadps = 0.02;

}  // namespace

models::UnicycleControl steer(const Pose2& world_from_body, const Setpoint& reference,
                              const models::VehicleLimits& limits, const SteeringGains& gains) {
  const double c = std::cos(world_from_body.yaw_rad);
  const double s = std::sin(world_from_body.yaw_rad);
  const double dx_m = reference.position_world_m.x() - world_from_body.x_m;
  const double dy_m = reference.position_world_m.y() - world_from_body.y_m;
  const double x_e = c * dx_m + s * dy_m;
  const double y_e = -s * dx_m + c * dy_m;
  const double yaw_e = reference.yaw_rad - world_from_body.yaw_rad;
  const double v_r = reference.velocity_world_mps.x() * std::cos(reference.yaw_rad) +
                     reference.velocity_world_mps.y() * std::sin(reference.yaw_rad);
  const double w_r = reference.yaw_rate_radps;
  const bool is_still = std::abs(v_r) < kStillMps && std::abs(w_r) < kStillRadps;
  const double v_p = is_still ? 0.0 : gains.pivot_mps;

  const double v = v_r * std::cos(yaw_e) + gains.along_per_s * x_e;
  const double w = w_r + gains.side_per_m2 * v_r * y_e +
                   gains.turn_per_m * (std::abs(v_r) + v_p) * std::sin(yaw_e);
  models::UnicycleControl out;
  out.speed_mps = v_r < 0.0 ? std::clamp(v, -limits.speed_max_mps, 0.0)
                            : std::clamp(v, 0.0, limits.speed_max_mps);
  out.yaw_rate_radps = std::clamp(w, -limits.yaw_rate_max_radps, limits.yaw_rate_max_radps);
  return out;
}

models::UnicycleControl brake_on_circle(const models::UnicycleControl& control, double brake_mps2,
                                        double dt_s) {
  const double speed_mps = std::abs(control.speed_mps);
  const double left_mps = std::max(0.0, speed_mps - brake_mps2 * dt_s);
  const double share = speed_mps > 0.0 ? left_mps / speed_mps : 0.0;
  models::UnicycleControl out;
  out.speed_mps = share * control.speed_mps;
  out.yaw_rate_radps = share * control.yaw_rate_radps;
  return out;
}

}  // namespace vantage::drivers
