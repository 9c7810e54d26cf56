#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "drivers/safety/plan_check.hpp"

namespace vantage::drivers {
namespace {

constexpr double kStraightRadps = 1e-6;

// Returns the state `t` seconds after the start of `segment` at (p, yaw). An arc is a turn about
// its centre, which lies v/ω to the left.
Setpoint along(const models::PlanSegment& segment, const Eigen::Vector3d& p_m, double yaw_rad,
               double t) {
  const double v = segment.control.speed_mps;
  const double w = segment.control.yaw_rate_radps;
  Setpoint out;
  out.position_world_m = p_m;
  out.yaw_rad = yaw_rad;
  double speed_mps = v;
  if (segment.brake_mps2 > 0.0) {
    const double t_stop = std::min(t, std::abs(v) / segment.brake_mps2);
    const double sense = v < 0.0 ? -1.0 : 1.0;
    const double travelled_m = v * t_stop - sense * 0.5 * segment.brake_mps2 * t_stop * t_stop;
    speed_mps = v - sense * segment.brake_mps2 * t_stop;
    out.position_world_m +=
        travelled_m * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  } else if (std::abs(w) < kStraightRadps) {
    out.position_world_m += v * t * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
    out.yaw_rad = yaw_rad + w * t;
    out.yaw_rate_radps = w;
  } else {
    const double radius_m = v / w;
    const double turned_rad = yaw_rad + w * t;
    out.position_world_m.x() += radius_m * (std::sin(turned_rad) - std::sin(yaw_rad));
    out.position_world_m.y() -= radius_m * (std::cos(turned_rad) - std::cos(yaw_rad));
    out.yaw_rad = turned_rad;
    out.yaw_rate_radps = w;
  }
  out.yaw_rad = wrap_to_pi(out.yaw_rad);
  out.velocity_world_mps =
      speed_mps * Eigen::Vector3d(std::cos(out.yaw_rad), std::sin(out.yaw_rad), 0.0);
  return out;
}

}  // namespace

bool hold_plan(const models::Trajectory& trajectory, HeldPlan& out) {
  if (trajectory.segments.size() > HeldPlan::kSegmentsMax) {
    return false;
  }
  out.start_time = trajectory.start_time;
  out.start = trajectory.start;
  out.height_m = trajectory.height_m;
  out.count = trajectory.segments.size();
  std::copy(trajectory.segments.begin(), trajectory.segments.end(), out.segments.begin());
  return true;
}

double duration_s(const HeldPlan& plan) {
  double sum_s = 0.0;
  for (std::size_t i = 0; i < plan.count; ++i) {
    sum_s += plan.segments[i].duration_s;
  }
  return sum_s;
}

Setpoint point_at(const HeldPlan& plan, double elapsed_s) {
  Setpoint here;
  here.position_world_m = {plan.start.x_m, plan.start.y_m, plan.height_m};
  here.yaw_rad = plan.start.yaw_rad;
  if (elapsed_s < 0.0) {
    return here;
  }
  for (std::size_t i = 0; i < plan.count; ++i) {
    const models::PlanSegment& segment = plan.segments[i];
    const bool is_here = elapsed_s < segment.duration_s;
    here = along(segment, here.position_world_m, here.yaw_rad,
                 is_here ? elapsed_s : segment.duration_s);
    if (is_here) {
      return here;
    }
    elapsed_s -= segment.duration_s;
  }
  here.velocity_world_mps.setZero();
  here.yaw_rate_radps = 0.0;
  return here;
}

PlanWalk::PlanWalk(const HeldPlan& plan) : plan_(&plan) {
  begin_.position_world_m = {plan.start.x_m, plan.start.y_m, plan.height_m};
  begin_.yaw_rad = plan.start.yaw_rad;
}

Setpoint PlanWalk::at(double elapsed_s) {
  while (segment_ < plan_->count) {
    const models::PlanSegment& segment = plan_->segments[segment_];
    if (elapsed_s - begin_s_ < segment.duration_s) {
      return elapsed_s < begin_s_
                 ? begin_
                 : along(segment, begin_.position_world_m, begin_.yaw_rad, elapsed_s - begin_s_);
    }
    begin_ = along(segment, begin_.position_world_m, begin_.yaw_rad, segment.duration_s);
    begin_s_ += segment.duration_s;
    ++segment_;
  }
  Setpoint hover = begin_;
  hover.velocity_world_mps.setZero();
  hover.yaw_rate_radps = 0.0;
  return hover;
}

double speed_max_mps(const HeldPlan& plan, double from_s, double to_s) {
  double fastest_mps = 0.0;
  double begin_s = 0.0;
  for (std::size_t i = 0; i < plan.count; ++i) {
    const double end_s = begin_s + plan.segments[i].duration_s;
    if (end_s > from_s && begin_s <= to_s) {
      fastest_mps = std::max(fastest_mps, std::abs(plan.segments[i].control.speed_mps));
    }
    begin_s = end_s;
  }
  return fastest_mps;
}

}  // namespace vantage::drivers
