#include "sim/crazyflie/crazyflie_supervisor.hpp"

#include <numbers>

#include "wire/crtp/system.hpp"

namespace vantage::sim {
namespace {

namespace info = wire::crtp::info;

constexpr double kPreFlightS = 30.0;
constexpr double kIdleS = 2.0;    // s; a vehicle without thrust for this time has landed
constexpr double kLandedS = 3.0;  // s; time from the landing to disarming
constexpr double kOverS = 0.14;
constexpr double kTiltedS = 1.0;
constexpr double kUprightS = 0.3;
constexpr double kWatchdogS = 1.0;
constexpr double kTiltedRad = std::numbers::pi / 3.0;
constexpr double kOverRad = std::numbers::pi / 2.0;

double since_s(const std::optional<Time>& then, Time now) {
  return then ? to_seconds(now - *then) : 0.0;
}

}  // namespace

bool CrazyflieSupervisor::arm(bool is_to_arm, Time now) {
  if (!is_to_arm) {
    is_armed_ = can_fly_ = false;
    return true;
  }
  if (is_locked_ || is_crashed_ || is_tumbled_) {
    return false;
  }
  is_armed_ = true;
  armed_at_ = now;
  landed_at_.reset();
  return true;
}

bool CrazyflieSupervisor::recover() {
  if (is_tumbled_ || !is_crashed_) {
    return !is_crashed_;
  }
  is_crashed_ = false;
  return true;
}

void CrazyflieSupervisor::stop(Time now) {
  if (!stopped_at_) {
    stopped_at_ = now;
  }
}

void CrazyflieSupervisor::step(const SupervisedFacts& facts, Time now) {
  if (facts.are_motors_running) {
    thrust_at_ = now;
  }
  const auto hold = [now](std::optional<Time>& since, bool holds) {
    since = holds ? since.value_or(now) : std::optional<Time>();
  };
  hold(over_at_, facts.tilt_rad > kOverRad);
  hold(tilted_at_, facts.tilt_rad > kTiltedRad);
  hold(upright_at_, facts.tilt_rad < kTiltedRad);
  if (watchdog_ && since_s(watchdog_, now) > kWatchdogS) {
    stop(now);
  }
  if (now >= next_) {
    next_ = now + kPeriod;
    judge(facts, now);
  }
}

void CrazyflieSupervisor::judge(const SupervisedFacts& facts, Time now) {
  is_tumbled_ = since_s(over_at_, now) > kOverS || since_s(tilted_at_, now) > kTiltedS ||
                (is_tumbled_ && since_s(upright_at_, now) < kUprightS);
  is_locked_ = is_locked_ || stopped_at_.has_value();
  if (is_flying_ && facts.setpoint_age_s && *facts.setpoint_age_s > kLocksS) {
    is_locked_ = true;
  }
  if (is_flying_ && is_tumbled_) {
    is_crashed_ = true;
  }
  const bool was_flying = is_flying_;
  is_flying_ = thrust_at_ && since_s(thrust_at_, now) < kIdleS;
  if (was_flying && !is_flying_) {
    landed_at_ = now;
  }
  if (is_locked_ || is_crashed_) {
    is_armed_ = can_fly_ = false;
    return;
  }
  const bool is_idle = !is_flying_ && since_s(armed_at_, now) > kPreFlightS && !landed_at_;
  if (!arms_itself_ && is_armed_ && (is_idle || since_s(landed_at_, now) > kLandedS)) {
    is_armed_ = false;
    armed_at_.reset();
    landed_at_.reset();
  }
  is_armed_ = is_armed_ || (arms_itself_ && !is_tumbled_);
  can_fly_ = is_armed_ && !is_tumbled_;
}

std::uint16_t CrazyflieSupervisor::bits() const {
  std::uint16_t out = 0;
  const auto set = [&out](std::uint16_t bit, bool is_set) {
    out = static_cast<std::uint16_t>(out | (is_set ? bit : 0U));
  };
  set(info::kCanArm, !is_armed_ && !is_tumbled_ && !is_locked_ && !is_crashed_);
  set(info::kArmed, is_armed_);
  set(info::kAutoArmed, arms_itself_);
  set(info::kCanFly, can_fly_);
  set(info::kFlying, is_flying_);
  set(info::kTumbled, is_tumbled_);
  set(info::kLocked, is_locked_);
  set(info::kCrashed, is_crashed_);
  return out;
}

}  // namespace vantage::sim
