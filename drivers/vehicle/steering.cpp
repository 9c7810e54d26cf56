#include "drivers/vehicle/steering.hpp"

#include <algorithm>

namespace vantage::drivers {
namespace {

constexpr double kClimbMaxMps = 0.7;

template <class Vector>
void cut(Vector&& v, double norm_max) {
  const double norm = v.norm();
  if (norm > norm_max) {
    v *= norm_max / norm;
  }
}

}  // namespace

Setpoint steer(const Setpoint& commanded, const std::optional<BodyState>& seen,
               const models::VehicleLimits& limits) {
  Setpoint out = commanded;
  cut(out.velocity_world_mps.head<2>(), limits.speed_max_mps);
  out.velocity_world_mps.z() = std::clamp(out.velocity_world_mps.z(), -kClimbMaxMps, kClimbMaxMps);
  if (seen) {
    Eigen::Vector3d away_m = out.position_world_m - seen->world_from_body.translation_m;
    cut(away_m.head<2>(), kReachM);
    away_m.z() = std::clamp(away_m.z(), -kReachM, kReachM);
    out.position_world_m = seen->world_from_body.translation_m + away_m;
  }
  out.yaw_rate_radps =
      std::clamp(commanded.yaw_rate_radps, -limits.yaw_rate_max_radps, limits.yaw_rate_max_radps);
  return out;
}

}  // namespace vantage::drivers
