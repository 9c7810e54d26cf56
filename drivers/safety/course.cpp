#include "drivers/safety/course.hpp"

#include <algorithm>

#include "core/angle.hpp"

namespace vantage::drivers {

BrakingPath BrakingPath::along(const HeldPlan& plan, double elapsed_s, double brake_mps2,
                               double reaction_s, const Eigen::Vector3d& offset_m) {
  BrakingPath path;
  path.is_along_ = true;
  path.plan_ = plan;
  path.elapsed_s_ = elapsed_s;
  path.offset_m_ = offset_m;
  path.reaction_s_ = reaction_s;
  const double now_mps = point_at(plan, elapsed_s).velocity_world_mps.norm();
  const double then_mps = point_at(plan, elapsed_s + reaction_s).velocity_world_mps.norm();
  path.brake_s_ = std::max(now_mps, then_mps) / brake_mps2;
  return path;
}

BrakingPath BrakingPath::straight(const Eigen::Vector3d& position_m,
                                  const Eigen::Vector3d& velocity_mps, double yaw_rad,
                                  double brake_mps2, double reaction_s) {
  BrakingPath path;
  path.start_.position_world_m = position_m;
  path.start_.velocity_world_mps = velocity_mps;
  path.start_.yaw_rad = yaw_rad;
  path.reaction_s_ = reaction_s;
  path.brake_s_ = velocity_mps.norm() / brake_mps2;
  return path;
}

Setpoint BrakingPath::at(double t_s) const {
  // The plan's time advances at rate 1 until the reaction, then slows to rate 0: s(u) = u − u²/(2
  // T).
  const double u = std::clamp(t_s - reaction_s_, 0.0, brake_s_);
  const double gone_s =
      std::clamp(t_s, 0.0, reaction_s_) + (brake_s_ > 0.0 ? u - 0.5 * u * u / brake_s_ : 0.0);
  const double rate = brake_s_ > 0.0 ? 1.0 - u / brake_s_ : 0.0;
  Setpoint out = start_;
  if (is_along_) {
    out = point_at(plan_, elapsed_s_ + gone_s);
    out.position_world_m += offset_m_;
  } else {
    out.position_world_m += start_.velocity_world_mps * gone_s;
  }
  if (u > 0.0 && u < brake_s_) {
    out.acceleration_world_mps2 = -out.velocity_world_mps / brake_s_;
  }
  out.velocity_world_mps *= rate;
  out.yaw_rate_radps *= rate;
  return out;
}

void Course::hover(const Eigen::Vector3d& position_m, double yaw_rad, Time now) {
  mode_ = Mode::kHover;
  begin_ = now;
  from_ = {};
  from_.position_world_m = position_m;
  from_.yaw_rad = yaw_rad;
  has_next_ = false;
}

void Course::follow(const HeldPlan& plan, Time now) {
  if (plan.start_time > now) {
    next_ = plan;
    has_next_ = true;
  } else {
    begin(plan);
  }
}

void Course::begin(const HeldPlan& plan) {
  has_past_ = mode_ == Mode::kPlan;
  if (has_past_) {
    past_ = plan_;
    past_lag_s_ = lag_s_;
  }
  mode_ = Mode::kPlan;
  plan_ = plan;
  lag_s_ = 0.0;
  has_next_ = false;
}

void Course::stop(const BrakingPath& path, Time now) {
  mode_ = Mode::kBrake;
  begin_ = now;
  path_ = path;
  has_next_ = false;
}

void Course::shift(const Eigen::Vector3d& to_m, double speed_mps, Time now) {
  from_ = at(now);
  from_.velocity_world_mps.setZero();
  from_.acceleration_world_mps2.setZero();
  from_.yaw_rate_radps = 0.0;
  mode_ = Mode::kShift;
  begin_ = now;
  to_m_ = to_m;
  shift_mps_ = speed_mps;
  has_next_ = false;
}

void Course::advance(Time now, double dt_s, double rate) {
  now_ = now;
  if (has_next_ && next_.start_time <= now) {
    begin(HeldPlan(next_));
  }
  if (mode_ == Mode::kPlan) {
    lag_s_ += (1.0 - rate) * dt_s;
  }
}

double Course::elapsed_s(Time now) const { return to_seconds(now - plan_.start_time) - lag_s_; }

Setpoint Course::on_plan(double elapsed_s) const {
  const bool is_beyond = round_s_ > 0.0 && elapsed_s > round_s_;
  if (!is_beyond || has_next_ || this->elapsed_s(now_) >= round_s_) {
    return point_at(plan_, elapsed_s);
  }
  Setpoint out = point_at(plan_, round_s_);
  out.position_world_m += (elapsed_s - round_s_) * out.velocity_world_mps;
  out.yaw_rate_radps = 0.0;
  return out;
}

Setpoint Course::planned_at(Time time, double lag_s) const {
  if (has_next_ && time >= next_.start_time) {
    return point_at(next_, to_seconds(time - next_.start_time));
  }
  switch (mode_) {
    case Mode::kHover:
      return from_;
    case Mode::kPlan:
      if (has_past_ && time < plan_.start_time) {
        return point_at(past_, to_seconds(time - past_.start_time) - past_lag_s_);
      }
      return on_plan(to_seconds(time - plan_.start_time) - lag_s);
    case Mode::kBrake:
      return path_.at(to_seconds(time - begin_));
    case Mode::kShift: {
      Setpoint out = from_;
      const Eigen::Vector3d shift_m = to_m_ - from_.position_world_m;
      const double length_m = shift_m.norm();
      // Starts half a window late, so that the averaged motion starts at zero speed.
      const double gone_m = shift_mps_ * std::max(0.0, to_seconds(time - begin_) - half_window_s_);
      if (gone_m >= length_m) {
        out.position_world_m = to_m_;
      } else if (gone_m > 0.0) {
        out.position_world_m += shift_m * (gone_m / length_m);
        out.velocity_world_mps = shift_m * (shift_mps_ / length_m);
      }
      return out;
    }
  }
  return from_;
}

Setpoint Course::smoothed_at(Time time, double lag_s) const {
  constexpr int kIntervals = 16;
  Setpoint out = planned_at(time, lag_s);
  const bool is_near_next = has_next_ && time + from_seconds(half_window_s_) >= next_.start_time;
  const bool changes_speed = mode_ == Mode::kPlan || mode_ == Mode::kShift || is_near_next;
  if (!(half_window_s_ > 0.0) || !changes_speed) {
    return out;
  }
  // Averages over the window by the trapezoidal rule: positions, and yaw relative to the first yaw.
  const Setpoint first = planned_at(time - from_seconds(half_window_s_), lag_s);
  Setpoint last = first;
  Eigen::Vector3d sum_m = 0.5 * first.position_world_m;
  double turned_rad = 0.0;
  double sum_rad = 0.0;
  for (int i = 1; i <= kIntervals; ++i) {
    const double at_s = half_window_s_ * (2.0 * i / kIntervals - 1.0);
    const Setpoint here = planned_at(time + from_seconds(at_s), lag_s);
    const double weight = i < kIntervals ? 1.0 : 0.5;
    turned_rad += wrap_to_pi(here.yaw_rad - last.yaw_rad);
    sum_m += weight * here.position_world_m;
    sum_rad += weight * turned_rad;
    last = here;
  }
  const double window_s = 2.0 * half_window_s_;
  out.position_world_m = sum_m / kIntervals;
  out.velocity_world_mps = (last.position_world_m - first.position_world_m) / window_s;
  out.acceleration_world_mps2 = (last.velocity_world_mps - first.velocity_world_mps) / window_s;
  out.yaw_rad = wrap_to_pi(first.yaw_rad + sum_rad / kIntervals);
  out.yaw_rate_radps = turned_rad / window_s;
  return out;
}

bool Course::has_plan(Time now) const {
  return mode_ == Mode::kPlan && elapsed_s(now) <= duration_s(plan_);
}

bool Course::is_hovering(Time now) const {
  switch (mode_) {
    case Mode::kHover:
      return true;
    case Mode::kPlan:
      return false;
    case Mode::kBrake:
      return to_seconds(now - begin_) >= path_.duration_s();
    case Mode::kShift: {
      const double shift_s = (to_m_ - from_.position_world_m).norm() / shift_mps_;
      return to_seconds(now - begin_) >= shift_s + 2.0 * half_window_s_;
    }
  }
  return false;
}

}  // namespace vantage::drivers
