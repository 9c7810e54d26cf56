#include "sim/autopilot/flight_controller.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"

namespace vantage::sim {
namespace {

constexpr std::uint8_t kAccepted = 0;
constexpr std::uint8_t kCritical = 2;
constexpr std::uint8_t kWarning = 4;
constexpr std::uint16_t kFlagsNotReady = 0x0A5;  // attitude, vertical velocity, height; no position
constexpr Duration kTargetGapMax = std::chrono::milliseconds(500);  // 2 Hz
constexpr Duration kProofOfLife = std::chrono::seconds(1);
constexpr double kBatteryToArm = 0.10;
constexpr double kBatteryToFly = 0.03;
constexpr double kIntegralMaxMps2 = 3.0;
constexpr double kYawGainPerS = 2.0;
constexpr double kYawRateMaxRadps = 3.5;

Eigen::Vector3d cut(Eigen::Vector3d v, double level_max, double vertical_max) {
  const double level = v.head<2>().norm();
  if (level > level_max) {
    v.head<2>() *= level_max / level;
  }
  v.z() = std::clamp(v.z(), -vertical_max, vertical_max);
  return v;
}

}  // namespace

FlightController::FlightController(const AutopilotProfile& profile,
                                   const AirframeParameters& airframe, std::uint64_t seed,
                                   const Eigen::Vector3d& position_m, double yaw_rad, Time boot)
    : profile_(profile),
      airframe_(airframe, seed, position_m, yaw_rad),
      estimator_(profile.converge_s, profile.pose_loss_s),
      boot_(boot),
      now_(boot),
      mode_(profile.start_mode) {}

bool FlightController::has_position(Time now) const {
  return estimator_.is_ready(now) && (has_origin_ || !profile_.needs_origin);
}

std::uint16_t FlightController::estimator_flags(Time now) const {
  if (estimator_.is_lost(now)) {
    return profile_.flags_lost;
  }
  if (!has_position(now)) {
    return kFlagsNotReady;
  }
  return airframe_.is_on_ground() ? profile_.flags_ground : profile_.flags_air;
}

std::uint8_t FlightController::landed_state() const {
  if (airframe_.is_on_ground()) {
    return 1;
  }
  if (mode_ == profile_.land_mode) {
    return 4;
  }
  return climb_to_m_ ? 3 : 2;
}

std::uint8_t FlightController::arm(Time now) {
  if (is_armed_) {
    return kAccepted;
  }
  std::string why = fault_;
  if (to_seconds(now - boot_) < profile_.arm_delay_s) {
    why = "Arm: Accels inconsistent";
  } else if (!has_position(now)) {
    why = profile_.needs_origin ? "Arm: Need Position Estimate"
                                : "Arming denied: Resolve system health failures first";
  } else if (airframe_.battery_share() < kBatteryToArm) {
    why = profile_.needs_origin ? "Arm: Battery 1 low" : "Arming denied: low battery";
  }
  if (!why.empty()) {
    say(kCritical, why);
    return profile_.refusal;
  }
  is_armed_ = true;
  has_lifted_ = false;
  armed_at_ = now;
  touched_down_.reset();
  return kAccepted;
}

std::uint8_t FlightController::disarm(bool is_forced) {
  if (!is_forced && is_armed_ && !airframe_.is_on_ground()) {
    say(kCritical, "Disarming denied: not landed");
    return profile_.refusal;
  }
  stop_motors();
  return kAccepted;
}

void FlightController::stop_motors() {
  is_armed_ = false;
  climb_to_m_.reset();
  integral_mps2_.setZero();
  shaped_mps_.setZero();
}

bool FlightController::has_proof_of_life(Time now) const {
  return targets_since_ && now - target_time_ <= kTargetGapMax &&
         now - *targets_since_ > kProofOfLife;
}

std::uint8_t FlightController::set_mode(std::uint32_t mode, Time now) {
  if (mode == profile_.follow_mode && mode_ != mode) {
    if (!has_position(now)) {
      say(kCritical, "Mode change failed: requires position");
      return profile_.refusal;
    }
    if (profile_.wants_proof_of_life && !has_proof_of_life(now)) {
      say(kCritical, "Switching to Offboard is currently not available");
      return profile_.refusal;
    }
    if (!profile_.wants_proof_of_life) {
      target_.reset();  // of an earlier time in this mode
    }
  }
  if (mode == profile_.land_mode) {
    enter_landing(now);
  } else {
    mode_ = mode;
  }
  return kAccepted;
}

void FlightController::enter_landing(Time now) {
  mode_ = profile_.land_mode;
  climb_to_m_.reset();
  landing_at_m_ = estimator_.position_m();
  is_blind_ = !has_position(now);
}

std::uint8_t FlightController::take_off(double height_m) {
  if (!profile_.takes_off_by_command || !is_armed_ || !is_following() ||
      !airframe_.is_on_ground() || !(height_m > 0.0)) {
    return profile_.refusal;
  }
  climb_to_m_ = estimator_.position_m() - Eigen::Vector3d(0.0, 0.0, height_m);
  return kAccepted;
}

void FlightController::take_target(const FlightTarget& target, Time now) {
  if (!targets_since_ || now - target_time_ > kTargetGapMax) {
    targets_since_ = now;
  }
  target_time_ = now;
  // On the ground ArduPilot waits for its take-off command; in the air a target ends it.
  if (profile_.takes_off_by_command && airframe_.is_on_ground()) {
    return;
  }
  // Another kind of target: the controller begins anew, and holds what it does at this moment to be
  // what the wind asks for (ArduCopter 4.6, pva_control_start and init_xy_controller).
  const bool is_other_kind = !target_ ||
                             target.position_m.has_value() != target_->position_m.has_value() ||
                             target.velocity_mps.has_value() != target_->velocity_mps.has_value();
  if (profile_.keeps_braking_on_change && is_other_kind) {
    integral_mps2_.head<2>() = commanded_mps2_.head<2>();
    shaped_mps_ = airframe_.velocity_mps();
  }
  climb_to_m_.reset();
  target_ = target;
}

void FlightController::watch(Time now) {
  const bool is_silent = to_seconds(now - target_time_) > profile_.setpoint_loss_s;
  if (is_following() && is_silent) {
    if (profile_.lands_on_setpoint_loss) {
      say(kCritical, "Failsafe activated: no offboard signal");
      enter_landing(now);
    } else if (target_ && target_->velocity_mps) {
      if (target_->position_m) {
        *target_->position_m += profile_.setpoint_loss_s * *target_->velocity_mps;
      }
      target_->velocity_mps = Eigen::Vector3d::Zero();
      target_->acceleration_mps2.setZero();
      target_->yaw_rate_radps = 0.0;
    }
  }
  const bool is_airborne = is_armed_ && !airframe_.is_on_ground();
  if (is_airborne && estimator_.is_lost(now) && !is_blind_) {
    if (mode_ != profile_.land_mode) {
      say(kCritical, profile_.needs_origin ? "EKF Failsafe: changed to LAND Mode"
                                           : "Failsafe activated: blind land");
    }
    enter_landing(now);
    is_blind_ = true;
  }
  if (is_airborne && airframe_.battery_share() < kBatteryToFly && mode_ != profile_.land_mode) {
    say(kCritical, "Failsafe activated: battery empty");
    enter_landing(now);
  }
  if (!is_armed_) {
    return;
  }
  has_lifted_ = has_lifted_ || !airframe_.is_on_ground();
  if (!has_lifted_ && to_seconds(now - armed_at_) > profile_.idle_disarm_s) {
    say(kWarning, "Disarmed: no take-off");
    stop_motors();
  }
  if (mode_ == profile_.land_mode && airframe_.is_on_ground()) {
    if (!touched_down_) {
      touched_down_ = now;
    }
    if (to_seconds(now - *touched_down_) > profile_.land_disarm_s) {
      stop_motors();
    }
  } else {
    touched_down_.reset();
  }
}

Eigen::Vector3d FlightController::towards(const Eigen::Vector3d& position_m) const {
  return cut(profile_.position_gain_per_s * (position_m - estimator_.position_m()),
             profile_.speed_max_mps, profile_.climb_max_mps);
}

std::optional<Eigen::Vector3d> FlightController::wanted_velocity_mps(Time now) const {
  if (!is_armed_ || to_seconds(now - armed_at_) < profile_.spool_up_s) {
    return std::nullopt;
  }
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  if (mode_ == profile_.land_mode) {
    wanted = is_blind_ ? Eigen::Vector3d::Zero() : towards(landing_at_m_);
    wanted.z() = profile_.land_speed_mps;
    return airframe_.is_on_ground() ? std::nullopt : std::optional(wanted);
  }
  if (climb_to_m_) {
    return towards(*climb_to_m_);
  }
  if (is_following() && target_) {
    if (target_->velocity_mps) {
      wanted = *target_->velocity_mps;
    }
    if (target_->position_m) {
      const double since_s =
          std::clamp(to_seconds(now - target_time_), 0.0, profile_.setpoint_loss_s);
      const Eigen::Vector3d moved_m =
          profile_.carries_targets_on ? Eigen::Vector3d(since_s * wanted) : Eigen::Vector3d::Zero();
      wanted += towards(*target_->position_m + moved_m);
    }
    wanted = cut(wanted, profile_.speed_max_mps, profile_.climb_max_mps);
  }
  const bool stays_down = airframe_.is_on_ground() && wanted.z() > -0.05;
  return stays_down ? std::nullopt : std::optional(wanted);
}

double FlightController::wanted_yaw_rate_radps() const {
  if (!is_following() || !target_ || airframe_.is_on_ground()) {
    return 0.0;
  }
  double rate_radps = target_->yaw_rate_radps;
  if (target_->yaw_rad) {
    rate_radps += kYawGainPerS * wrap_to_pi(*target_->yaw_rad - airframe_.yaw_rad());
  }
  return std::clamp(rate_radps, -kYawRateMaxRadps, kYawRateMaxRadps);
}

void FlightController::control(const std::optional<Eigen::Vector3d>& wanted_mps, double dt_s) {
  if (!wanted_mps) {
    shaped_mps_.setZero();
    integral_mps2_.setZero();
    commanded_mps2_.setZero();
    airframe_.step(false, Eigen::Vector3d::Zero(), 0.0, dt_s);
    return;
  }
  const AutopilotProfile& p = profile_;
  Eigen::Vector3d shaped_rate = Eigen::Vector3d::Zero();
  if (is_following() && target_ && !climb_to_m_) {
    shaped_rate = target_->acceleration_mps2;
  }
  if (p.velocity_shaping_s > 0.0) {
    shaped_rate = cut(shaped_rate + (*wanted_mps - shaped_mps_) / p.velocity_shaping_s,
                      p.acceleration_max_mps2, p.acceleration_max_mps2);
    shaped_mps_ += dt_s * shaped_rate;
  } else {
    shaped_mps_ = *wanted_mps;
  }
  const Eigen::Vector3d error_mps = shaped_mps_ - airframe_.velocity_mps();
  integral_mps2_ = cut(integral_mps2_ + dt_s * p.velocity_integral_per_s2 * error_mps,
                       kIntegralMaxMps2, kIntegralMaxMps2);
  const Eigen::Vector3d gains(p.velocity_gain_per_s, p.velocity_gain_per_s, p.climb_gain_per_s);
  const Eigen::Vector3d acceleration_mps2 =
      cut(p.feed_forward * shaped_rate + gains.cwiseProduct(error_mps) + integral_mps2_,
          p.acceleration_max_mps2, 2.0 * p.acceleration_max_mps2);
  commanded_mps2_ = acceleration_mps2;
  airframe_.step(true, acceleration_mps2, wanted_yaw_rate_radps(), dt_s);
}

void FlightController::step(Time now, double dt_s) {
  now_ = now;
  watch(now);
  control(wanted_velocity_mps(now), dt_s);
  estimator_.move(now, airframe_.position_m(), dt_s);
}

}  // namespace vantage::sim
