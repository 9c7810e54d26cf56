#include "drivers/safety/guard.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/check.hpp"
#include "drivers/safety/guard_parts.hpp"

namespace vantage::drivers {

using models::FlightState;

namespace {

constexpr double kMovingMps = 0.1;
// reason in a status message that announces the first lift
constexpr const char* kFirstLift = "first lift";

bool is_sound(const AutopilotReport& report) {
  return std::isfinite(report.tilt_rad) &&
         (!report.has_position ||
          (report.position_world_m.allFinite() && report.velocity_world_mps.allFinite())) &&
         (!report.has_attitude ||
          (report.world_from_body.coeffs().allFinite() && std::isfinite(report.yaw_rate_radps)));
}

std::vector<std::string> names_of(const Reasons& reasons) {
  std::vector<std::string> out;
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (reasons[i]) {
      out.emplace_back(rows[i].name);
    }
  }
  return out;
}

bool distrusts_pose(const Reasons& latched) {
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (latched[i] && rows[i].distrusts_pose) {
      return true;
    }
  }
  return false;
}

// Appends the status of the commands `arm` and `take-off` on the ground.
void append_order_status(const LadderState& ladder, const SafetyInputs& in,
                         std::vector<std::string>& reasons) {
  if (ladder.arm.is_given && !ladder.wants_armed) {
    reasons.emplace_back("arm pending");
  }
  if (ladder.take_off.is_given) {
    reasons.emplace_back(in.autopilot_armed ? "take-off pending"
                                            : "take-off pending: starting the motors");
  }
  if (ladder.refusal.order != Refusal::Order::kNone) {
    const bool is_arm = ladder.refusal.order == Refusal::Order::kArm;
    std::string why = is_arm ? "arm refused: " : "take-off refused: ";
    const std::vector<std::string> names = names_of(ladder.refusal.reasons);
    for (std::size_t i = 0; i < names.size(); ++i) {
      why += (i == 0 ? "" : ", ") + names[i];
    }
    reasons.push_back(why + (names.empty() ? "not armed" : ""));
  }
}

}  // namespace

FlightGuard::FlightGuard(const scenario::Scenario& scenario, const std::string& robot,
                         const SafetyLimits& limits) {
  require(scenario.find_robot(robot) != nullptr,
          "flight safety: robot " + robot + " is not in the scenario");
  check_limits(limits);
  parts_ = std::make_unique<Parts>(scenario, robot, limits);
}

FlightGuard::~FlightGuard() = default;

bool FlightGuard::on_mocap(const models::MocapFrame& frame, Time now) {
  Parts& p = *parts_;
  const bool airborne = is_airborne(p.ladder.state);
  const bool comes_down = p.ladder.state == FlightState::kLand && p.is_sinking;
  const BodyContext context{airborne, p.course.at(now).velocity_world_mps.norm() > kMovingMps,
                            !airborne || p.in.height_m < p.limits.safe_height_m,
                            comes_down ? p.limits.descent_mps * p.pose_age_s(now) : 0.0,
                            p.distrusts_pose};
  return p.on_mocap(frame, context, p.autopilot.armed, now);
}

Time FlightGuard::captured() const { return parts_->clock.captured(); }

PoseVerdict FlightGuard::pose_verdict() const { return parts_->pose_verdict; }

PlanVerdict FlightGuard::on_plan(const models::RobotPlan& plan, Time now) {
  Parts& p = *parts_;
  return p.on_plan(plan, p.may_take_plans(), p.height_ref_m, now);
}

void FlightGuard::on_teammate_plan(const models::RobotPlan& plan, Time now) {
  parts_->on_teammate_plan(plan, now);
}

void FlightGuard::on_teammate_status(const models::VehicleStatus& status, Time now) {
  parts_->fleet.on_status(status.robot, now);
  const bool is_lifting =
      std::find(status.reasons.begin(), status.reasons.end(), kFirstLift) != status.reasons.end();
  if (is_lifting && is_airborne(status.state)) {
    parts_->lift_queue.on_lifting(status.robot, now);
  }
}

CommandVerdict FlightGuard::on_command(const models::OperatorCommand& command, Time now) {
  using models::OperatorAction;
  Parts& p = *parts_;
  if (!p.admits(command, now)) {
    return p.is_ours(command) ? CommandVerdict::kNotInCharge : CommandVerdict::kOtherRobot;
  }
  if (command.action == OperatorAction::kTakeOff) {
    p.lift_queue.on_take_off(command.robot);  // commands to every robot count, since robots lift
                                              // one by one
  }
  if (const auto verdict = p.execute_if_stateless(command)) {
    return *verdict;
  }
  const bool airborne = is_airborne(p.ladder.state);
  const bool on_ground_only =
      command.action == OperatorAction::kArm || command.action == OperatorAction::kTakeOff;
  const bool is_harmless = !on_ground_only && command.action != OperatorAction::kFollow;
  if (on_ground_only == airborne && !is_harmless) {
    return p.refuse();
  }
  return p.request_action(command.action);
}

void FlightGuard::on_heartbeat(Time now) {
  Parts& p = *parts_;
  p.has_heartbeat = true;
  p.heartbeat_at = now;
  p.disarmed_beats = p.autopilot.armed ? 0 : std::min(p.disarmed_beats + 1, 1000);
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

void FlightGuard::on_processor_wait(double wait_s) { parts_->processor_wait_s = wait_s; }

void FlightGuard::on_end_request() { parts_->is_ending = true; }

void FlightGuard::on_other_version(Time now) { parts_->other_version_at = now; }

// long: the steps of one tick in their order; each step is a function
GuardOutput FlightGuard::tick(Time now) {
  Parts& p = *parts_;
  const double dt_s = p.dt_s(now);
  const double warn_s = p.limits.pose_age_warn_s;
  const double rate = std::clamp(
      (p.limits.pose_age_hold_s - p.pose_age_s(now)) / (p.limits.pose_age_hold_s - warn_s), 0.0,
      1.0);
  p.course.advance(now, dt_s, rate);
  p.update_inputs(now);
  p.stalls += p.in.since_last_tick_s > p.limits.stall_hold_s ? 1 : 0;

  const FlightState before = p.ladder.state;
  const LadderState& ladder = p.ladder;
  const auto orders = [&ladder] {
    return std::tuple(ladder.refusal.order, ladder.refusal.reasons, ladder.arm.is_given,
                      ladder.take_off.is_given, ladder.wants_armed);
  };
  const auto orders_before = orders();
  p.ladder = step_ladder(p.ladder, p.in, p.limits);
  p.distrusts_pose = is_airborne(p.ladder.state) && distrusts_pose(p.ladder.latched);
  if (p.ladder.state != before) {
    p.on_state_change(before, now);
  }
  if (p.ladder.state == FlightState::kHold && !p.may_take_plans()) {
    // A plan accepted before a condition forbade plans must not start now.
    p.course.forget_next();
    if (p.course.is_on_plan()) {
      p.course.stop(p.braking_path(now, 0.0), now);
    }
  }
  if (p.ladder.state == FlightState::kHold) {
    p.restore_clearance(now);
  }
  const double height_before_m = p.height_ref_m;
  if (p.ladder.state == FlightState::kLand) {
    p.land(now, dt_s);
  } else if (is_airborne(p.ladder.state)) {
    p.move_height(dt_s);
  }
  const double rate_mps = dt_s > 0.0 ? (p.height_ref_m - height_before_m) / dt_s : 0.0;
  p.height_rate_mps = std::clamp(rate_mps, -p.limits.descent_mps, p.limits.climb_mps);

  if (!p.ladder.take_off.is_given && !p.lift.is_under_way()) {
    p.lift_queue.forget_own();
  }

  GuardOutput out;
  out.state = p.ladder.state;
  out.setpoint = p.setpoint(now);
  out.wants_armed = p.ladder.wants_armed;
  out.is_sinking = p.ladder.state == FlightState::kLand && p.is_sinking;
  out.climb_to_m = p.height_goal_m;
  out.reasons = p.ladder.latched;
  if (p.ladder.state == FlightState::kIdle) {
    out.reasons = arming_blocks(p.in, p.limits);
    if (p.ladder.take_off.is_given) {
      out.reasons |= take_off_blocks(p.in, p.limits);
    }
  }
  out.changed = out.state != before || out.reasons != p.reasons || orders() != orders_before;
  p.reasons = out.reasons;
  p.end_tick(now);
  return out;
}

models::VehicleStatus FlightGuard::status(Time now) const {
  const Parts& p = *parts_;
  models::VehicleStatus out;
  out.stamp.time = now;
  out.robot = p.name;
  out.state = p.ladder.state;
  out.battery_share = p.battery_share;
  if (p.setpoint(now).kind == FlightSetpoint::Kind::kTrack) {
    const Setpoint commanded = p.course.at(now);  // the current set-point, without setpoint_lead_s
    out.setpoint = {commanded.position_world_m.x(), commanded.position_world_m.y(),
                    commanded.yaw_rad};
    out.setpoint_height_m = std::max(0.0, p.height_ref_m);
  } else {
    out.setpoint = flatten(p.pose.world_from_body());
  }
  out.plan_round = p.ladder.state == FlightState::kFollow ? p.plans.round() : -1;
  out.reasons = names_of(p.reasons);
  if (p.lift.is_under_way()) {
    out.reasons.emplace_back(kFirstLift);
  }
  if (p.ladder.state == FlightState::kHold && out.reasons.empty()) {
    out.reasons.emplace_back("operator");
  }
  if (p.ladder.state == FlightState::kIdle) {
    append_order_status(p.ladder, p.in, out.reasons);
  }
  if (const char* const refusal_message = p.source.refusal_message(now)) {
    out.reasons.emplace_back(refusal_message);
  }
  return out;
}

std::vector<models::NamedCount> FlightGuard::counters() const {
  const Parts& p = *parts_;
  std::vector<models::NamedCount> out;
  p.count(out);
  out.push_back({"autopilot.refused", p.reports_refused});
  out.push_back({"tick.stalls", p.stalls});
  return out;
}

const SafetyInputs& FlightGuard::inputs() const { return parts_->in; }

Pose3 FlightGuard::world_from_body() const { return parts_->pose.world_from_body(); }

}  // namespace vantage::drivers
