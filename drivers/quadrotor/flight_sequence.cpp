#include "drivers/quadrotor/flight_sequence.hpp"

#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

// Duration of set-points before the mode is requested; PX4 requires more than a second.
constexpr Duration kProofOfLife = std::chrono::milliseconds(1500);
constexpr Duration kModePause = std::chrono::seconds(1);
// longer than the other pauses, because the motors spool up first
constexpr Duration kTakeOffPause = std::chrono::seconds(3);
constexpr Duration kArmPause = std::chrono::seconds(2);
constexpr Duration kKillPeriod = std::chrono::milliseconds(100);
// longest time from the sending of an autopilot's report to its reception
constexpr Duration kReportDelayMax = std::chrono::milliseconds(500);
constexpr Duration kDisarmAfterLanding = std::chrono::seconds(5);
constexpr Duration kLeftInTheAir = std::chrono::seconds(1);
constexpr double kClimbedM = 0.25;

wire::mavlink::CommandLong arm_command(bool is_to_arm, bool is_forced = false) {
  wire::mavlink::CommandLong out;
  out.command = wire::mavlink::command::kArmDisarm;
  out.param1 = is_to_arm ? 1.0F : 0.0F;
  out.param2 = is_forced ? wire::mavlink::kForceDisarm : 0.0F;
  return out;
}

}  // namespace

void FlightSequence::set_goal(FlightGoal goal) {
  if (goal == goal_) {
    return;
  }
  if (goal_ == FlightGoal::kGrounded) {
    was_armed_ = false;
    had_mode_ = false;
    streaming_since_.reset();
  }
  // The goals kArm and kFly use the same mode; changing between them does not request a lost mode
  // again.
  const bool keeps_mode = goal_ == FlightGoal::kArm && goal == FlightGoal::kFly;
  if (!keeps_mode) {
    has_mode_ = false;
    is_mode_lost_ = false;
    has_climbed_ = false;
    is_over_ = false;
    on_ground_since_.reset();
  }
  kill_since_.reset();
  goal_ = goal;
}

bool FlightSequence::step(AutopilotLink& link, const Situation& situation) {
  const Telemetry& telemetry = link.telemetry();
  waiting_for_.reset();
  if (!telemetry.is_connected(situation.now) && goal_ != FlightGoal::kKill) {
    // Earlier commands may be lost. Set-points and the command to land are still sent to a flying
    // vehicle: possibly only the link from the autopilot to the driver has failed.
    if (was_armed_ && goal_ == FlightGoal::kLand) {
      is_mode_lost_ = is_pilots(telemetry.mode());
      if (!is_mode_lost_) {
        waiting_for_ = "land mode";
        link.send_command(land_command(dialect_), situation.now, kModePause);
      }
    }
    return was_armed_ && goal_ == FlightGoal::kFly;
  }
  const bool is_armed = telemetry.is_armed() || (was_armed_ && situation.is_flying);
  is_over_ = is_over_ || (was_armed_ && !is_armed);
  was_armed_ = was_armed_ || telemetry.is_armed();
  switch (goal_) {
    case FlightGoal::kGrounded:
      return stay_grounded(link, situation.now);
    case FlightGoal::kArm:
    case FlightGoal::kFly:
      if (is_over_) {
        waiting_for_ = "a new order, because the autopilot has stopped its motors";
        return false;
      }
      return is_armed ? fly(link, situation) : prepare(link, situation);
    case FlightGoal::kLand:
      return land(link, situation.now, is_armed);
    case FlightGoal::kKill:
      kill(link, situation.now);
      return false;
  }
  return false;
}

bool FlightSequence::stay_grounded(AutopilotLink& link, Time now) {
  streaming_since_.reset();
  has_climbed_ = false;
  if (link.commands().is_under_way(arm_command(true).command) && !link.telemetry().is_armed()) {
    // An earlier command to arm may still arrive.
    link.send_command(arm_command(false), now, kArmPause);
  }
  disarm_on_ground(link, now, Duration{0});
  // The vehicle is in the air in follow_mode: an earlier run of this driver left it there. Flight
  // safety makes it hover if the position is known; otherwise this landing ends the flight.
  const Telemetry& telemetry = link.telemetry();
  const bool is_left =
      telemetry.is_armed() && !telemetry.is_on_ground() && telemetry.mode() == traits_.follow_mode;
  left_since_ = is_left ? left_since_.value_or(now) : std::optional<Time>();
  if (is_left && now - *left_since_ > kLeftInTheAir) {
    waiting_for_ = "landing of a vehicle that was found flying";
    link.send_command(land_command(dialect_), now, kModePause);
  }
  return false;
}

bool FlightSequence::prepare(AutopilotLink& link, const Situation& situation) {
  if (!situation.may_arm) {
    waiting_for_ = "the preconditions of arming";
    streaming_since_.reset();
    return false;
  }
  if (!streaming_since_) {
    streaming_since_ = situation.now;
  }
  if (traits_.wants_proof_of_life && situation.now - *streaming_since_ < kProofOfLife) {
    waiting_for_ = "the autopilot to register set-points";
    return true;
  }
  if (link.telemetry().mode() != traits_.follow_mode) {
    waiting_for_ = mode_name(dialect_, traits_.follow_mode) + " mode";
    link.send_command(follow_mode_command(dialect_), situation.now, kModePause);
    return traits_.wants_proof_of_life;
  }
  come_into_mode();
  waiting_for_ = "motors";
  link.send_command(arm_command(true), situation.now, kArmPause);
  return traits_.wants_proof_of_life;
}

bool FlightSequence::fly(AutopilotLink& link, const Situation& situation) {
  const Telemetry& telemetry = link.telemetry();
  if (telemetry.mode() == traits_.follow_mode) {
    come_into_mode();
  } else if (has_mode_ || is_pilots(telemetry.mode())) {
    is_mode_lost_ = true;
    return traits_.wants_proof_of_life;  // set-points are required to enter the mode again
  } else {
    waiting_for_ = mode_name(dialect_, traits_.follow_mode) + " mode";
    if (!streaming_since_) {
      streaming_since_ = situation.now;
    }
    if (!traits_.wants_proof_of_life || situation.now - *streaming_since_ >= kProofOfLife) {
      link.send_command(follow_mode_command(dialect_), situation.now, kModePause);
    }
    return true;
  }
  if (goal_ == FlightGoal::kArm) {
    return traits_.wants_proof_of_life;
  }
  // A low take-off height requires a smaller tolerance than kClimbedM.
  const double climbed_m = std::min(kClimbedM, 0.4 * situation.take_off_height_m);
  has_climbed_ = has_climbed_ || situation.height_error_m < climbed_m || situation.is_landing;
  if (has_climbed_) {
    return true;
  }
  waiting_for_ = "take-off height";
  if (!traits_.takes_off_by_command) {
    return true;
  }
  if (telemetry.is_on_ground() || situation.is_low) {
    wire::mavlink::CommandLong take_off;
    take_off.command = wire::mavlink::command::kTakeOff;
    take_off.param7 = static_cast<float>(situation.take_off_height_m);
    link.send_command(take_off, situation.now, kTakeOffPause);
  }
  return false;
}

bool FlightSequence::land(AutopilotLink& link, Time now, bool is_armed) {
  const Telemetry& telemetry = link.telemetry();
  if (!is_armed) {
    is_over_ = true;
    return false;
  }
  disarm_on_ground(link, now, kDisarmAfterLanding);
  if (telemetry.mode() == traits_.land_mode) {
    come_into_mode();
    waiting_for_ = "touch-down";
    return traits_.wants_proof_of_life;  // set-points are required to steer the landing again
  }
  if (has_mode_ || is_pilots(telemetry.mode())) {
    is_mode_lost_ = true;
    return false;
  }
  waiting_for_ = "land mode";
  link.send_command(land_command(dialect_), now, kModePause);
  return true;
}

void FlightSequence::kill(AutopilotLink& link, Time now) {
  // Heartbeats arrive at 1 Hz: the last one may be older than the latest command to arm.
  const Telemetry& telemetry = link.telemetry();
  kill_since_ = kill_since_.value_or(now);
  const bool is_reported_since =
      telemetry.is_connected(now) && *telemetry.heartbeat_time() - *kill_since_ > kReportDelayMax;
  if (telemetry.is_armed() || !is_reported_since) {
    waiting_for_ = "motors to stop";
    link.send_command_periodically(arm_command(false, true), now, kKillPeriod);
  }
}

void FlightSequence::come_into_mode() {
  has_mode_ = had_mode_ = true;
  is_mode_lost_ = false;
}

bool FlightSequence::is_pilots(std::uint32_t mode) const {
  return had_mode_ && is_flown_by_hand(dialect_, mode);
}

void FlightSequence::disarm_on_ground(AutopilotLink& link, Time now, Duration after) {
  const Telemetry& telemetry = link.telemetry();
  if (!telemetry.is_armed() || !telemetry.is_on_ground()) {
    on_ground_since_.reset();
    return;
  }
  if (!on_ground_since_) {
    on_ground_since_ = now;
  }
  if (now - *on_ground_since_ >= after) {
    link.send_command(arm_command(false), now, kArmPause);
  }
}

}  // namespace vantage::drivers
