#include "drivers/safety/guard_parts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/angle.hpp"
#include "drivers/safety/latches.hpp"
#include "drivers/safety/surroundings.hpp"

namespace vantage::drivers {

using models::FlightState;

namespace {

// m/s; maximum velocity error in normal flight; above it an external push is assumed
constexpr double kVelocityErrorMaxMps = 0.6;
constexpr double kSameSpeedMps = 0.1;     // m/s; speeds that differ by less count as equal
constexpr double kClearanceMps = 0.2;     // m/s; speed of a shift away from fence or obstacle
constexpr double kShiftPatienceS = 6.0;   // s; then a landing descends even if not over its spot
constexpr double kAvoidPatienceS = 20.0;  // s; then a landing descends even if a body is below
constexpr double kCommitM = 0.35;  // m; a landing that begins lower does not wait or move aside
constexpr double kEstimatorGapMaxS = 0.2;  // s; longer than the gap of one lost estimator report
constexpr double kOverSpotM = 0.25;
constexpr double kFallsMps = 1.0;  // m/s; faster than any landing
constexpr int kDisarmedBeats = 3;
constexpr double kClimbedM = 0.15;    // m; the climb ends at this distance from its goal
constexpr double kClimbSlackS = 5.0;  // s; a climb ends after twice its duration plus this
// assumed share of the descent rate while no measurement is available
constexpr double kBlindSinkShare = 0.4;

}  // namespace

bool FlightGuard::Parts::keeps_to_course(Time now) const {
  const Setpoint commanded = course.at(now);
  return course.is_on_plan() && pose_age_s(now) < limits.pose_age_land_s &&
         (pose.velocity_world_mps() - commanded.velocity_world_mps).norm() <=
             kVelocityErrorMaxMps &&
         (pose.predict_m(now, kPredictS) - commanded.position_world_m).norm() <=
             limits.tracking_hold_m;
}

// A stop follows the plan's curve only if the plan has constant speed there and the vehicle has
// reached this speed. Otherwise the set-points differ from the plan, because their speed changes
// gradually.
bool FlightGuard::Parts::has_planned_speed(Time now) const {
  const double commanded_mps = course.at(now).velocity_world_mps.norm();
  if (commanded_mps > 2.0 * pose.velocity_world_mps().norm() + kSameSpeedMps) {
    return false;  // commanded to move a moment ago: the stop must not start the plan's motion
  }
  const double half_brake_s = 0.5 * commanded_mps / limits.vehicle.brake_mps2;
  const auto differs = [&](const Setpoint& planned) {
    return std::abs(planned.velocity_world_mps.norm() - commanded_mps) > kSameSpeedMps;
  };
  return !differs(course.planned_at(now)) &&
         !differs(course.planned_at(now + from_seconds(half_brake_s)));
}

BrakingPath FlightGuard::Parts::braking_path(Time now, double reaction_s) const {
  const Eigen::Vector3d here_m = pose.predict_m(now, kPredictS);
  if (keeps_to_course(now) && (reaction_s > 0.0 || has_planned_speed(now))) {
    const Eigen::Vector3d offset_m = here_m - course.planned_at(now).position_world_m;
    return BrakingPath::along(course.plan(), std::max(0.0, course.elapsed_s(now)),
                              limits.vehicle.brake_mps2, reaction_s, offset_m);
  }
  return BrakingPath::straight(here_m, pose.velocity_world_mps(), course.at(now).yaw_rad,
                               limits.vehicle.brake_mps2, reaction_s);
}

// Returns false if the motors are assumed to be off. While mocap shows the body flying, a report of
// disarmed motors is ignored, since it may be from another vehicle. Without a pose, kDisarmedBeats
// reports are required.
bool FlightGuard::Parts::is_assumed_armed(Time now) const {
  if (autopilot.armed || !in.autopilot_armed || !is_airborne(ladder.state)) {
    return autopilot.armed;
  }
  if (pose_age_s(now) <= limits.pose_age_hold_s) {
    const bool is_down = pose.predict_m(now, kPredictS).z() < limits.safe_height_m;
    return !is_down && pose.velocity_world_mps().z() > -kFallsMps;
  }
  return disarmed_beats < kDisarmedBeats;
}

// Returns the height error against the set-point, m. The error is 0 during a descent, and during a
// take-off at any height between start and goal: the autopilot may choose its climb rate.
double FlightGuard::Parts::height_error_m() const {
  if (ladder.state == FlightState::kLand && is_sinking) {
    return 0.0;
  }
  if (is_climbing) {
    return std::max({0.0, climb_from_m - in.height_m, in.height_m - height_goal_m});
  }
  return std::abs(in.height_m - height_ref_m);
}

// Fills `in` with the state at `now`. long: later inputs use earlier inputs
void FlightGuard::Parts::update_inputs(Time now) {
  started_at = has_ticked ? started_at : now;
  in.autopilot_armed = is_assumed_armed(now);
  update_common_inputs(now);
  in.telemetry_age_s = has_telemetry ? to_seconds(now - telemetry_at) : kNever;
  const Eigen::Vector3d here_m = pose.predict_m(now, kPredictS);
  const bool has_recent_pose = in.pose_age_s <= limits.pose_age_hold_s;
  const bool has_estimate = autopilot.has_position && autopilot.estimator_good &&
                            in.telemetry_age_s <= limits.telemetry_age_hold_s;
  if (has_recent_pose) {
    blind_height_m = here_m.z();
    in.height_m = here_m.z();
  } else {
    in.height_m = has_estimate ? autopilot.position_world_m.z() : blind_height_m;
  }
  // Detects a vehicle in the air by mocap or, after a long time without a pose, by the autopilot's
  // estimate.
  const bool is_unseen =
      std::min(in.pose_age_s, to_seconds(now - started_at)) > limits.pose_age_land_s;
  const bool is_found = ladder.state == FlightState::kIdle && !ladder.wants_armed &&
                        in.autopilot_armed && in.telemetry_age_s <= limits.telemetry_age_hold_s &&
                        in.height_m - ground_m.value_or(0.0) > limits.safe_height_m &&
                        (has_recent_pose || (is_unseen && has_estimate));
  if (ladder.state == FlightState::kIdle && has_heartbeat && !autopilot.armed && has_recent_pose) {
    ground_m = in.height_m;
  }
  in.is_found_flying = is_found && autopilot.is_in_our_mode;
  in.is_found_landing = is_found && autopilot.is_landing_itself;
  has_flown = has_flown || is_found;
  const bool airborne = is_airborne(ladder.state) || in.is_found_flying || in.is_found_landing;
  // In the air, the age of a message that was never received counts from the start of this process,
  // which may have begun just now.
  const auto aged = [&](double age_s) {
    return age_s == kNever && airborne ? to_seconds(now - started_at) : age_s;
  };
  const auto age = [&](bool is_received, Time at) {
    return aged(is_received ? to_seconds(now - at) : kNever);
  };
  in.pose_age_s = aged(in.pose_age_s);
  in.telemetry_age_s = aged(in.telemetry_age_s);
  in.operator_age_s = aged(in.operator_age_s);
  in.speed_mps = has_recent_pose ? pose.velocity_world_mps().head<2>().norm() : 0.0;
  in.tracking_error_m = 0.0;
  if (is_airborne(ladder.state) && has_recent_pose) {
    const Eigen::Vector3d commanded_m = course.at(now).position_world_m;
    const Eigen::Vector3d on_time_m = course.on_time(now).position_world_m;
    const double level_m = std::max((here_m - commanded_m).head<2>().norm(),
                                    (on_time_m - commanded_m).head<2>().norm());
    in.tracking_error_m = std::hypot(level_m, height_error_m());
  }
  if (pose.has_pose()) {
    const auto bodies = fleet.bodies(now, limits);
    static_cast<Surroundings&>(in) =
        compute_surroundings(here_m, braking_path(now, limits.reaction_s), bodies, limits);
    in.near_m = predicted_distance_m(here_m, bodies, limits.take_off_prediction_s);
    if (std::exchange(had_motors, in.autopilot_armed) != in.autopilot_armed) {
      lift_queue.begin_turn(now);  // another vehicle's motors may have changed simultaneously
    }
    lift_queue.update(bodies, limits, now);
  }
  update_autopilot_inputs(now);
  update_lift_inputs(now);
  update_identity_inputs(now);

  in.heartbeat_age_s = age(has_heartbeat, heartbeat_at);
  in.battery_share = battery_share;
  in.battery_age_s = age(has_battery, battery_at);
  in.flight_s = is_airborne(ladder.state) ? to_seconds(now - airborne_at) : 0.0;
  in.battery_unchanged_s =
      has_battery ? std::min(in.flight_s, to_seconds(now - battery_changed_at)) : 0.0;
}

// Fills the inputs from the autopilot's report, and from its differences to mocap.
void FlightGuard::Parts::update_autopilot_inputs(Time now) {
  in.autopilot_obeys = autopilot.obeys;
  in.is_flown_by_hand = autopilot.is_flown_by_hand;
  in.estimator_good = autopilot.estimator_good;
  estimator_good_at = in.estimator_good ? now : estimator_good_at;
  in.tilt_rad = autopilot.tilt_rad;
  in.motor_failed = autopilot.motor_failed;
  in.estimate_error_m = in.attitude_error_rad = in.yaw_error_rad = 0.0;
  const Quaternion& measured = pose.world_from_body().rotation;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  in.body_tilt_rad = pose.has_pose() ? std::acos(std::clamp((measured * up).z(), -1.0, 1.0)) : 0.0;
  in.start_off_m = in.start_turn_rad = 0.0;
  if (limits.start && pose.has_pose() && !has_flown) {
    // On-board sensors cannot detect a rotated mocap frame, so the start pose is compared with the
    // scenario.
    const Pose2 here = flatten(pose.world_from_body());
    in.start_off_m = (here.position_m() - limits.start->position_m()).norm();
    in.start_turn_rad = std::abs(wrap_to_pi(here.yaw_rad - limits.start->yaw_rad));
  }
  const bool can_compare = autopilot.has_position && autopilot.estimator_good &&
                           in.telemetry_age_s <= limits.telemetry_age_hold_s &&
                           in.pose_age_s <= limits.pose_age_warn_s;
  if (!can_compare) {
    return;
  }
  in.estimate_error_m = (autopilot.position_world_m - pose.predict_m(now, kPredictS)).norm();
  if (!autopilot.has_attitude) {
    in.attitude_error_rad = in.yaw_error_rad = kNever;
    return;
  }
  const Quaternion& estimated = autopilot.world_from_body;
  const double cosine = (measured.inverse() * up).dot(estimated.inverse() * up);
  in.attitude_error_rad = std::acos(std::clamp(cosine, -1.0, 1.0));
  in.yaw_error_rad = std::abs(wrap_to_pi(flatten(pose.world_from_body()).yaw_rad -
                                         flatten({Eigen::Vector3d::Zero(), estimated}).yaw_rad));
}

// Fills the inputs about the take-offs of this vehicle and of others.
void FlightGuard::Parts::update_lift_inputs(Time now) {
  const Eigen::Vector3d here_m = pose.predict_m(now, kPredictS);
  const bool has_recent_pose = in.pose_age_s <= limits.pose_age_hold_s;
  const bool is_armed_on_ground =
      ladder.state == FlightState::kIdle && ladder.wants_armed && in.autopilot_armed;
  unarmed_height_m = is_armed_on_ground ? unarmed_height_m : in.height_m;
  in.unordered_rise_m =
      is_armed_on_ground && has_recent_pose ? in.height_m - unarmed_height_m : 0.0;
  in.is_lift_blocked = lift_queue.is_blocked();
  in.no_rise_s = lift.no_rise_s(here_m, limits, now);
  in.proof_pending_s = lift.proof_pending_s(now);
  in.other_risen_m = in.no_rise_s > 0.0 ? lift_queue.other_risen_m() : 0.0;
  const Eigen::Vector3d soon_m = here_m + limits.reaction_s * pose.velocity_world_mps();
  in.lift_deviation_m =
      has_recent_pose ? std::max(lift.deviation_m(here_m), lift.deviation_m(soon_m)) : 0.0;
  in.lift_climb_error_mps = in.lift_turn_error_radps = 0.0;
  const bool can_compare = lift.is_under_way() && has_recent_pose && autopilot.has_position &&
                           in.telemetry_age_s <= limits.telemetry_age_hold_s;
  if (can_compare) {
    in.lift_climb_error_mps =
        std::abs(autopilot.velocity_world_mps.z() - pose.velocity_world_mps().z());
    in.lift_turn_error_radps = std::abs(autopilot.yaw_rate_radps - pose.turn_radps());
  }
}

// Performs the actions that a change of state requires.
void FlightGuard::Parts::on_state_change(FlightState before, Time now) {
  const FlightState state = ladder.state;
  if (!is_airborne(before) && is_airborne(state)) {
    airborne_at = now;
    const Pose2 here = flatten(pose.world_from_body());
    course.hover(pose.world_from_body().translation_m, here.yaw_rad, now);
    height_ref_m = height_goal_m = in.height_m;
    if (!in.is_found_flying && !in.is_found_landing) {
      lift_off(now);
    }
  }
  const bool lands = state == FlightState::kLand && before != FlightState::kLand;
  const bool leaves_plan = before == FlightState::kFollow || (lands && course.is_on_plan());
  if (leaves_plan && is_airborne(state)) {
    if (in.plan_ended && course.is_on_plan() && !course.has_next()) {
      // Hovers at the plan's final hover position, which was checked with the plan.
      const Setpoint end = course.at(now);
      course.hover(end.position_world_m, end.yaw_rad, now);
    } else {
      course.stop(braking_path(now, 0.0), now);
    }
  }
  if (lands || !is_airborne(state)) {
    lift.end();
    is_climbing = false;
  }
  if (lands) {
    course.forget_next();
    landing_since = spot_since = now;
    has_spot = false;
    is_sinking = false;
    // Ends a climb. Near the ground, an immediate descent is the shortest landing.
    height_ref_m = height_goal_m = std::min(height_ref_m, in.height_m);
    is_committed = in.height_m < kCommitM;
  }
}

void FlightGuard::Parts::lift_off(Time now) {
  lift.begin(pose.world_from_body(), fleet.bodies(now, limits), limits, now);
  lift_queue.begin_own();
  height_ref_m = climb_from_m = lift.rest_m();
  height_goal_m = lift.height_m();
  is_climbing = true;
  climb_since = now;
}

// Moves a hovering vehicle away from a fence or obstacle that a gust could make it touch.
void FlightGuard::Parts::restore_clearance(Time now) {
  if (lift.is_under_way() || !course.is_hovering(now) || in.pose_age_s > limits.pose_age_warn_s ||
      !in.estimator_good) {
    return;
  }
  // During a climb the course has the start height; the vehicle is higher.
  const Eigen::Vector3d hover_m = course.at(now).position_world_m;
  const Eigen::Vector3d here_m(hover_m.x(), hover_m.y(), in.height_m);
  if (const auto clear_m = clear_spot(here_m, fleet.bodies(now, limits), limits)) {
    course.shift({clear_m->x(), clear_m->y(), hover_m.z()}, kClearanceMps, now);
  }
}

bool FlightGuard::Parts::is_blind() const {
  return distrusts_pose || in.pose_age_s > limits.pose_age_kill_s ||
         to_seconds(in.now - estimator_good_at) > kEstimatorGapMaxS;
}

// Stops, moves to a landing spot and descends. Stops the descent if a body enters below, unless the
// landing is committed (low or of long duration) or blind.
void FlightGuard::Parts::land(Time now, double dt_s) {
  const Eigen::Vector3d here_m = pose.predict_m(now, kPredictS);
  const bool has_recent_pose = in.pose_age_s <= limits.pose_age_hold_s;
  const bool was_committed = is_committed;
  is_committed = is_committed || (is_sinking && in.height_m < limits.safe_height_m) ||
                 to_seconds(now - landing_since) > kAvoidPatienceS;
  const auto bodies = fleet.bodies(now, limits);
  const Setpoint commanded = course.at(now);
  const Eigen::Vector3d hover_m(commanded.position_world_m.x(), commanded.position_world_m.y(),
                                here_m.z());
  const Eigen::Vector3d level_spot_m(spot_m.x(), spot_m.y(), here_m.z());
  const bool is_below_us = is_occupied_below(here_m, bodies, limits);
  const bool is_free = !is_below_us && !is_occupied_below(hover_m, bodies, limits);
  if (is_committed) {
    if (!was_committed && !course.is_hovering(now)) {
      course.stop(braking_path(now, 0.0), now);
    }
  } else if (has_recent_pose && course.is_hovering(now)) {
    if (!has_spot || !is_free) {
      spot_m = landing_spot(is_below_us ? here_m : hover_m, bodies, limits);
      spot_m.z() = commanded.position_world_m.z();
      if ((spot_m - commanded.position_world_m).norm() > 1e-6) {
        course.shift(spot_m, kShiftMps, now);
        spot_since = now;
      }
      has_spot = true;
    }
  } else if (has_recent_pose && has_spot &&
             is_path_blocked(hover_m, level_spot_m, bodies, limits)) {
    course.stop(braking_path(now, 0.0), now);
    has_spot = false;
  }
  const bool is_there = course.is_hovering(now) && (has_spot || !has_recent_pose) &&
                        ((here_m - course.at(now).position_world_m).head<2>().norm() < kOverSpotM ||
                         to_seconds(now - spot_since) > kShiftPatienceS);
  if ((is_there && is_free) || is_committed || is_blind()) {
    is_sinking = true;
    // goal below the floor: contact with the ground ends the descent
    height_goal_m = -limits.descent_mps;
    const bool is_low = height_ref_m < limits.low_height_m;
    const double sink_m = (is_low ? limits.low_descent_mps : limits.descent_mps) * dt_s;
    height_ref_m = std::max({height_goal_m, height_ref_m - sink_m, in.height_m - 0.5});
    blind_height_m = std::max(0.0, blind_height_m - kBlindSinkShare * sink_m);
  } else if (is_sinking) {
    is_sinking = false;
    height_ref_m = std::max(height_ref_m, in.height_m);  // the set-point was lower than the vehicle
  }
}

void FlightGuard::Parts::move_height(double dt_s) {
  if (lift.is_under_way() && in.pose_age_s <= limits.pose_age_warn_s) {
    const Pose3& body = pose.world_from_body();
    if (lift.step(body.translation_m, flatten(body).yaw_rad, course, limits, in.now)) {
      has_flown = true;
      height_goal_m = limits.take_off_height_m;
      climb_since = in.now;
    }
  } else if (is_climbing && !lift.is_under_way()) {
    const double climb_s = (height_goal_m - climb_from_m) / limits.climb_mps;
    is_climbing = std::abs(in.height_m - height_goal_m) > kClimbedM &&
                  to_seconds(in.now - climb_since) < kClimbSlackS + 2.0 * climb_s;
  }
  if (ladder.state == FlightState::kFollow && course.is_on_plan()) {
    height_goal_m = course.plan().height_m;
  }
  const bool climbs_on = is_climbing && !lift.is_under_way() && height_ref_m < height_goal_m;
  if (climbs_on && is_climb_blocked(pose.predict_m(in.now, kPredictS), height_goal_m,
                                    fleet.bodies(in.now, limits), limits)) {
    climb_since = in.now;  // the other vehicle climbs first
    return;
  }
  // The descent is limited to the velocity of the set-point.
  const double up_m = limits.climb_mps * dt_s;
  const double down_m = std::min(limits.climb_mps, limits.descent_mps) * dt_s;
  height_ref_m += std::clamp(height_goal_m - height_ref_m, -down_m, up_m);
}

FlightSetpoint FlightGuard::Parts::setpoint(Time now) const {
  FlightSetpoint out;
  switch (ladder.state) {
    case FlightState::kIdle:
      return out;
    case FlightState::kKilled:
      out.kind = FlightSetpoint::Kind::kMotorsOff;
      return out;
    case FlightState::kLand:
      if (is_blind()) {
        out.kind = FlightSetpoint::Kind::kBlindLand;
        return out;
      }
      break;
    case FlightState::kFollow:
    case FlightState::kHold:
      break;
  }
  // Position and velocity refer to the same instant, so they are consistent. The acceleration has a
  // separate lead: the vehicle must tilt first, and a late acceleration causes a velocity error.
  const Setpoint soon = course.at(now + from_seconds(limits.setpoint_lead_s));
  const Setpoint then = course.at(now + from_seconds(limits.acceleration_lead_s));
  out.kind = FlightSetpoint::Kind::kTrack;
  static_cast<Setpoint&>(out) = soon;
  out.position_world_m.z() = height_ref_m + limits.setpoint_lead_s * height_rate_mps;
  out.velocity_world_mps.z() = height_rate_mps;
  out.acceleration_world_mps2 = then.acceleration_world_mps2;
  return out;
}

bool FlightGuard::Parts::may_take_plans() const {
  if (ladder.state == FlightState::kFollow) {
    return true;
  }
  return ladder.state == FlightState::kHold && ladder.wants_follow && !is_climbing &&
         !waits_for_more_than_a_plan(conditions(), ladder.latched);
}

}  // namespace vantage::drivers
