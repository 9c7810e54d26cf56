#include "drivers/rover/driver.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "drivers/rover/steering.hpp"

namespace vantage::drivers {

using models::FlightState;
using models::OperatorAction;

namespace {

constexpr double kStandingMps = 0.02;
constexpr double kStandingRadps = 0.05;
constexpr double kReleaseS = 0.5;  // s; maximum time for the release of the rover's stop
constexpr double kSetOffS = 0.5;   // s; delay from the request of a motion to its start

const scenario::RoverSpec& rover_of(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* spec = scenario.find_robot(robot);
  require(spec != nullptr, "rover: robot " + robot + " is not in the scenario");
  require(spec->rover.has_value(), "rover: robot " + robot + " has no `rover` in the scenario");
  return *spec->rover;
}

}  // namespace

RoverDriver::RoverDriver(const scenario::Scenario& scenario, const std::string& robot,
                         const SafetyLimits& limits, std::uint32_t session)
    : core_(scenario, robot, limits, {rover_conditions(), false},
            Course(half_window_s(limits.vehicle))),
      link_(static_cast<std::uint32_t>(rover_of(scenario, robot).number), session),
      run_id_(session) {
  check_limits(limits);
}

void RoverDriver::on_mocap(const models::MocapFrame& frame, Time now, double pose_sigma_m) {
  const bool is_moving = std::abs(control_.speed_mps) > kMovingMps;
  const BodyContext context{is_driving(core_.state()), is_moving, !is_moving};
  // The core counts refusals.
  (void)core_.on_mocap(frame, context, false, now, pose_sigma_m);
}

PlanVerdict RoverDriver::on_plan(const models::RobotPlan& plan, Time now) {
  if (plan.robot != core_.name()) {
    core_.on_teammate_plan(plan, now);
    return PlanVerdict::kWrongVehicle;
  }
  return take(plan, now);
}

PlanVerdict RoverDriver::take(const models::RobotPlan& plan, Time now) {
  // Rovers have no height control: a plan must have the scenario's height.
  return core_.on_plan(plan, core_.may_take_plans(), core_.limits().take_off_height_m, now);
}

PlanVerdict RoverDriver::drive_through(std::span<const Waypoint> waypoints, Time now) {
  models::RobotPlan plan;
  const Time start = now + from_seconds(kSetOffS);
  plan.stamp = {start, run_id_, plans_made_++};
  plan.robot = core_.name();
  plan.trajectory =
      waypoint_trajectory(waypoints, world_from_body(now), core_.limits().take_off_height_m, start,
                          core_.limits().vehicle);
  return take(plan, now);
}

CommandVerdict RoverDriver::on_command(const models::OperatorCommand& command, Time now) {
  if (!core_.admits(command, now)) {
    return core_.is_ours(command) ? CommandVerdict::kNotInCharge : CommandVerdict::kOtherRobot;
  }
  if (const auto verdict = core_.execute_if_stateless(command)) {
    return *verdict;
  }
  const FlightState state = core_.state();
  switch (command.action) {
    case OperatorAction::kTakeOff:  // sent to all vehicles; only flying vehicles obey
      return CommandVerdict::kOtherRobot;
    case OperatorAction::kArm:
      if (is_driving(state) || (state == FlightState::kIdle && core_.reasons().any())) {
        return core_.refuse();
      }
      break;
    case OperatorAction::kFollow:
      if (!is_driving(state)) {
        return core_.refuse();
      }
      break;
    case OperatorAction::kHeartbeat:
    case OperatorAction::kEmergencyStop:
    case OperatorAction::kHold:
    case OperatorAction::kLand:
      break;
  }
  return core_.request_action(command.action);
}

bool RoverDriver::receive(std::span<const std::uint8_t> datagram, Time now) {
  return link_.receive(datagram, now);  // the link counts other datagrams
}

bool RoverDriver::has_recent_pose(Time now) const {
  return core_.pose().age_s(now) <= core_.limits().pose_age_hold_s;
}

Pose2 RoverDriver::world_from_body(Time now) const {
  Pose2 here = flatten(core_.pose().world_from_body());
  const Eigen::Vector3d position_m = core_.position_m(now);
  here.x_m = position_m.x();
  here.y_m = position_m.y();
  if (core_.pose().has_pose()) {
    const double ahead_s = std::min(core_.pose().age_s(now), kPredictS);
    here.yaw_rad = wrap_to_pi(here.yaw_rad + control_.yaw_rate_radps * ahead_s);
  }
  return here;
}

RoverFacts RoverDriver::facts(Time now) const {
  const wire::rover::Telemetry& telemetry = link_.telemetry();
  RoverFacts out;
  out.is_stationary = link_.receive_age_s(now) <= core_.limits().telemetry_age_hold_s &&
                      std::abs(telemetry.speed_mps) < static_cast<float>(kStandingMps) &&
                      std::abs(telemetry.yaw_rate_radps) < static_cast<float>(kStandingRadps);
  out.stop_latched = link_.has_flag(wire::rover::kStopLatched);
  return out;
}

EndFacts RoverDriver::end_facts(Time now) const {
  EndFacts out;
  if (is_driving(core_.state())) {
    out.in_flight = facts(now).is_stationary ? InFlight::kNo : InFlight::kYes;
  } else if (link_.has_telemetry()) {
    out.in_flight = InFlight::kNo;
  }
  return out;
}

void RoverDriver::update_inputs(Time now) {
  core_.update_common_inputs(now);
  SafetyInputs& in = core_.inputs();
  const Eigen::Vector3d here_m = core_.position_m(now);
  in.height_m = here_m.z();
  in.tracking_error_m = 0.0;
  if (core_.state() == FlightState::kFollow && has_recent_pose(now)) {
    in.tracking_error_m = (here_m - core_.course().at(now).position_world_m).head<2>().norm();
  }
  core_.update_surroundings(core_.bodies(now), now);
  in.heartbeat_age_s = link_.receive_age_s(now);
  in.telemetry_age_s = link_.taken_command_age_s(now);
  in.autopilot_obeys = link_.is_ours();
  in.motor_failed = link_.has_flag(wire::rover::kMotorFailed);
  in.battery_share =
      link_.has_telemetry() ? static_cast<double>(link_.telemetry().battery_share) : 1.0;
  // In the killed state, `arm` releases the rover's latched stop, so the latched stop is not a new
  // reason.
  const bool is_new_stop =
      core_.state() != FlightState::kKilled && link_.has_flag(wire::rover::kStopLatched);
  in.emergency_stop = in.emergency_stop || is_new_stop;
}

// Sets the course to the rover's position, unless it follows a plan or a plan is about to begin.
void RoverDriver::keep_course(FlightState before, Time now) {
  const bool stops = before == FlightState::kFollow && core_.state() != FlightState::kFollow;
  const bool waits =
      core_.state() == FlightState::kHold && core_.may_take_plans() && core_.course().has_next();
  const bool begins = core_.state() == FlightState::kHold && core_.course().is_on_plan() && !stops;
  if (core_.state() != FlightState::kFollow && !waits && !(begins && core_.may_take_plans())) {
    const Pose2 here = world_from_body(now);
    core_.course().hover({here.x_m, here.y_m, core_.limits().take_off_height_m}, here.yaw_rad, now);
  }
}

void RoverDriver::drive(Time now, double dt_s) {
  if (core_.state() == FlightState::kFollow && has_recent_pose(now)) {
    control_ = steer(world_from_body(now), core_.course().at(now), core_.limits().vehicle);
  } else if (is_driving(core_.state())) {
    control_ = brake_on_circle(control_, core_.limits().vehicle.brake_mps2, dt_s);
  } else {
    control_ = {};
  }
}

std::uint32_t RoverDriver::flags() const {
  if (core_.state() == FlightState::kKilled) {
    return core_.ladder().wants_armed ? wire::rover::kReleaseStop : wire::rover::kEmergencyStop;
  }
  return is_driving(core_.state()) ? wire::rover::kDrive : 0U;
}

RoverMessage RoverDriver::tick(Time now) {
  const double dt_s = core_.dt_s(now);
  core_.course().advance(now, dt_s, 1.0);
  update_inputs(now);
  const FlightState before = core_.state();
  LadderState next = step_rover_ladder(core_.ladder(), core_.inputs(), facts(now), core_.limits());
  if (next.wants_armed && !core_.ladder().wants_armed) {
    release_since_ = now;
  }
  next.wants_armed = next.wants_armed && to_seconds(now - release_since_) <= kReleaseS;
  core_.set_ladder(next);
  keep_course(before, now);
  drive(now, dt_s);

  const bool has_other_reasons = core_.end_tick(core_.acting_conditions(), now);
  has_changed_ = has_changed_ || core_.state() != before || has_other_reasons;
  return link_.command(control_, flags(), now);
}

models::VehicleStatus RoverDriver::status(Time now) const {
  std::vector<std::string> details;
  if (core_.state() == FlightState::kHold && !core_.ladder().wants_follow) {
    details.emplace_back("operator");
  }
  models::VehicleStatus out = core_.status(now, details);
  out.setpoint_height_m = std::max(0.0, core_.inputs().height_m);
  return out;
}

std::vector<models::NamedCount> RoverDriver::counters() const {
  std::vector<models::NamedCount> out;
  core_.count(out);
  link_.count(out);
  return out;
}

}  // namespace vantage::drivers
