#include "drivers/rover/waypoint_path.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"

namespace vantage::drivers {
namespace {

constexpr double kThereM = 0.01;
constexpr double kFacingRad = 1e-6;

}  // namespace

models::Trajectory waypoint_trajectory(std::span<const Waypoint> waypoints, const Pose2& start,
                                       double height_m, Time start_time,
                                       const models::VehicleLimits& limits) {
  models::Trajectory out;
  out.start_time = start_time;
  out.start = start;
  out.height_m = height_m;
  Eigen::Vector2d here_m = start.position_m();
  double yaw_rad = start.yaw_rad;
  for (const Waypoint& waypoint : waypoints) {
    const Eigen::Vector2d offset_m = waypoint.position_world_m - here_m;
    const double length_m = offset_m.norm();
    if (length_m < kThereM) {
      continue;
    }
    const double heading_rad = std::atan2(offset_m.y(), offset_m.x());
    const double turn_rad = wrap_to_pi(heading_rad - yaw_rad);
    if (std::abs(turn_rad) > kFacingRad) {
      const double rate_radps = 0.5 * limits.yaw_rate_max_radps;
      out.segments.push_back(
          {{0.0, std::copysign(rate_radps, turn_rad)}, std::abs(turn_rad) / rate_radps, 0.0});
    }
    const double speed_mps = std::min(
        {waypoint.speed_mps, limits.speed_max_mps, std::sqrt(limits.brake_mps2 * length_m)});
    const double brake_s = speed_mps / limits.brake_mps2;
    out.segments.push_back({{speed_mps, 0.0}, length_m / speed_mps - 0.5 * brake_s, 0.0});
    out.segments.push_back({{speed_mps, 0.0}, brake_s, limits.brake_mps2});
    here_m = waypoint.position_world_m;
    yaw_rad = heading_rad;
  }
  return out;
}

}  // namespace vantage::drivers
