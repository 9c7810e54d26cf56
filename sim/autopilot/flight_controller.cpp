#include "sim/autopilot/flight_controller.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::sim {
namespace {

constexpr std::uint8_t kAccepted = 0;
constexpr std::uint8_t kCritical = 2;
constexpr std::uint8_t kWarning = 4;
constexpr std::uint8_t kInformation = 6;
// flags for attitude, vertical velocity and height, without position
constexpr std::uint16_t kFlagsNotReady = 0x0A5;
// set-points must arrive at more than 2 Hz
constexpr Duration kTargetGapMax = std::chrono::milliseconds(500);
constexpr Duration kProofOfLife = std::chrono::seconds(1);
constexpr double kBatteryToArm = 0.10;
constexpr double kBatteryToFly = 0.03;
constexpr double kIntegralMaxMps2 = 3.0;
constexpr double kSpeedMaxMps = 3.0;

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
                                   const AutopilotSettings& settings,
                                   const AirframeParameters& airframe, std::uint64_t seed,
                                   const Eigen::Vector3d& position_m, double yaw_rad, Time boot)
    : profile_(profile),
      airframe_(airframe, seed, position_m, yaw_rad),
      estimator_(profile.estimator),
      boot_(boot),
      now_(boot),
      mode_(profile.start_mode) {
  set_settings(settings);
}

void FlightController::set_settings(const AutopilotSettings& settings) {
  settings_ = settings;
  estimator_.set_loss(settings.pose_loss_s);
}

void FlightController::take_pose(Time now, Time capture, const Eigen::Vector3d& position_m,
                                 std::uint8_t resets) {
  if (to_seconds(now - boot_) >= profile_.estimator_aligned_s) {
    estimator_.fuse(now, capture, position_m, resets);
  }
}

void FlightController::take_heartbeat(int system_id, Time now) {
  if (system_id == settings_.station_id.value_or(system_id)) {
    station_heartbeat_ = now;
    is_station_lost_ = false;
  }
}

bool FlightController::has_position(Time now) const { return estimator_.is_ready(now); }

std::uint16_t FlightController::estimator_flags(Time now) const {
  namespace bit = wire::mavlink::estimator;
  constexpr double kStaleS = 0.6;
  const bool is_landed = landed_state() == 1;
  std::uint16_t flags = is_landed ? profile_.flags_ground : profile_.flags_air;
  if (!has_position(now)) {
    flags = is_landed ? kFlagsNotReady : profile_.flags_lost;
  } else if (!is_landed && !estimator_.is_fed(now, kStaleS)) {
    flags = profile_.flags_stale;
  }
  const bool has_height = settings_.has_barometer || estimator_.is_fed(now, kStaleS);
  return has_height ? flags : flags & static_cast<std::uint16_t>(~bit::kHeight);
}

std::uint8_t FlightController::landed_state() const {
  const bool has_noticed =
      !is_armed_ || !has_lifted_ ||
      (touched_down_ && to_seconds(now_ - *touched_down_) >= profile_.landed_delay_s);
  if (airframe_.is_on_ground() && has_noticed) {
    return 1;
  }
  if (mode_ == profile_.land_mode) {
    return 4;
  }
  return climb_to_m_ ? 3 : 2;
}

std::vector<std::string> FlightController::arming_problems(Time now) const {
  std::vector<std::string> out;
  const auto add_if = [&out](bool is_so, const char* why) {
    if (is_so) {
      out.emplace_back(why);
    }
  };
  add_if(!fault_.empty(), fault_.c_str());
  const double up_s = to_seconds(now - boot_);
  const bool is_low = airframe_.battery_share() < kBatteryToArm;
  if (!profile_.needs_origin) {
    const bool is_silent = is_following() && !has_proof_of_life(now);
    add_if(is_low, "Arming denied: low battery");
    add_if(!has_position(now) || is_silent,
           "Arming denied: Resolve system health failures first\t");
    return out;
  }
  add_if(!has_position(now), "Arm: Need Alt Estimate");
  add_if(up_s < profile_.accelerometer_delay_s, "Arm: Accels inconsistent");
  add_if(up_s >= profile_.accelerometer_delay_s && up_s < profile_.arm_delay_s,
         "Arm: Gyros inconsistent");
  add_if(!has_position(now), "Arm: EKF attitude is bad");
  add_if(!has_origin_, "Arm: AHRS: waiting for home");
  add_if(!has_position(now), "Arm: VisOdom: not healthy");
  add_if(is_low, "Arm: Battery 1 low");
  return out;
}

std::uint8_t FlightController::arm(Time now) {
  if (is_armed_) {
    return kAccepted;
  }
  const std::vector<std::string> why = arming_problems(now);
  for (const std::string& text : why) {
    queue_text(kCritical, text);
  }
  if (!why.empty()) {
    return profile_.refusal;
  }
  queue_text(kInformation, profile_.arming_text);
  is_armed_ = true;
  is_blind_ = false;
  has_lifted_ = false;
  armed_at_ = now;
  touched_down_.reset();
  return kAccepted;
}

std::uint8_t FlightController::disarm(bool is_forced) {
  if (!is_forced && is_armed_ && !airframe_.is_on_ground()) {
    queue_text(kCritical, "Disarming denied: not landed");
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
  // Before arming, both firmwares accept any mode, even one in which they will refuse to arm.
  if (mode == profile_.follow_mode && mode_ != mode) {
    if (is_armed_ && !has_position(now)) {
      queue_text(kCritical, "Mode change failed: requires position");
      return profile_.refusal;
    }
    if (is_armed_ && profile_.wants_proof_of_life && !has_proof_of_life(now)) {
      queue_text(kCritical, "Switching to Offboard is currently not available");
      return profile_.refusal;
    }
    if (!profile_.wants_proof_of_life) {
      target_.reset();  // drops a set-point from an earlier period in this mode
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
  descends_at_ = now;
  landing_at_m_ = estimator_.position_m() + profile_.landing_ahead_s * airframe_.velocity_mps();
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
  // On the ground, ArduPilot waits for its take-off command; in the air, a set-point ends the
  // take-off.
  if (profile_.takes_off_by_command && airframe_.is_on_ground()) {
    return;
  }
  // When the kind of set-point changes, the controller restarts and attributes its present
  // acceleration to the wind (ArduCopter 4.6, pva_control_start and init_xy_controller).
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

void FlightController::fail_safe(const std::string& why, Time now) {
  queue_text(kCritical, why);
  enter_landing(now);
  descends_at_ = now + from_seconds(profile_.failsafe_pause_s);
}

void FlightController::watch(Time now) {
  check_timeouts(now);
  const bool is_airborne = is_armed_ && !airframe_.is_on_ground();
  lost_since_ = estimator_.is_lost(now) ? std::optional(lost_since_.value_or(now)) : std::nullopt;
  const bool is_over_lost =
      lost_since_ && to_seconds(now - *lost_since_) >= profile_.lost_before_failsafe_s;
  if (is_airborne && is_over_lost && !is_blind_ && settings_.lands_on_pose_loss) {
    fail_safe(profile_.needs_origin ? "EKF Failsafe: changed to LAND Mode" : "Failsafe activated",
              now);
    is_blind_ = true;
  }
  if (is_airborne && airframe_.battery_share() < kBatteryToFly && mode_ != profile_.land_mode) {
    fail_safe("Failsafe activated: battery empty", now);
  }
  if (is_armed_) {
    watch_ground(now);
  }
}

void FlightController::check_timeouts(Time now) {
  const double silent_s = to_seconds(now - target_time_) - profile_.setpoint_check_s;
  if (is_following() && silent_s > settings_.setpoint_loss_s) {
    if (is_armed_ && settings_.lands_on_setpoint_loss) {
      fail_safe("Failsafe activated", now);
    } else if (target_ && target_->velocity_mps) {
      if (target_->position_m) {
        *target_->position_m += settings_.setpoint_loss_s * *target_->velocity_mps;
      }
      target_->velocity_mps = Eigen::Vector3d::Zero();
      target_->acceleration_mps2.setZero();
      target_->yaw_rate_radps = 0.0;
    }
  }
  if (to_seconds(now - station_checked_) < profile_.station_check_s) {
    return;
  }
  station_checked_ = now;
  const bool is_silent = station_heartbeat_ && settings_.heartbeat_loss_s &&
                         to_seconds(now - *station_heartbeat_) > *settings_.heartbeat_loss_s;
  if (is_silent && !is_station_lost_) {
    is_station_lost_ = true;
    if (is_armed_ && airframe_.is_on_ground()) {
      queue_text(kWarning, "GCS Failsafe: Disarming");
      stop_motors();
    } else if (is_armed_) {
      fail_safe("GCS Failsafe", now);
    }
  }
}

void FlightController::watch_ground(Time now) {
  has_lifted_ = has_lifted_ || !airframe_.is_on_ground();
  if (!has_lifted_ && settings_.idle_disarm_s &&
      to_seconds(now - armed_at_) > *settings_.idle_disarm_s) {
    queue_text(kInformation, profile_.idle_text);
    stop_motors();
  }
  const bool stands = has_lifted_ && airframe_.is_on_ground();
  touched_down_ = stands ? std::optional(touched_down_.value_or(now)) : std::nullopt;
  if (stands && mode_ == profile_.land_mode && settings_.land_disarm_s &&
      to_seconds(now - *touched_down_) > profile_.landed_delay_s + *settings_.land_disarm_s) {
    queue_text(kInformation, profile_.landed_text);
    stop_motors();
  }
}

Eigen::Vector3d FlightController::velocity_towards_mps(const Eigen::Vector3d& position_m) const {
  return cut(settings_.position_gain_per_s * (position_m - estimator_.position_m()),
             settings_.speed_max_mps, profile_.climb_max_mps);
}

std::optional<Eigen::Vector3d> FlightController::wanted_velocity_mps(Time now) const {
  if (!is_armed_ || to_seconds(now - armed_at_) < profile_.spool_up_s) {
    return std::nullopt;
  }
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  if (mode_ == profile_.land_mode) {
    // Without poses the autopilot holds its estimated position, so the vehicle moves against the
    // drift.
    wanted =
        is_blind_ ? Eigen::Vector3d(-estimator_.drift_mps()) : velocity_towards_mps(landing_at_m_);
    wanted.z() = now < descends_at_ ? 0.0 : settings_.land_speed_mps;
    return airframe_.is_on_ground() ? std::nullopt : std::optional(wanted);
  }
  if (climb_to_m_) {
    return velocity_towards_mps(*climb_to_m_);
  }
  if (is_following() && target_) {
    if (target_->velocity_mps) {
      wanted = *target_->velocity_mps;
    }
    if (target_->position_m) {
      const double since_s =
          std::clamp(to_seconds(now - target_time_), 0.0, settings_.setpoint_loss_s);
      const Eigen::Vector3d moved_m = profile_.extrapolates_targets
                                          ? Eigen::Vector3d(since_s * wanted)
                                          : Eigen::Vector3d::Zero();
      wanted += velocity_towards_mps(*target_->position_m + moved_m);
    }
    wanted = cut(wanted, profile_.cuts_whole_velocity ? settings_.speed_max_mps : kSpeedMaxMps,
                 profile_.climb_max_mps);
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
    rate_radps += profile_.yaw_gain_per_s * wrap_to_pi(*target_->yaw_rad - airframe_.yaw_rad());
  }
  return std::clamp(rate_radps, -settings_.yaw_rate_max_radps, settings_.yaw_rate_max_radps);
}

void FlightController::control(const std::optional<Eigen::Vector3d>& wanted_mps, double dt_s) {
  if (!wanted_mps) {
    shaped_mps_.setZero();
    integral_mps2_.setZero();
    commanded_mps2_.setZero();
    yaw_rate_radps_ = 0.0;
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
  const double level_gain_per_s = settings_.velocity_gain_per_s;
  const Eigen::Vector3d gains(level_gain_per_s, level_gain_per_s, p.climb_gain_per_s);
  const Eigen::Vector3d acceleration_mps2 =
      cut(p.feed_forward * shaped_rate + gains.cwiseProduct(error_mps) + integral_mps2_,
          p.acceleration_max_mps2, 2.0 * p.acceleration_max_mps2);
  commanded_mps2_ = acceleration_mps2;
  const double share = p.yaw_lag_s > 0.0 ? -std::expm1(-dt_s / p.yaw_lag_s) : 1.0;
  yaw_rate_radps_ += share * (wanted_yaw_rate_radps() - yaw_rate_radps_);
  airframe_.step(true, acceleration_mps2, yaw_rate_radps_, dt_s);
}

void FlightController::step(Time now, double dt_s) {
  now_ = now;
  watch(now);
  control(wanted_velocity_mps(now), dt_s);
  estimator_.move(now, airframe_.position_m(), dt_s);
}

}  // namespace vantage::sim
