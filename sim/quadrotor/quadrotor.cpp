#include "sim/quadrotor/quadrotor.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "sim/quadrotor/lag.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr double kGravityMps2 = 9.81;
constexpr double kDragPerS = 0.25;       // 1/s; deceleration per speed through the air
constexpr double kSegmentMaxS = 3600.0;  // s; longer durations could overflow Time when summed

bool is_sound(const models::Trajectory& trajectory) {
  bool sound = std::isfinite(trajectory.start.x_m) && std::isfinite(trajectory.start.y_m) &&
               std::isfinite(trajectory.start.yaw_rad) && std::isfinite(trajectory.height_m);
  for (const models::PlanSegment& segment : trajectory.segments) {
    sound = sound && std::isfinite(segment.control.speed_mps) &&
            std::isfinite(segment.control.yaw_rate_radps) && segment.duration_s >= 0.0 &&
            segment.duration_s <= kSegmentMaxS && segment.brake_mps2 >= 0.0 &&
            std::isfinite(segment.brake_mps2);
  }
  return sound;
}

template <int N>
Eigen::Matrix<double, N, 1> cut(const Eigen::Matrix<double, N, 1>& x, double norm_max) {
  const double norm = x.norm();
  return norm > norm_max ? Eigen::Matrix<double, N, 1>(x * (norm_max / norm)) : x;
}

}  // namespace

QuadrotorParameters parameters_in(const std::optional<scenario::WindSpec>& wind) {
  QuadrotorParameters out;
  if (wind) {
    out.wind_mean_mps2 = kDragPerS * Eigen::Vector2d(wind->x_mps, wind->y_mps);
    out.wind_sigma_mps2 = kDragPerS * wind->gust_sigma_mps;
  }
  return out;
}

FlightState after_command(FlightState state, OperatorAction action, bool on_ground) {
  switch (action) {
    case OperatorAction::kHeartbeat:
      return state;
    case OperatorAction::kArm:
      return state == FlightState::kKilled && on_ground ? FlightState::kIdle : state;
    case OperatorAction::kTakeOff:
      return state == FlightState::kIdle ? FlightState::kHold : state;
    case OperatorAction::kFollow:
      return state == FlightState::kHold ? FlightState::kFollow : state;
    case OperatorAction::kHold:
      return state == FlightState::kFollow ? FlightState::kHold : state;
    case OperatorAction::kLand:
      return state == FlightState::kFollow || state == FlightState::kHold ? FlightState::kLand
                                                                          : state;
    case OperatorAction::kEmergencyStop:
      return FlightState::kKilled;
  }
  return state;
}

Quadrotor::Quadrotor(const scenario::RobotSpec& spec, double tracking_tolerance_m,
                     std::uint64_t seed, Time start, const QuadrotorParameters& parameters)
    : name_(spec.name),
      limits_(spec.limits),
      height_m_(spec.height_m),
      tolerance_m_(tracking_tolerance_m),
      parameters_(parameters),
      rng_(random_stream(seed, "wind:" + spec.name)),
      course_(start, spec.start, spec.height_m),
      start_(start),
      position_m_(spec.start.x_m, spec.start.y_m, spec.height_m),
      yaw_rad_(spec.start.yaw_rad) {
  require(position_m_.allFinite() && std::isfinite(yaw_rad_) && spec.height_m > 0.0,
          "robot " + name_ + ": start must be finite and above the ground");
}

PlanVerdict Quadrotor::offer(const models::RobotPlan& plan, Time now) {
  const models::Trajectory& trajectory = plan.trajectory;
  if (!is_sound(trajectory)) {
    return PlanVerdict::kNotFinite;
  }
  if (state_ != FlightState::kFollow) {
    return PlanVerdict::kNotFollowing;
  }
  if (trajectory.start_time < course_.newest_start()) {
    return PlanVerdict::kStale;
  }
  const Time when = std::max(trajectory.start_time, now);
  const Pose2 planned = models::at(trajectory, when).world_from_body;
  const Pose2 expected = course_.at(when).world_from_body;
  const Eigen::Vector2d gap_m = planned.position_m() - expected.position_m();
  if (!(std::hypot(gap_m.x(), gap_m.y(), trajectory.height_m - course_.height_m(when)) <=
        2.0 * tolerance_m_)) {
    return PlanVerdict::kDiscontinuous;
  }
  course_.follow(trajectory, plan.round);
  return PlanVerdict::kAccepted;
}

void Quadrotor::command(OperatorAction action, Time now) {
  const FlightState before = state_;
  state_ = after_command(state_, action, on_ground());
  if (state_ == before || state_ == FlightState::kIdle || state_ == FlightState::kFollow) {
    return;
  }
  course_.stop(now, assumed_pose(), assumed_from_true(velocity_mps_.head<2>()), height_m_,
               limits_.brake_mps2);
}

void Quadrotor::step(Time now, double dt_s) {
  switch (state_) {
    case FlightState::kIdle:
      velocity_mps_.setZero();
      yaw_rate_radps_ = 0.0;
      break;
    case FlightState::kKilled:
      fall(dt_s);
      break;
    case FlightState::kFollow:
    case FlightState::kHold:
    case FlightState::kLand:
      step_gusts(dt_s);
      fly(now, dt_s);
      break;
  }
  course_.prune(now);
}

void Quadrotor::fly(Time now, double dt_s) {
  const QuadrotorParameters& p = parameters_;
  const Duration window = from_seconds(p.corner_window_s);
  const CoursePoint before = course_.at(now - window);
  const CoursePoint here = course_.at(now);
  const CoursePoint ahead = course_.at(now + window);
  const double width_s = 2.0 * p.corner_window_s;
  const Pose2 assumed = assumed_pose();

  const Eigen::Vector2d v_s =
      (ahead.world_from_body.position_m() - before.world_from_body.position_m()) / width_s;
  const Eigen::Vector2d a_s = (ahead.velocity_world_mps - before.velocity_world_mps) / width_s;
  const Eigen::Vector2d error_m = here.world_from_body.position_m() - assumed.position_m();
  Eigen::Vector2d v_cmd = cut<2>(v_s + p.velocity_lag_s * a_s + p.position_gain_per_s * error_m,
                                 p.command_reserve * limits_.speed_max_mps);
  if (assumed_from_true_) {  // the vehicle turns the command by the error of its heading
    v_cmd = Eigen::Rotation2Dd(-assumed_from_true_->yaw_rad) * v_cmd;
  }

  const double omega_s =
      wrap_to_pi(ahead.world_from_body.yaw_rad - before.world_from_body.yaw_rad) / width_s;
  const double alpha_s = (ahead.yaw_rate_radps - before.yaw_rate_radps) / width_s;
  const double omega_max = p.command_reserve * limits_.yaw_rate_max_radps;
  const double omega_cmd =
      std::clamp(omega_s + p.yaw_rate_lag_s * alpha_s +
                     p.yaw_gain_per_s * wrap_to_pi(here.world_from_body.yaw_rad - assumed.yaw_rad),
                 -omega_max, omega_max);

  const double height_error_m = course_.height_m(now) - position_m_.z();
  const double climb_cmd =
      state_ == FlightState::kLand
          ? -p.climb_max_mps
          : std::clamp(p.height_gain_per_s * height_error_m, -p.climb_max_mps, p.climb_max_mps);

  const Eigen::Vector3d old_mps = velocity_mps_;
  velocity_mps_.head<2>() = first_order_lag<2>(velocity_mps_.head<2>(), v_cmd, p.velocity_lag_s,
                                               p.acceleration_max_mps2, dt_s) +
                            (p.wind_mean_mps2 + wind_mps2_) * dt_s;
  velocity_mps_.z() =
      first_order_lag<1>(velocity_mps_.tail<1>(), Eigen::Matrix<double, 1, 1>(climb_cmd),
                         p.velocity_lag_s, p.acceleration_max_mps2, dt_s)(0);
  position_m_ += 0.5 * (old_mps + velocity_mps_) * dt_s;

  const double old_radps = yaw_rate_radps_;
  using Scalar = Eigen::Matrix<double, 1, 1>;
  yaw_rate_radps_ = first_order_lag<1>(Scalar(yaw_rate_radps_), Scalar(omega_cmd), p.yaw_rate_lag_s,
                                       p.yaw_acceleration_max_radps2, dt_s)(0);
  yaw_rad_ = wrap_to_pi(yaw_rad_ + 0.5 * (old_radps + yaw_rate_radps_) * dt_s);

  if (state_ == FlightState::kLand && position_m_.z() <= 0.0) {
    position_m_.z() = 0.0;
    velocity_mps_.setZero();
    state_ = FlightState::kIdle;
  }
}

void Quadrotor::fall(double dt_s) {
  if (on_ground()) {
    position_m_.z() = 0.0;
    velocity_mps_.setZero();
    yaw_rate_radps_ = 0.0;
    return;
  }
  const double old_mps = velocity_mps_.z();
  velocity_mps_.z() -= kGravityMps2 * dt_s;
  position_m_.head<2>() += velocity_mps_.head<2>() * dt_s;
  position_m_.z() = std::max(0.0, position_m_.z() + 0.5 * (old_mps + velocity_mps_.z()) * dt_s);
}

void Quadrotor::step_gusts(double dt_s) {
  // Ornstein–Uhlenbeck process, exactly discretised: its σ is stationary for any step.
  const double keep = std::exp(-dt_s / parameters_.wind_memory_s);
  const double fresh = parameters_.wind_sigma_mps2 * std::sqrt(1.0 - keep * keep);
  std::normal_distribution<double> normal;
  for (int axis = 0; axis < 2; ++axis) {
    wind_mps2_(axis) =
        std::clamp(keep * wind_mps2_(axis) + fresh * normal(rng_),
                   -3.0 * parameters_.wind_sigma_mps2, 3.0 * parameters_.wind_sigma_mps2);
  }
}

Pose2 Quadrotor::pose() const { return {position_m_.x(), position_m_.y(), yaw_rad_}; }

Pose2 Quadrotor::assumed_pose() const {
  return assumed_from_true_ ? *assumed_from_true_ * pose() : pose();
}

Eigen::Vector2d Quadrotor::assumed_from_true(const Eigen::Vector2d& velocity_mps) const {
  return assumed_from_true_ ? Eigen::Rotation2Dd(assumed_from_true_->yaw_rad) * velocity_mps
                            : velocity_mps;
}

Pose3 Quadrotor::world_from_body() const { return lift(pose(), position_m_.z()); }

models::VehicleStatus Quadrotor::status(Time now) const {
  models::VehicleStatus status;
  status.stamp.time = now;
  status.robot = name_;
  status.state = state_;
  status.battery_share =
      std::clamp(1.0 - to_seconds(now - start_) / parameters_.endurance_s, 0.0, 1.0);
  status.setpoint = course_.at(now).world_from_body;
  status.setpoint_height_m =
      state_ == FlightState::kLand || state_ == FlightState::kIdle || state_ == FlightState::kKilled
          ? 0.0
          : course_.height_m(now);
  status.plan_round = course_.round(now);
  if (state_ == FlightState::kFollow && status.plan_round < 0) {
    status.reasons.emplace_back("no plan");
  } else if (state_ != FlightState::kFollow && state_ != FlightState::kIdle) {
    status.reasons.emplace_back("operator");
  }
  return status;
}

}  // namespace vantage::sim
