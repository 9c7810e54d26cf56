#include "drivers/quadrotor/driver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"
#include "models/exchange/counts.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;

// m; height below which the autopilot's landing mode completes a landing
constexpr double kHandOverM = 0.35;
constexpr double kLowM = 0.1;
constexpr double kSettledS = 0.25;  // s; time with poses before a blind landing is steered again
constexpr Duration kRefusalShown = std::chrono::seconds(10);
constexpr Duration kTextAge = std::chrono::seconds(3);
// longest time from the sending of an autopilot's report to its reception
constexpr Duration kReportedBefore = std::chrono::milliseconds(500);
// Poses are also forwarded if they are early by at most this time.
constexpr Duration kPoseSlack{2'000};

const scenario::RobotSpec& robot_of(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* const spec = scenario.find_robot(robot);
  require(spec != nullptr, "quadrotor driver: robot " + robot + " is not in the scenario");
  require(spec->autopilot.has_value(),
          "quadrotor driver: robot " + robot + " has no `autopilot` in the scenario");
  return *spec;
}

SafetyLimits with_leads(SafetyLimits limits, const DialectTraits& traits) {
  limits.setpoint_lead_s = traits.lead_s;
  limits.acceleration_lead_s = traits.acceleration_lead_s;
  return limits;
}

/// Returns the later of two optional times.
std::optional<Time> later(std::optional<Time> a, std::optional<Time> b) {
  return !a ? b : !b ? a : std::optional(std::max(*a, *b));
}

}  // namespace

QuadrotorDriver::QuadrotorDriver(const scenario::Scenario& scenario, const std::string& robot,
                                 const SafetyLimits& limits,
                                 const std::optional<wire::mavlink::SigningKey>& key)
    : GuardedFlight(scenario, robot,
                    with_leads(limits, traits_of(robot_of(scenario, robot).autopilot->dialect))),
      dialect_(robot_of(scenario, robot).autopilot->dialect),
      parameter_policy_(robot_of(scenario, robot).autopilot->parameters),
      link_(*robot_of(scenario, robot).autopilot, key),
      sequence_(dialect_) {}

bool QuadrotorDriver::receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now) {
  const bool is_vehicles = link_.receive(bytes, is_datagram, now);
  report_autopilot(now);
  return is_vehicles;
}

void QuadrotorDriver::report_autopilot(Time now) {
  const Telemetry& telemetry = link_.telemetry();
  if (const auto heartbeat = telemetry.heartbeat_time(); heartbeat != heartbeat_reported_) {
    heartbeat_reported_ = heartbeat;
    guard_.on_heartbeat(now);
  }
  if (const auto battery = telemetry.battery_time(); battery != battery_reported_) {
    battery_reported_ = battery;
    guard_.on_battery(*telemetry.battery_share(), now);
  }
  const auto newest =
      later(later(telemetry.received_at(wire::mavlink::LocalPositionNed::kMessage.id),
                  telemetry.received_at(wire::mavlink::Attitude::kMessage.id)),
            telemetry.heartbeat_time());
  if (newest == telemetry_reported_) {
    return;
  }
  telemetry_reported_ = newest;
  AutopilotReport report;
  report.armed = telemetry.is_armed();
  report.obeys = !sequence_.is_mode_lost();
  const auto flags = telemetry.estimator_flags(now);
  const auto position_m = telemetry.position_world_m(now);
  report.estimator_good = flags && !estimator_fault(dialect_, *flags, !telemetry.is_on_ground()) &&
                          position_m && telemetry.has_attitude(now);
  report.motor_failed = telemetry.has_motor_fault(now);
  report.tilt_rad = telemetry.tilt_rad();
  report.has_position = position_m.has_value();
  report.position_world_m = position_m.value_or(Eigen::Vector3d::Zero());
  report.velocity_world_mps = telemetry.velocity_world_mps();
  report.has_attitude = telemetry.has_attitude(now);
  report.world_from_body = telemetry.world_from_body();
  report.yaw_rate_radps = telemetry.yaw_rate_radps();
  report.is_flown_by_hand = telemetry.is_armed() && is_flown_by_hand(dialect_, telemetry.mode());
  report.is_in_our_mode = telemetry.mode() == traits_of(dialect_).follow_mode;
  report.is_landing_itself = telemetry.mode() == traits_of(dialect_).land_mode;
  guard_.on_autopilot(report, now);
}

void QuadrotorDriver::on_mocap(const models::MocapFrame& frame, Time now) {
  if (!accept_pose(frame, now)) {
    return;
  }
  const BodyState& body = *tracker_.state();
  const bool has_heartbeat = link_.telemetry().heartbeat_time().has_value();
  if (!is_airborne(orders_.state) && has_heartbeat && !link_.telemetry().is_armed()) {
    ground_m_ = body.world_from_body.translation_m.z();
  }
  if (now + kPoseSlack >= next_pose_ && has_heartbeat) {
    next_pose_ = std::max(next_pose_ + kPosePeriod, now);
    link_.send_pose(body, now);
  }
  if (may_send_setpoint(now)) {
    fly(now);
  }
}

void QuadrotorDriver::on_command(const models::OperatorCommand& command, Time now) {
  const bool is_obeyed = guard_.on_command(command, now) == CommandVerdict::kObeyed;
  const bool takes_mode = command.action == models::OperatorAction::kFollow ||
                          command.action == models::OperatorAction::kHold ||
                          command.action == models::OperatorAction::kLand;
  // A repeated command has the stamp of its first transmission, which may be older than a pilot's
  // takeover.
  const bool is_new = !mode_ordered_at_ || command.stamp.time != *mode_ordered_at_;
  if (takes_mode) {
    mode_ordered_at_ = command.stamp.time;
  }
  if (is_obeyed && takes_mode && is_new && sequence_.is_mode_lost()) {
    sequence_.retake_mode();
    lands_blind_ = false;
  }
  if (command.action == models::OperatorAction::kEmergencyStop) {
    next_setpoint_ = now;  // the next tick decides, without waiting for a set-point
  }
}

EndFacts QuadrotorDriver::end_facts(Time now) const {
  const Telemetry& telemetry = link_.telemetry();
  const auto heartbeat = telemetry.heartbeat_time();
  // The autopilot may have armed since its last heartbeat.
  const bool is_proof = heartbeat && *heartbeat - motors_wanted_at_ > kReportedBefore;
  EndFacts out;
  if (is_airborne(orders_.state) || (heartbeat && (telemetry.is_armed() || !is_proof))) {
    out.in_flight = InFlight::kYes;
  } else if (telemetry.is_connected(now)) {
    out.in_flight = InFlight::kNo;
  }
  out.is_pilots = telemetry.is_armed() && is_flown_by_hand(dialect_, telemetry.mode());
  out.lands_itself =
      telemetry.is_connected(now) && telemetry.mode() == traits_of(dialect_).land_mode;
  return out;
}

void QuadrotorDriver::tick(Time now) {
  if (now >= next_setpoint_) {
    fly(now);
  }
  link_.tick(now);
}

// True if the driver may steer a landing that began without poses. Poses must be received again,
// the height must suffice to avoid bodies below, and the autopilot must be in the landing mode that
// this driver commanded.
bool QuadrotorDriver::may_steer_landing() const {
  return lands_blind_ && settled_s_ >= kSettledS && !is_below(kHandOverM) &&
         !sequence_.is_mode_lost() && link_.telemetry().mode() == traits_of(dialect_).land_mode;
}

FlightGoal QuadrotorDriver::goal(const GuardOutput& out) const {
  switch (out.state) {
    case FlightState::kIdle:
      return out.wants_armed ? FlightGoal::kArm : FlightGoal::kGrounded;
    case FlightState::kFollow:
    case FlightState::kHold:
      return FlightGoal::kFly;
    case FlightState::kLand: {
      // A landing by the autopilot continues, unless it began without poses and may be steered
      // again.
      const bool continues_landing = sequence_.goal() == FlightGoal::kLand && !may_steer_landing();
      const bool is_autopilots = out.setpoint.kind == FlightSetpoint::Kind::kBlindLand ||
                                 !out.wants_armed || (out.is_sinking && is_below(kHandOverM)) ||
                                 continues_landing || is_hurried_;
      return is_autopilots ? FlightGoal::kLand : FlightGoal::kFly;
    }
    case FlightState::kKilled:
      return FlightGoal::kKill;
  }
  return FlightGoal::kGrounded;
}

void QuadrotorDriver::fly(Time now) {
  const double elapsed_s = update_orders(now);
  settled_s_ = seen_body(now) ? settled_s_ + elapsed_s : 0.0;
  sequence_.set_goal(goal(orders_));
  lands_blind_ = sequence_.goal() == FlightGoal::kLand &&
                 (lands_blind_ || orders_.setpoint.kind == FlightSetpoint::Kind::kBlindLand);
  const bool wants_motors =
      sequence_.goal() == FlightGoal::kArm || sequence_.goal() == FlightGoal::kFly;
  motors_wanted_at_ = wants_motors ? now : motors_wanted_at_;

  const std::optional<BodyState>& body = tracker_.state();
  const double height_m = body ? body->world_from_body.translation_m.z() : ground_m_.value_or(0.0);
  FlightSequence::Situation situation;
  const bool has_parameters =
      parameter_policy_ != scenario::ParameterPolicy::kVerify || link_.parameters().is_kept();
  situation.may_arm =
      body && link_.telemetry().position_world_m(now) && !link_.fault(now) && has_parameters;
  situation.take_off_height_m = std::max(0.1, orders_.climb_to_m - ground_m_.value_or(0.0));
  situation.height_error_m = std::abs(orders_.climb_to_m - height_m);
  situation.is_flying = is_airborne(orders_.state);
  situation.is_low = body && ground_m_ && height_m - *ground_m_ < kLowM;
  situation.is_landing = orders_.state == FlightState::kLand;
  situation.now = now;
  if (!sequence_.step(link_, situation)) {
    return;
  }
  if (orders_.setpoint.kind == FlightSetpoint::Kind::kTrack) {
    link_.send_setpoint(steer(orders_.setpoint, seen_body(now), vehicle_), now);
  } else if (body) {
    Setpoint here;  // on the ground: the set-point is the present position
    here.position_world_m = body->world_from_body.translation_m;
    here.yaw_rad = flatten(body->world_from_body).yaw_rad;
    link_.send_setpoint(here, now);
  }
}

std::optional<std::string> QuadrotorDriver::refusal(Time now) const {
  static constexpr std::array kCommands{
      wire::mavlink::command::kArmDisarm, wire::mavlink::command::kSetMode,
      wire::mavlink::command::kTakeOff, wire::mavlink::command::kLand};
  const CommandSender::Outcome* newest = nullptr;
  std::uint16_t which = 0;
  std::array<std::optional<CommandSender::Outcome>, kCommands.size()> outcomes;
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    // Take-off is commanded repeatedly because the climb takes seconds. A climbing ArduCopter
    // rejects the repeated command as failed.
    const bool is_done =
        kCommands[i] == wire::mavlink::command::kTakeOff && sequence_.has_climbed();
    outcomes[i] = link_.commands().outcome(kCommands[i]);
    if (outcomes[i] && !is_done && (newest == nullptr || outcomes[i]->time > newest->time)) {
      newest = &*outcomes[i];
      which = kCommands[i];
    }
  }
  if (newest == nullptr || newest->is_accepted() || now - newest->time > kRefusalShown) {
    return std::nullopt;
  }
  const std::string verdict =
      newest->result ? std::string(result_name(*newest->result)) : "not answered";
  const auto why = link_.telemetry().newest_warning(newest->time, kTextAge);
  return fmt::format("{} {}{}", command_name(which), verdict, why ? ": " + *why : "");
}

models::VehicleStatus QuadrotorDriver::status(Time now) const {
  models::VehicleStatus out = guard_.status(now);
  if (const auto fault = link_.fault(now)) {
    out.reasons.push_back(*fault);
    return out;
  }
  const Telemetry& telemetry = link_.telemetry();
  if (const auto flags = telemetry.estimator_flags(now); !flags) {
    out.reasons.emplace_back("no estimator status received from the autopilot");
  } else if (const auto fault = estimator_fault(dialect_, *flags, !telemetry.is_on_ground())) {
    out.reasons.push_back(*fault);
  } else if (!telemetry.position_world_m(now)) {
    out.reasons.emplace_back("no position received from the autopilot");
  } else if (!telemetry.has_attitude(now)) {
    out.reasons.emplace_back("no attitude received from the autopilot");
  }
  const bool has_battery_message =
      telemetry.received_at(wire::mavlink::BatteryStatus::kMessage.id) ||
      telemetry.received_at(wire::mavlink::SysStatus::kMessage.id);
  if (has_battery_message && !telemetry.battery_share()) {
    out.reasons.emplace_back(
        "the autopilot does not report its battery's charge: set up a current sensor and the "
        "capacity, or set robots[].autopilot.battery to estimate the charge from the voltage");
  }
  if (!telemetry.is_armed()) {
    const char* const mark =
        parameter_policy_ == scenario::ParameterPolicy::kVerify ? "" : "warning: ";
    for (const std::string& reason : link_.parameters().reasons()) {
      out.reasons.push_back(mark + reason);
    }
  }
  if (sequence_.is_mode_lost()) {
    out.reasons.push_back("the autopilot is in " + mode_name(dialect_, telemetry.mode()) +
                          " mode; send `hold`, `follow` or `land` to regain control");
  }
  if (const auto waiting = sequence_.waiting_for()) {
    out.reasons.push_back("waiting for " + *waiting);
  }
  if (const auto refused = refusal(now)) {
    out.reasons.push_back(*refused);
  }
  return out;
}

std::vector<models::NamedCount> QuadrotorDriver::counters() const {
  std::vector<models::NamedCount> out = link_.counters();
  append_counters(out, "quadrotor");
  return out;
}

}  // namespace vantage::drivers
