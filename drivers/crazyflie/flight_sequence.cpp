#include "drivers/crazyflie/flight_sequence.hpp"

#include <algorithm>

#include "wire/crtp/system.hpp"

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;
namespace info = wire::crtp::info;

constexpr Duration kArmPeriod = std::chrono::milliseconds(200);
constexpr Duration kDisarmPeriod = std::chrono::milliseconds(500);
constexpr Duration kLandPeriod = std::chrono::milliseconds(40);
// Longest wait for the answer to the command to land. After this time, "set-points end" is sent
// after each command, because the vehicle levels 0.5 s after the last set-point.
constexpr Duration kAnswerMax = std::chrono::milliseconds(250);
constexpr double kLandMps = 0.35;
constexpr double kLandMinS = 1.0;
constexpr double kUnseenHeightM = 1.0;  // m; assumed height of a vehicle that mocap does not show

}  // namespace

void CrazyflieSequence::set_goal(CrazyflieGoal goal) {
  if (goal == goal_) {
    return;
  }
  const bool keeps_release = goal_ == CrazyflieGoal::kArm && goal == CrazyflieGoal::kFly;
  is_released_ = is_released_ && keeps_release;
  is_over_ = is_over_ && keeps_release;
  if (goal == CrazyflieGoal::kGrounded) {
    was_flying_ = false;
  }
  landing_since_.reset();
  is_landing_accepted_ = false;
  last_sent_ = Time{};
  goal_ = goal;
}

bool CrazyflieSequence::is_due(Time now, Duration period) {
  if (now - last_sent_ < period) {
    return false;
  }
  last_sent_ = now;
  return true;
}

bool CrazyflieSequence::is_armed(const CrazyflieTelemetry& telemetry) const {
  const bool may_fly = !telemetry.has(info::kLocked) && !telemetry.has(info::kCrashed);
  if (!telemetry.has(info::kAutoArmed)) {
    return may_fly && telemetry.has(info::kArmed);
  }
  // A vehicle that arms itself is always armed, so only the state of its motors matters.
  return may_fly && (telemetry.has(info::kFlying) || (is_released_ && !is_over_));
}

bool CrazyflieSequence::has_control(const CrazyflieTelemetry& telemetry) const {
  return goal_ == CrazyflieGoal::kFly && is_released_ && !is_over_ &&
         !telemetry.has(info::kHighLevelActive);
}

bool CrazyflieSequence::step(CrazyflieLink& link, const Situation& situation) {
  waiting_for_.reset();
  const bool is_flying = link.telemetry().has(info::kFlying);
  was_flying_ = was_flying_ || is_flying;
  switch (goal_) {
    case CrazyflieGoal::kGrounded:
      return stay_grounded(link, situation);
    case CrazyflieGoal::kArm:
      arm(link, situation);
      return false;
    case CrazyflieGoal::kFly:
      return fly(link, situation);
    case CrazyflieGoal::kLand:
      land(link, situation);
      return false;
    case CrazyflieGoal::kKill:
      kill(link, situation.now);
      return false;
  }
  return false;
}

bool CrazyflieSequence::stay_grounded(CrazyflieLink& link, const Situation& situation) {
  const CrazyflieTelemetry& telemetry = link.telemetry();
  if (telemetry.has(info::kFlying) && !telemetry.has(info::kHighLevelActive) && !situation.is_low) {
    waiting_for_ = "landing of a vehicle that was found flying";
    hand_over(link, situation);
    return false;
  }
  landing_since_.reset();
  is_landing_accepted_ = false;
  const bool is_stationary = !telemetry.has(info::kFlying) || situation.is_low;
  if (telemetry.has(info::kArmed) && !telemetry.has(info::kAutoArmed) && is_stationary &&
      !telemetry.has(info::kHighLevelActive) && is_due(situation.now, kDisarmPeriod)) {
    link.send(crtp::arm_request(false));
  }
  return false;
}

void CrazyflieSequence::arm(CrazyflieLink& link, const Situation& situation) {
  const CrazyflieTelemetry& telemetry = link.telemetry();
  if (is_released_) {
    is_over_ = is_over_ || !telemetry.has(info::kCanFly);
    if (is_over_) {
      waiting_for_ = "a new order, because the vehicle has stopped its motors";
    }
    return;
  }
  if (!situation.may_arm) {
    waiting_for_ = "the preconditions of arming";
    last_sent_ = Time{};
    return;
  }
  const bool was_asked = last_sent_ != Time{};
  if (was_asked && telemetry.has(info::kArmed | info::kCanFly) && !telemetry.has(info::kFlying)) {
    is_released_ = true;
    return;
  }
  waiting_for_ = "the vehicle to arm";
  if (is_due(situation.now, kArmPeriod)) {
    // An old set-point would start and then lock the motors.
    link.send(crtp::encode(crtp::SetpointsEnd{}));
    if (!telemetry.has(info::kAutoArmed)) {
      link.send(crtp::arm_request(true));
    }
  }
}

bool CrazyflieSequence::fly(CrazyflieLink& link, const Situation& situation) {
  const CrazyflieTelemetry& telemetry = link.telemetry();
  const bool is_stopped = telemetry.has(info::kLocked) || telemetry.has(info::kCrashed) ||
                          (telemetry.has_info(situation.now) && !telemetry.has(info::kArmed));
  is_over_ = is_over_ || is_stopped;
  if (is_over_ || !is_released_) {
    waiting_for_ = "a new order, because the vehicle has stopped its motors";
    return false;
  }
  return true;
}

void CrazyflieSequence::land(CrazyflieLink& link, const Situation& situation) {
  const CrazyflieTelemetry& telemetry = link.telemetry();
  const Time now = situation.now;
  const bool is_flying = telemetry.has(info::kFlying) || !telemetry.has_info(now);
  const bool has_landed = was_flying_ && !is_flying;
  const bool is_idle = situation.is_low && landing_since_ && is_landing_accepted_ &&
                       telemetry.has_info(now) && !telemetry.has(info::kHighLevelActive) &&
                       to_seconds(now - *landing_since_) > kLandMinS;
  if (has_landed || is_idle) {
    waiting_for_ = "the motors to stop";
    if (telemetry.has(info::kArmed) && !telemetry.has(info::kAutoArmed) &&
        is_due(now, kDisarmPeriod)) {
      link.send(crtp::arm_request(false));
    }
    return;
  }
  waiting_for_ = "touch-down";
  hand_over(link, situation);
}

// Commands the landing until the high-level commander has control.
void CrazyflieSequence::hand_over(CrazyflieLink& link, const Situation& situation) {
  const CrazyflieTelemetry& telemetry = link.telemetry();
  const Time now = situation.now;
  landing_since_ = landing_since_.value_or(now);
  const auto error = link.high_level_error(crtp::HighLevelCommand::kLand, *landing_since_);
  // The firmware's planner refuses a repeated command if it has accepted the first one.
  is_landing_accepted_ =
      is_landing_accepted_ || error == crtp::kHighLevelOk || error == crtp::kHighLevelRefused;
  if (is_landing_accepted_ && telemetry.has_info(now) && telemetry.has(info::kHighLevelActive)) {
    return;
  }
  if (!is_due(now, kLandPeriod)) {
    return;
  }
  if (!is_landing_accepted_) {
    const double height_m = situation.is_seen             ? situation.height_m
                            : telemetry.has_position(now) ? telemetry.position_world_m().z()
                                                          : kUnseenHeightM;
    crtp::HighLevelHeight landing;
    landing.is_landing = true;
    landing.height_m = situation.ground_m;
    landing.duration_s = std::max(kLandMinS, (height_m - situation.ground_m) / kLandMps);
    link.send(crtp::encode(landing));
  }
  if (is_landing_accepted_ || now - *landing_since_ >= kAnswerMax) {
    link.send(crtp::encode(crtp::SetpointsEnd{}));
  }
}

void CrazyflieSequence::kill(CrazyflieLink& link, Time now) {
  if (link.telemetry().has(info::kLocked) && link.telemetry().has_info(now)) {
    return;
  }
  // One emergency stop may have no effect, so it is repeated until the vehicle reports its lock.
  waiting_for_ = "motors to stop";
  link.send(crtp::supervisor_request(crtp::SupervisorCommand::kEmergencyStop));
  link.send(crtp::legacy_emergency_stop());
  link.send(crtp::arm_request(false));
}

}  // namespace vantage::drivers
