#include "drivers/quadrotor/safety/guard.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "drivers/quadrotor/safety/authority.hpp"
#include "drivers/quadrotor/safety/course.hpp"
#include "drivers/quadrotor/safety/fleet.hpp"
#include "drivers/quadrotor/safety/pose_monitor.hpp"
#include "drivers/quadrotor/safety/surroundings.hpp"

namespace vantage::drivers {

using models::FlightState;

namespace {

constexpr double kPredictS = 0.1;     // how far the own pose is carried on
constexpr double kLatencyMaxS = 1.0;  // beyond it, clocks were set, not frames late
constexpr double kMovingMps = 0.1;
constexpr double kShiftMps = 0.4;        // to a landing spot
constexpr double kShiftPatienceS = 6.0;  // then it comes down where it is
constexpr double kOverSpotM = 0.25;
constexpr double kBlindSinkShare = 0.6;  // of the descent rate, believed while nothing measures it

bool is_sound(const AutopilotReport& report) {
  return std::isfinite(report.tilt_rad) && std::isfinite(report.thrust_share) &&
         (!report.has_position || report.position_world_m.allFinite());
}

}  // namespace

struct FlightGuard::Parts {
  Parts(const models::Scenario& scenario, const std::string& robot, const SafetyLimits& given)
      : name(robot), limits(given), fleet(scenario, robot) {}

  [[nodiscard]] double pose_age_s(Time now) const { return pose.age_s(now); }
  [[nodiscard]] BrakeWay brake_way(Time now, double reaction_s) const;
  [[nodiscard]] bool keeps_to_course(Time now) const;
  void look(Time now);
  void change(FlightState before, Time now);
  void land(Time now, double dt_s);
  void move_height(double dt_s);
  [[nodiscard]] FlightSetpoint setpoint(Time now) const;
  [[nodiscard]] bool may_take_plans() const;

  std::string name;
  SafetyLimits limits;
  Fleet fleet;
  PoseMonitor pose;
  PlannerLease lease;
  OperatorAuthority authority;
  Course course;
  LadderState ladder;
  SafetyInputs in;
  Reasons reasons;
  Time last_tick{};
  bool has_ticked = false;

  // Heights.
  double height_ref_m = 0.0;
  double height_goal_m = 0.0;
  double blind_height_m = 0.0;
  Time landing_since{};
  bool has_spot = false;

  // What was heard.
  AutopilotReport autopilot;
  Time heartbeat_at{}, telemetry_at{}, battery_at{}, battery_changed_at{}, airborne_at{};
  bool has_heartbeat = false, has_telemetry = false, has_battery = false;
  double battery_share = 1.0;
  double latency_s = 0.0;
  bool map_differs = false;
  bool emergency_stop = false;
  std::optional<models::OperatorAction> request;

  // Plans.
  bool has_accepted = false;
  Time newest_start{}, accepted_at{};
  std::int64_t plan_run = 0, plan_sequence = -1, plan_round = -1;
  int plans_late = 0, plans_refused = 0;

  std::array<std::int64_t, kPlanVerdicts> plan_counts{};
  std::array<std::int64_t, kPoseVerdicts> pose_counts{};
  std::int64_t clocks_refused = 0, reports_refused = 0, commands_refused = 0, stalls = 0;
};

bool FlightGuard::Parts::keeps_to_course(Time now) const {
  return course.is_on_plan() && pose_age_s(now) < limits.pose_age_land_s &&
         (pose.predict_m(now, kPredictS) - course.at(now).position_world_m).norm() <=
             limits.tracking_hold_m;
}

BrakeWay FlightGuard::Parts::brake_way(Time now, double reaction_s) const {
  const Eigen::Vector3d here_m = pose.predict_m(now, kPredictS);
  // One that has only just been told to go is not carried on by a plan that it must not begin.
  const double asked_mps = course.at(now).velocity_world_mps.norm();
  const bool sets_off =
      reaction_s <= 0.0 && asked_mps > 2.0 * pose.velocity_world_mps().norm() + 0.1;
  if (keeps_to_course(now) && !sets_off) {
    const Eigen::Vector3d offset_m = here_m - course.at(now).position_world_m;
    return BrakeWay::along(course.plan(), std::max(0.0, course.elapsed_s(now)),
                           limits.vehicle.brake_mps2, reaction_s, offset_m);
  }
  return BrakeWay::straight(here_m, pose.velocity_world_mps(), course.at(now).yaw_rad,
                            limits.vehicle.brake_mps2, reaction_s);
}

// Fills `in` with what is known at `now`.
void FlightGuard::Parts::look(Time now) {
  const auto age = [now](bool heard, Time at) { return heard ? to_seconds(now - at) : kNever; };
  const bool airborne = is_airborne(ladder.state);
  in.now = now;
  in.since_last_tick_s = has_ticked ? to_seconds(now - last_tick) : 0.0;
  in.pose_age_s = pose_age_s(now);
  in.pose_latency_s = latency_s;
  in.poses_rejected = pose.rejected_in_row();
  in.poses_accepted = pose.accepted_in_row();

  const Eigen::Vector3d here_m = pose.predict_m(now, kPredictS);
  const bool sees = in.pose_age_s <= limits.pose_age_hold_s;
  in.telemetry_age_s = age(has_telemetry, telemetry_at);
  const bool feels = autopilot.has_position && autopilot.estimator_good &&
                     in.telemetry_age_s <= limits.telemetry_age_hold_s;
  if (sees) {
    blind_height_m = here_m.z();
    in.height_m = here_m.z();
  } else {
    in.height_m = feels ? autopilot.position_world_m.z() : blind_height_m;
  }
  in.tracking_error_m = 0.0;
  if (airborne && sees) {
    const Eigen::Vector3d asked_m = course.at(now).position_world_m;
    const Eigen::Vector3d on_time_m = course.on_time(now).position_world_m;
    in.tracking_error_m =
        std::max((here_m - asked_m).head<2>().norm(), (on_time_m - asked_m).head<2>().norm());
  }
  in.has_plan = course.is_on_plan();
  in.plan_ended = !course.has_plan(now);
  in.plan_age_s = age(has_accepted, accepted_at);
  in.planner_age_s = lease.age_s(now);
  in.plans_late = plans_late;
  in.plans_refused = plans_refused;
  in.second_planner = lease.is_contested(now, limits.planner_lease_s);
  in.map_differs = map_differs;

  if (pose.has_pose()) {
    const Surroundings around =
        look_around(here_m, brake_way(now, limits.reaction_s), fleet.bodies(now, limits), limits);
    in.fence_now_m = around.fence_now_m;
    in.fence_centre_m = around.fence_centre_m;
    in.fence_stop_m = around.fence_stop_m;
    in.obstacle_stop_m = around.obstacle_stop_m;
    in.separation_now_m = around.separation_now_m;
    in.separation_stop_m = around.separation_stop_m;
    in.yields = around.yields;
  }

  in.autopilot_armed = autopilot.armed;
  in.autopilot_obeys = autopilot.obeys;
  in.heartbeat_age_s = age(has_heartbeat, heartbeat_at);
  in.estimator_good = autopilot.estimator_good;
  in.estimate_error_m = feels && in.pose_age_s <= limits.pose_age_warn_s
                            ? (autopilot.position_world_m - here_m).norm()
                            : 0.0;
  in.tilt_rad = autopilot.tilt_rad;
  in.thrust_share = autopilot.thrust_share;
  in.motor_failed = autopilot.motor_failed;
  in.battery_share = battery_share;
  in.battery_age_s = age(has_battery, battery_at);
  in.flight_s = airborne ? to_seconds(now - airborne_at) : 0.0;
  in.battery_unchanged_s =
      airborne && has_battery ? std::min(in.flight_s, to_seconds(now - battery_changed_at)) : 0.0;
  in.operator_age_s = authority.age_s(now);
  in.emergency_stop = emergency_stop;
  in.request = request;
}

// What begins when the state changes.
void FlightGuard::Parts::change(FlightState before, Time now) {
  const FlightState state = ladder.state;
  if (!is_airborne(before) && is_airborne(state)) {
    airborne_at = now;
    const Pose2 here = flatten(pose.world_from_body());
    course.stand(pose.world_from_body().translation_m, here.yaw_rad, now);
    height_ref_m = pose.world_from_body().translation_m.z();
    height_goal_m = limits.take_off_height_m;
  }
  if (before == FlightState::kFollow && is_airborne(state)) {
    if (in.plan_ended && course.is_on_plan() && !course.has_next()) {
      // The plan's own hover, which was checked with it.
      const PlanPoint end = course.at(now);
      course.stand(end.position_world_m, end.yaw_rad, now);
    } else {
      course.stop(brake_way(now, 0.0), now);
    }
  }
  if (state == FlightState::kLand && before != FlightState::kLand) {
    landing_since = now;
    has_spot = false;
  }
}

// Stops, moves to where it may come down, comes down.
void FlightGuard::Parts::land(Time now, double dt_s) {
  const bool has_patience = to_seconds(now - landing_since) < kShiftPatienceS &&
                            in.pose_age_s < limits.pose_age_kill_s && in.estimator_good;
  const Eigen::Vector3d here_m = pose.predict_m(now, kPredictS);
  if (course.is_standing(now) && has_patience) {
    Eigen::Vector3d hover_m = course.at(now).position_world_m;
    hover_m.z() = here_m.z();
    const auto bodies = fleet.bodies(now, limits);
    if (!has_spot || is_occupied_below(hover_m, bodies, limits)) {
      Eigen::Vector3d spot_m = landing_spot(hover_m, bodies, limits);
      spot_m.z() = course.at(now).position_world_m.z();
      if ((spot_m - course.at(now).position_world_m).norm() > 1e-6) {
        course.shift(spot_m, kShiftMps, now);
      }
      has_spot = true;
    }
  }
  const bool is_there = has_spot && course.is_standing(now) &&
                        (here_m - course.at(now).position_world_m).head<2>().norm() < kOverSpotM;
  if (is_there || !has_patience) {
    height_goal_m = -limits.descent_mps;  // through the floor: the ground ends it
    const double sink_m = limits.descent_mps * dt_s;
    height_ref_m = std::max({height_goal_m, height_ref_m - sink_m, in.height_m - 0.5});
    blind_height_m = std::max(0.0, blind_height_m - kBlindSinkShare * sink_m);
  }
}

void FlightGuard::Parts::move_height(double dt_s) {
  if (ladder.state == FlightState::kFollow && course.is_on_plan()) {
    height_goal_m = course.plan().height_m;
  }
  const double step_m = limits.climb_mps * dt_s;
  height_ref_m += std::clamp(height_goal_m - height_ref_m, -step_m, step_m);
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
      if (!in.estimator_good || in.pose_age_s > limits.pose_age_kill_s) {
        out.kind = FlightSetpoint::Kind::kBlindLand;
        return out;
      }
      break;
    case FlightState::kFollow:
    case FlightState::kHold:
      break;
  }
  const PlanPoint asked = course.at(now);
  out.kind = FlightSetpoint::Kind::kTrack;
  out.position_world_m = asked.position_world_m;
  out.position_world_m.z() = height_ref_m;
  out.velocity_world_mps = asked.velocity_world_mps;
  out.yaw_rad = asked.yaw_rad;
  out.yaw_rate_radps = asked.yaw_rate_radps;
  return out;
}

bool FlightGuard::Parts::may_take_plans() const {
  if (ladder.state == FlightState::kFollow) {
    return true;
  }
  if (ladder.state != FlightState::kHold || !ladder.wants_follow) {
    return false;
  }
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // What ends with a plan cannot wait for one.
    const bool ends_with_plan = rows[i].clearing == Clearing::kAtOnce;
    if (ladder.latched[i] && rows[i].severity != Severity::kNote && !ends_with_plan) {
      return false;
    }
  }
  return true;
}

FlightGuard::FlightGuard(const models::Scenario& scenario, const std::string& robot,
                         const SafetyLimits& limits) {
  require(scenario.find_robot(robot) != nullptr,
          "flight safety: robot " + robot + " is not in the scenario");
  check_limits(limits);
  parts_ = std::make_unique<Parts>(scenario, robot, limits);
}

FlightGuard::~FlightGuard() = default;

void FlightGuard::on_mocap(const models::MocapFrame& frame, Time now) {
  Parts& p = *parts_;
  const NamedBody found = find_unique(frame, p.name);
  const bool airborne = is_airborne(p.ladder.state);
  const BodyContext context{airborne, p.course.at(now).velocity_world_mps.norm() > kMovingMps,
                            !airborne || p.in.height_m < p.limits.safe_height_m};
  PoseVerdict verdict = PoseVerdict::kDuplicate;
  if (found.is_unique) {
    verdict = p.pose.judge(found.body, context, p.limits, now);
  }
  ++p.pose_counts[static_cast<std::size_t>(verdict)];
  if (verdict == PoseVerdict::kAccepted) {
    const double latency_s = to_seconds(frame.arrival - frame.stamp.time);
    if (latency_s >= 0.0 && latency_s <= kLatencyMaxS) {
      p.latency_s = latency_s;
    } else {
      ++p.clocks_refused;
      p.latency_s = 0.0;
    }
  }
  p.fleet.on_mocap(frame, p.limits, now);
}

PlanVerdict FlightGuard::on_plan(const models::RobotPlan& plan, Time now) {
  Parts& p = *parts_;
  const auto judge = [&]() -> PlanVerdict {
    if (plan.robot != p.name) {
      return PlanVerdict::kWrongVehicle;
    }
    if (!p.lease.admit(plan.stamp.run_id, now, p.limits.planner_lease_s)) {
      return PlanVerdict::kNoLease;
    }
    p.plans_late = plan.late ? p.plans_late + 1 : 0;
    const models::Trajectory& way = plan.trajectory;
    const bool is_repeated =
        plan.stamp.run_id == p.plan_run && plan.stamp.sequence <= p.plan_sequence;
    if (is_repeated || (p.has_accepted && way.start_time < p.newest_start) ||
        way.start_time < now - from_seconds(p.limits.plan_past_max_s)) {
      return PlanVerdict::kStale;
    }
    if (way.start_time > now + from_seconds(p.limits.plan_future_max_s)) {
      return PlanVerdict::kTooFarAhead;
    }
    HeldPlan held;
    if (!hold_plan(way, held)) {
      return PlanVerdict::kNotFinite;
    }
    if (const PlanVerdict shape = check_shape(held, p.limits); shape != PlanVerdict::kAccepted) {
      return shape;
    }
    if (!p.may_take_plans()) {
      return PlanVerdict::kNotFollowing;
    }
    const Time when = std::max(now, held.start_time);
    const PlanPoint planned = point_at(held, to_seconds(when - held.start_time));
    const PlanPoint expected = p.course.at(when);
    Eigen::Vector3d gap_m = planned.position_world_m - expected.position_world_m;
    gap_m.z() = planned.position_world_m.z() - p.height_ref_m;
    const double turn_rad = std::abs(wrap_to_pi(planned.yaw_rad - expected.yaw_rad));
    if (!(gap_m.norm() <= p.limits.plan_start_tolerance_m) ||
        !(turn_rad <= p.limits.plan_start_turn_rad)) {
      return PlanVerdict::kDiscontinuous;
    }
    const PlanVerdict way_verdict = check_way(held, when, p.limits, p.fleet.courses(now, p.limits));
    if (way_verdict == PlanVerdict::kAccepted) {
      p.course.follow(held, now);
      p.has_accepted = true;
      p.accepted_at = now;
      p.newest_start = held.start_time;
      p.plan_run = plan.stamp.run_id;
      p.plan_sequence = plan.stamp.sequence;
      p.plan_round = plan.round;
    }
    return way_verdict;
  };
  const PlanVerdict verdict = judge();
  ++p.plan_counts[static_cast<std::size_t>(verdict)];
  if (verdict != PlanVerdict::kNoLease && verdict != PlanVerdict::kNotFollowing) {
    p.plans_refused = verdict == PlanVerdict::kAccepted ? 0 : p.plans_refused + 1;
  }
  return verdict;
}

void FlightGuard::on_teammate_plan(const models::RobotPlan& plan, Time) {
  (void)parts_->fleet.on_plan(plan, parts_->limits);
}

CommandVerdict FlightGuard::on_command(const models::OperatorCommand& command, Time now) {
  using models::OperatorAction;
  Parts& p = *parts_;
  const bool is_ours = command.robot.empty() || command.robot == p.name;
  if (!p.authority.admit(command, now, p.limits.operator_age_hold_s)) {
    p.commands_refused += is_ours && command.action != OperatorAction::kHeartbeat ? 1 : 0;
    return is_ours ? CommandVerdict::kNotInCharge : CommandVerdict::kNotForUs;
  }
  if (!is_ours) {
    return CommandVerdict::kNotForUs;
  }
  if (command.action == OperatorAction::kEmergencyStop) {
    p.emergency_stop = true;
    return CommandVerdict::kObeyed;
  }
  if (command.action == OperatorAction::kHeartbeat) {
    return CommandVerdict::kObeyed;
  }
  const bool airborne = is_airborne(p.ladder.state);
  const bool on_ground_only =
      command.action == OperatorAction::kArm || command.action == OperatorAction::kTakeOff;
  const bool is_blocked = p.ladder.state == FlightState::kIdle && on_ground_only && p.reasons.any();
  if (on_ground_only == airborne || is_blocked) {
    const bool is_harmless = !on_ground_only && command.action != OperatorAction::kFollow;
    if (!is_harmless) {
      ++p.commands_refused;
      return CommandVerdict::kRefused;
    }
  }
  // Of several commands within one tick the safest counts.
  const auto severity = [](OperatorAction action) { return static_cast<int>(action); };
  if (!p.request || severity(command.action) > severity(*p.request)) {
    p.request = command.action;
  }
  return CommandVerdict::kObeyed;
}

void FlightGuard::on_heartbeat(Time now) {
  parts_->has_heartbeat = true;
  parts_->heartbeat_at = now;
}

void FlightGuard::on_autopilot(const AutopilotReport& report, Time now) {
  Parts& p = *parts_;
  if (!is_sound(report)) {
    ++p.reports_refused;
    return;
  }
  p.autopilot = report;
  p.has_telemetry = true;
  p.telemetry_at = now;
}

void FlightGuard::on_battery(double share, Time now) {
  Parts& p = *parts_;
  if (!(share >= 0.0 && share <= 1.0)) {
    ++p.reports_refused;
    return;
  }
  if (!p.has_battery || share != p.battery_share) {
    p.battery_changed_at = now;
  }
  p.has_battery = true;
  p.battery_share = share;
  p.battery_at = now;
}

void FlightGuard::on_map(bool is_same) { parts_->map_differs = !is_same; }

GuardOutput FlightGuard::tick(Time now) {
  Parts& p = *parts_;
  const double dt_s = p.has_ticked ? std::max(0.0, to_seconds(now - p.last_tick)) : 0.0;
  const double warn_s = p.limits.pose_age_warn_s;
  const double rate = std::clamp(
      (p.limits.pose_age_hold_s - p.pose_age_s(now)) / (p.limits.pose_age_hold_s - warn_s), 0.0,
      1.0);
  p.course.advance(now, dt_s, rate);
  p.look(now);
  p.stalls += p.in.since_last_tick_s > p.limits.stall_hold_s ? 1 : 0;

  const FlightState before = p.ladder.state;
  p.ladder = step_ladder(p.ladder, p.in, p.limits);
  if (p.ladder.state != before) {
    p.change(before, now);
  }
  if (p.ladder.state == FlightState::kLand) {
    p.land(now, dt_s);
  } else if (is_airborne(p.ladder.state)) {
    p.move_height(dt_s);
  }

  GuardOutput out;
  out.state = p.ladder.state;
  out.setpoint = p.setpoint(now);
  out.wants_armed = p.ladder.wants_armed;
  out.reasons =
      p.ladder.state == FlightState::kIdle ? arming_blocks(p.in, p.limits) : p.ladder.latched;
  out.changed = out.state != before || out.reasons != p.reasons;
  p.reasons = out.reasons;
  p.emergency_stop = false;
  p.request.reset();
  p.last_tick = now;
  p.has_ticked = true;
  return out;
}

models::VehicleStatus FlightGuard::status(Time now) const {
  const Parts& p = *parts_;
  models::VehicleStatus out;
  out.stamp.time = now;
  out.robot = p.name;
  out.state = p.ladder.state;
  out.battery_share = p.battery_share;
  const FlightSetpoint asked = p.setpoint(now);
  if (asked.kind == FlightSetpoint::Kind::kTrack) {
    out.setpoint = {asked.position_world_m.x(), asked.position_world_m.y(), asked.yaw_rad};
    out.setpoint_height_m = std::max(0.0, asked.position_world_m.z());
  } else {
    out.setpoint = flatten(p.pose.world_from_body());
  }
  out.plan_round = p.ladder.state == FlightState::kFollow ? p.plan_round : -1;
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (p.reasons[i]) {
      out.reasons.emplace_back(rows[i].name);
    }
  }
  if (p.ladder.state == FlightState::kHold && out.reasons.empty()) {
    out.reasons.emplace_back("operator");
  }
  return out;
}

std::vector<models::NamedCount> FlightGuard::counters() const {
  const Parts& p = *parts_;
  std::vector<models::NamedCount> out;
  for (std::size_t i = 1; i < kPlanVerdicts; ++i) {
    out.push_back({std::string("plan.") + name_of(static_cast<PlanVerdict>(i)), p.plan_counts[i]});
  }
  for (std::size_t i = 1; i < kPoseVerdicts; ++i) {
    out.push_back({std::string("pose.") + name_of(static_cast<PoseVerdict>(i)), p.pose_counts[i]});
  }
  out.push_back({"mocap.clock_set", p.clocks_refused});
  out.push_back({"mocap.unknown_bodies", p.fleet.unknown_bodies()});
  out.push_back({"mocap.others_refused", p.fleet.poses_refused()});
  out.push_back({"autopilot.refused", p.reports_refused});
  out.push_back({"command.refused", p.commands_refused});
  out.push_back({"planner.takeovers", p.lease.takeovers()});
  out.push_back({"operator.handovers", p.authority.handovers()});
  out.push_back({"tick.stalls", p.stalls});
  return out;
}

const SafetyInputs& FlightGuard::inputs() const { return parts_->in; }

Pose3 FlightGuard::world_from_body() const { return parts_->pose.world_from_body(); }

}  // namespace vantage::drivers
