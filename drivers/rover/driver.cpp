#include "drivers/rover/driver.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "drivers/rover/steering.hpp"
#include "drivers/safety/latches.hpp"
#include "drivers/safety/surroundings.hpp"

namespace vantage::drivers {

using models::FlightState;
using models::OperatorAction;

namespace {

constexpr double kPredictS = 0.1;   // how far the own pose is carried on
constexpr double kSwerveMps = 0.6;  // off the course's velocity: it is pushed, not steered
constexpr double kMovingMps = 0.1;
constexpr double kStandingMps = 0.02;
constexpr double kStandingRadps = 0.05;
constexpr double kReleaseS = 0.5;  // then `arm` must be said again
constexpr double kSetOffS = 0.5;   // from a way being asked for to its start

const scenario::RoverSpec& rover_of(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* spec = scenario.find_robot(robot);
  require(spec != nullptr, "rover: robot " + robot + " is not in the scenario");
  require(spec->rover.has_value(), "rover: robot " + robot + " has no `rover` in the scenario");
  return *spec->rover;
}

}  // namespace

RoverDriver::RoverDriver(const scenario::Scenario& scenario, const std::string& robot,
                         const SafetyLimits& limits, std::uint32_t session)
    : name_(robot),
      limits_(limits),
      fleet_(scenario, robot),
      plans_(robot),
      course_(half_window_s(limits.vehicle)),
      link_(static_cast<std::uint32_t>(rover_of(scenario, robot).number), session),
      run_id_(session) {
  check_limits(limits);
}

void RoverDriver::on_mocap(const models::MocapFrame& frame, Time now) {
  const MocapSource::Standing standing = source_.judge(frame, now);
  if (standing == MocapSource::Standing::kRefused) {
    return;
  }
  const NamedBody found = find_unique(frame, name_);
  const bool drives = is_driving(ladder_.state);
  const bool is_moving = std::abs(control_.speed_mps) > kMovingMps;
  PoseMonitor pose = pose_;
  PoseVerdict verdict = PoseVerdict::kDuplicate;
  if (found.is_unique) {
    verdict = pose.judge(found.body, {drives, is_moving, !is_moving}, limits_, now);
  }
  ++pose_counts_[static_cast<std::size_t>(verdict)];
  if (standing == MocapSource::Standing::kCandidate) {
    if (verdict != PoseVerdict::kAccepted) {
      return;
    }
    source_.confirm(frame, now);
  }
  pose_ = pose;
  clocks_set_ += clock_.on_frame(frame.stamp.time, frame.arrival, frame.frame_number) ? 0 : 1;
  fleet_.on_mocap(frame, limits_, now);
}

PlanVerdict RoverDriver::on_plan(const models::RobotPlan& plan, Time now) {
  if (plan.robot != name_) {
    (void)fleet_.on_plan(plan, limits_, now);  // counted there
    return PlanVerdict::kWrongVehicle;
  }
  return take(plan, now);
}

PlanVerdict RoverDriver::take(const models::RobotPlan& plan, Time now) {
  HeldPlan held;
  // Heights are not a rover's business: a plan must be at the scenario's.
  const PlanVerdict verdict = plans_.judge(
      plan, {may_take_plans(), course_, limits_.take_off_height_m, fleet_.courses(now, limits_)},
      limits_, now, held);
  if (verdict == PlanVerdict::kAccepted) {
    course_.follow(held, now);
  }
  return verdict;
}

PlanVerdict RoverDriver::drive_through(std::span<const Waypoint> waypoints, Time now) {
  models::RobotPlan plan;
  const Time start = now + from_seconds(kSetOffS);
  plan.stamp = {start, run_id_, ways_++};
  plan.robot = name_;
  plan.trajectory = way_through(waypoints, world_from_body(now), limits_.take_off_height_m, start,
                                limits_.vehicle);
  return take(plan, now);
}

CommandVerdict RoverDriver::on_command(const models::OperatorCommand& command, Time now) {
  const bool is_ours = command.robot.empty() || command.robot == name_;
  if (!authority_.admit(command, now, limits_.operator_age_hold_s)) {
    commands_refused_ += is_ours && command.action != OperatorAction::kHeartbeat ? 1 : 0;
    return is_ours ? CommandVerdict::kNotInCharge : CommandVerdict::kNotForUs;
  }
  if (!is_ours) {
    return CommandVerdict::kNotForUs;
  }
  switch (command.action) {
    case OperatorAction::kEmergencyStop:
      emergency_stop_ = true;
      return CommandVerdict::kObeyed;
    case OperatorAction::kHeartbeat:
      return CommandVerdict::kObeyed;
    case OperatorAction::kTakeOff:  // said to all vehicles, meant for those that fly
      return CommandVerdict::kNotForUs;
    case OperatorAction::kArm:
      if (is_driving(ladder_.state) || (ladder_.state == FlightState::kIdle && reasons_.any())) {
        ++commands_refused_;
        return CommandVerdict::kRefused;
      }
      break;
    case OperatorAction::kFollow:
      if (!is_driving(ladder_.state)) {
        ++commands_refused_;
        return CommandVerdict::kRefused;
      }
      break;
    case OperatorAction::kHold:
    case OperatorAction::kLand:
      break;
  }
  // Of several commands within one tick the safest counts.
  if (!request_ || static_cast<int>(command.action) > static_cast<int>(*request_)) {
    request_ = command.action;
  }
  return CommandVerdict::kObeyed;
}

void RoverDriver::receive(std::span<const std::uint8_t> datagram, Time now) {
  (void)link_.receive(datagram, now);  // it counts what it does not take
}

bool RoverDriver::sees(Time now) const { return pose_.age_s(now) <= limits_.pose_age_hold_s; }

Pose2 RoverDriver::world_from_body(Time now) const {
  Pose2 here = flatten(pose_.world_from_body());
  const Eigen::Vector3d place_m = pose_.predict_m(now, kPredictS);
  here.x_m = place_m.x();
  here.y_m = place_m.y();
  if (pose_.has_pose()) {
    const double ahead_s = std::min(pose_.age_s(now), kPredictS);
    here.yaw_rad = wrap_to_pi(here.yaw_rad + control_.yaw_rate_radps * ahead_s);
  }
  return here;
}

bool RoverDriver::may_take_plans() const {
  if (ladder_.state == FlightState::kFollow) {
    return true;
  }
  return ladder_.state == FlightState::kHold && ladder_.wants_follow &&
         !waits_for_more_than_a_plan(rover_conditions(), ladder_.latched);
}

// Along the plan while it keeps to it; else straight on as it is seen to move.
BrakeWay RoverDriver::brake_way(Time now) const {
  const Eigen::Vector3d here_m = pose_.predict_m(now, kPredictS);
  const PlanPoint asked = course_.at(now);
  const bool keeps_to_course =
      course_.is_on_plan() && sees(now) &&
      (pose_.velocity_world_mps() - asked.velocity_world_mps).norm() <= kSwerveMps &&
      (here_m - asked.position_world_m).head<2>().norm() <= limits_.tracking_hold_m;
  if (keeps_to_course) {
    return BrakeWay::along(course_.plan(), std::max(0.0, course_.elapsed_s(now)),
                           limits_.vehicle.brake_mps2, limits_.reaction_s,
                           here_m - asked.position_world_m);
  }
  return BrakeWay::straight(here_m, pose_.velocity_world_mps(), 0.0, limits_.vehicle.brake_mps2,
                            limits_.reaction_s);
}

RoverFacts RoverDriver::facts(Time now) const {
  const wire::rover::Telemetry& heard = link_.telemetry();
  RoverFacts out;
  out.stands = link_.heard_age_s(now) <= limits_.telemetry_age_hold_s &&
               std::abs(heard.speed_mps) < static_cast<float>(kStandingMps) &&
               std::abs(heard.yaw_rate_radps) < static_cast<float>(kStandingRadps);
  out.stop_latched = link_.has_flag(wire::rover::kStopLatched);
  return out;
}

void RoverDriver::look(Time now) {
  in_.now = now;
  in_.since_last_tick_s = has_ticked_ ? to_seconds(now - last_tick_) : 0.0;
  in_.pose_age_s = pose_.age_s(now);
  in_.pose_latency_s = clock_.latency_s();
  in_.poses_rejected = pose_.rejected_in_row();
  in_.poses_accepted = pose_.accepted_in_row();
  const Eigen::Vector3d here_m = pose_.predict_m(now, kPredictS);
  in_.height_m = here_m.z();
  in_.tracking_error_m = 0.0;
  if (ladder_.state == FlightState::kFollow && sees(now)) {
    in_.tracking_error_m = (here_m - course_.at(now).position_world_m).head<2>().norm();
  }
  course_.report(now, in_);
  plans_.report(now, limits_, in_);
  in_.map_differs = map_differs_;
  in_.other_version_age_s = other_version_at_ ? to_seconds(now - *other_version_at_) : kNever;
  if (pose_.has_pose()) {
    static_cast<Surroundings&>(in_) =
        look_around(here_m, brake_way(now), fleet_.bodies(now, limits_), limits_);
  }
  in_.heartbeat_age_s = link_.heard_age_s(now);
  in_.telemetry_age_s = link_.obeyed_age_s(now);
  in_.autopilot_obeys = link_.is_ours();
  in_.motor_failed = link_.has_flag(wire::rover::kMotorFailed);
  in_.battery_share =
      link_.has_telemetry() ? static_cast<double>(link_.telemetry().battery_share) : 1.0;
  in_.operator_age_s = authority_.age_s(now);
  // Once killed, the rover's latch is what `arm` releases, and no new reason.
  const bool is_news =
      ladder_.state != FlightState::kKilled && link_.has_flag(wire::rover::kStopLatched);
  in_.emergency_stop = emergency_stop_ || is_news;
  in_.request = request_;
}

// A course is a plan or the place where the rover stands.
void RoverDriver::keep_course(FlightState before, Time now) {
  const bool stops = before == FlightState::kFollow && ladder_.state != FlightState::kFollow;
  const bool waits = ladder_.state == FlightState::kHold && may_take_plans() && course_.has_next();
  const bool begins = ladder_.state == FlightState::kHold && course_.is_on_plan() && !stops;
  if (ladder_.state != FlightState::kFollow && !waits && !(begins && may_take_plans())) {
    const Pose2 here = world_from_body(now);
    course_.stand({here.x_m, here.y_m, limits_.take_off_height_m}, here.yaw_rad, now);
  }
}

void RoverDriver::drive(Time now, double dt_s) {
  if (ladder_.state == FlightState::kFollow && sees(now)) {
    control_ = steer(world_from_body(now), course_.at(now), limits_.vehicle);
  } else if (is_driving(ladder_.state)) {
    control_ = brake_on_circle(control_, limits_.vehicle.brake_mps2, dt_s);
  } else {
    control_ = {};
  }
}

std::uint32_t RoverDriver::flags() const {
  if (ladder_.state == FlightState::kKilled) {
    return ladder_.wants_armed ? wire::rover::kReleaseStop : wire::rover::kEmergencyStop;
  }
  return is_driving(ladder_.state) ? wire::rover::kDrive : 0U;
}

RoverMessage RoverDriver::tick(Time now) {
  const double dt_s = has_ticked_ ? std::max(0.0, to_seconds(now - last_tick_)) : 0.0;
  course_.advance(now, dt_s, 1.0);
  look(now);
  const LadderState before = ladder_;
  ladder_ = step_rover_ladder(ladder_, in_, facts(now), limits_);
  if (ladder_.wants_armed && !before.wants_armed) {
    release_since_ = now;
  }
  ladder_.wants_armed = ladder_.wants_armed && to_seconds(now - release_since_) <= kReleaseS;
  keep_course(before.state, now);
  drive(now, dt_s);

  const Reasons reasons = ladder_.state == FlightState::kIdle
                              ? arming_blocks(rover_conditions(), in_, limits_)
                              : ladder_.latched;
  has_news_ = has_news_ || ladder_.state != before.state || reasons != reasons_;
  reasons_ = reasons;
  emergency_stop_ = false;
  request_.reset();
  last_tick_ = now;
  has_ticked_ = true;
  return link_.command(control_, flags(), now);
}

bool RoverDriver::take_news() {
  const bool had = has_news_;
  has_news_ = false;
  return had;
}

models::VehicleStatus RoverDriver::status(Time now) const {
  models::VehicleStatus out;
  out.stamp.time = now;
  out.robot = name_;
  out.state = ladder_.state;
  out.battery_share = in_.battery_share;
  const PlanPoint asked = course_.at(now);
  out.setpoint = {asked.position_world_m.x(), asked.position_world_m.y(), asked.yaw_rad};
  out.setpoint_height_m = std::max(0.0, in_.height_m);
  out.plan_round = ladder_.state == FlightState::kFollow ? plans_.round() : -1;
  const auto rows = rover_conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (reasons_[i]) {
      out.reasons.emplace_back(rows[i].name);
    }
  }
  if (ladder_.state == FlightState::kHold && !ladder_.wants_follow) {
    out.reasons.emplace_back("operator");
  }
  if (const char* const complaint = source_.complaint(now)) {
    out.reasons.emplace_back(complaint);
  }
  return out;
}

std::vector<models::NamedCount> RoverDriver::counters() const {
  std::vector<models::NamedCount> out;
  plans_.count(out);
  for (std::size_t i = 1; i < kPoseVerdicts; ++i) {
    out.push_back({std::string("pose.") + name_of(static_cast<PoseVerdict>(i)), pose_counts_[i]});
  }
  link_.count(out);
  out.push_back({"mocap.clock_set", clocks_set_});
  out.push_back({"mocap.unknown_bodies", fleet_.unknown_bodies()});
  out.push_back({"mocap.others_refused", fleet_.poses_refused()});
  source_.count(out);
  out.push_back({"plan.teammate_refused", fleet_.plans_refused()});
  out.push_back({"command.refused", commands_refused_});
  out.push_back({"planner.takeovers", plans_.lease().takeovers()});
  authority_.count(out);
  return out;
}

}  // namespace vantage::drivers
