#include "drivers/quadrotor/reference.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers {

void Reference::hold(Time now, const Pose2& world_from_body, double height_m) {
  current_ = Leg{models::Trajectory{now, world_from_body, height_m, {}}, -1, {}};
  next_.reset();
}

void Reference::stop(Time now, const Pose2& world_from_body,
                     const Eigen::Vector2d& velocity_world_mps, double height_m,
                     double brake_mps2) {
  const double speed_mps = velocity_world_mps.norm();
  Pose2 start = world_from_body;
  if (speed_mps > 0.0) {
    start.yaw_rad = std::atan2(velocity_world_mps.y(), velocity_world_mps.x());
  }
  current_ = Leg{models::Trajectory{now, start, height_m, models::brake(speed_mps, brake_mps2)}, -1,
                 world_from_body.yaw_rad};
  next_.reset();
}

void Reference::follow(const models::RobotPlan& plan, Time now) {
  if (next_ && now >= next_->trajectory.start_time) {
    current_ = std::move(*next_);
    next_.reset();
  }
  next_ = Leg{plan.trajectory, plan.round, {}};
}

ReferencePoint Reference::at(Time time) const {
  const Leg& here = leg(time);
  const Pose2 pose = models::at(here.trajectory, time).world_from_body;
  ReferencePoint out;
  out.position_world_m = {pose.x_m, pose.y_m, here.trajectory.height_m};
  out.yaw_rad = here.heading_rad.value_or(pose.yaw_rad);
  out.is_still = time >= models::end_time(here.trajectory) && (!next_ || &here == &*next_);
  return out;
}

Setpoint track(const Reference& reference, const std::optional<BodyState>& body, Time now,
               const models::VehicleLimits& limits, const TrackingGains& gains) {
  const Duration lead = from_seconds(gains.lead_s);
  const Duration window = from_seconds(gains.corner_window_s);
  const ReferencePoint here = reference.at(now);
  const ReferencePoint before = reference.at(now + lead - window);
  const ReferencePoint after = reference.at(now + lead + window);
  const double width_s = 2.0 * gains.corner_window_s;

  Setpoint out;
  out.is_velocity = true;
  out.velocity_world_mps = (after.position_world_m - before.position_world_m) / width_s;
  out.yaw_rate_radps = wrap_to_pi(after.yaw_rad - before.yaw_rad) / width_s;
  if (body) {
    out.velocity_world_mps +=
        gains.position_per_s * (here.position_world_m - body->world_from_body.translation_m);
    out.yaw_rate_radps +=
        gains.yaw_per_s * wrap_to_pi(here.yaw_rad - flatten(body->world_from_body).yaw_rad);
  }
  const double speed_max_mps = gains.speed_reserve * limits.speed_max_mps;
  const double speed_mps = out.velocity_world_mps.head<2>().norm();
  if (speed_mps > speed_max_mps) {
    out.velocity_world_mps.head<2>() *= speed_max_mps / speed_mps;
  }
  out.velocity_world_mps.z() =
      std::clamp(out.velocity_world_mps.z(), -gains.climb_max_mps, gains.climb_max_mps);
  const double yaw_rate_max_radps = gains.speed_reserve * limits.yaw_rate_max_radps;
  out.yaw_rate_radps = std::clamp(out.yaw_rate_radps, -yaw_rate_max_radps, yaw_rate_max_radps);
  return out;
}

}  // namespace vantage::drivers
