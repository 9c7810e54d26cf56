#include "planner/robot/external_answer.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"

namespace vantage::planner {
namespace {

constexpr double kSamePlace_m = 1e-3;
constexpr double kSameYaw_rad = 1e-3;
constexpr double kRounding = 1e-9;  // relative tolerance for values from another program

// True if 0 ≤ `value` ≤ `most` up to rounding; false for NaN.
bool is_from_zero_to(double value, double most) {
  return value >= 0.0 && value <= most * (1.0 + kRounding);
}

double speed_at_end_mps(const models::PlanSegment& segment) {
  return segment.control.speed_mps - segment.brake_mps2 * segment.duration_s;
}

bool is_flyable(const models::PlanSegment& segment, const models::VehicleLimits& limits) {
  return segment.duration_s > 0.0 &&
         is_from_zero_to(segment.control.speed_mps, limits.speed_max_mps) &&
         is_from_zero_to(std::abs(segment.control.yaw_rate_radps), limits.yaw_rate_max_radps) &&
         is_from_zero_to(segment.brake_mps2, limits.brake_mps2) &&
         (segment.brake_mps2 == 0.0 || segment.control.yaw_rate_radps == 0.0) &&
         speed_at_end_mps(segment) >= -kRounding * limits.speed_max_mps;
}

bool begins_as(const models::Trajectory& motion, const models::Trajectory& committed) {
  return motion.start_time == committed.start_time &&
         (motion.start.position_m() - committed.start.position_m()).norm() <= kSamePlace_m &&
         std::abs(wrap_to_pi(motion.start.yaw_rad - committed.start.yaw_rad)) <= kSameYaw_rad &&
         std::abs(motion.height_m - committed.height_m) <= kSamePlace_m;
}

}  // namespace

std::optional<models::Trajectory> motion_of_answer(const models::RobotPlan& answer,
                                                   const models::Trajectory& committed,
                                                   const scenario::PlannerSpec& planner,
                                                   const models::VehicleLimits& limits) {
  models::Trajectory motion = answer.trajectory;
  const auto steps = static_cast<std::size_t>(planner.horizon_steps);
  // Reserves one segment for the stop.
  const std::size_t segments_max = std::clamp(models::kFlownSegmentsMax - 1, steps, 4 * steps);
  if (!begins_as(motion, committed) || motion.segments.size() > segments_max) {
    return std::nullopt;
  }
  motion.start = committed.start;
  motion.height_m = committed.height_m;
  double drive_s = 0.0;  // duration of the segments without braking, s
  double stop_s = 0.0;
  for (const models::PlanSegment& segment : motion.segments) {
    if (!is_flyable(segment, limits)) {
      return std::nullopt;
    }
    (segment.brake_mps2 > 0.0 ? stop_s : drive_s) += segment.duration_s;
  }
  if (!is_from_zero_to(drive_s, planner.horizon_steps * planner.step_s) ||
      !is_from_zero_to(stop_s, planner.horizon_steps * planner.step_s)) {
    return std::nullopt;
  }
  const double speed_mps = motion.segments.empty() ? 0.0 : speed_at_end_mps(motion.segments.back());
  if (speed_mps > kRounding * limits.speed_max_mps) {
    for (const models::PlanSegment& stop : models::brake(speed_mps, limits.brake_mps2)) {
      motion.segments.push_back(stop);
    }
  }
  return motion;
}

}  // namespace vantage::planner
