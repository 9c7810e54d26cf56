#include "drivers/crazyflie/driver.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "models/exchange/counts.hpp"
#include "wire/crtp/system.hpp"

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;
namespace info = wire::crtp::info;
using models::FlightState;

constexpr double kLeadS = 0.05;  // s; delay from a set-point to its effect
// s; longer than kLeadS, because the vehicle must tilt first
constexpr double kAccelerationLeadS = 0.08;
constexpr double kHandOverM = 0.25;  // m; height below which the vehicle completes a landing
constexpr double kLowM = 0.05;
constexpr double kSentMaxS = 0.2;      // s; maximum age of the last sent pose for arming
constexpr double kEnduranceS = 600.0;  // s; assumed flight time without a battery sensor
constexpr Duration kPoseSlack{2'000};

const scenario::CrazyflieSpec& spec_of(const scenario::Scenario& scenario,
                                       const std::string& robot) {
  const scenario::RobotSpec* const spec = scenario.find_robot(robot);
  require(spec != nullptr, "crazyflie driver: robot " + robot + " is not in the scenario");
  require(spec->crazyflie.has_value(),
          "crazyflie driver: robot " + robot + " has no `crazyflie` in the scenario");
  return *spec->crazyflie;
}

/// Returns the limits with the leads of a Crazyflie.
/// @throws UsageError as spec_of().
SafetyLimits limits_of(const scenario::Scenario& scenario, const std::string& robot,
                       SafetyLimits limits) {
  static_cast<void>(spec_of(scenario, robot));
  limits.setpoint_lead_s = kLeadS;
  limits.acceleration_lead_s = kAccelerationLeadS;
  return limits;
}

}  // namespace

CrazyflieDriver::CrazyflieDriver(const scenario::Scenario& scenario, const std::string& robot,
                                 const SafetyLimits& limits,
                                 const std::shared_ptr<TableCache>& cache)
    : GuardedFlight(scenario, robot, limits_of(scenario, robot, limits)),
      spec_(spec_of(scenario, robot)),
      link_(cache) {}

bool CrazyflieDriver::receive(std::span<const std::uint8_t> bytes, Time now) {
  const bool is_vehicles = link_.receive(bytes, now);
  report_vehicle(now);
  return is_vehicles;
}

void CrazyflieDriver::report_vehicle(Time now) {
  const CrazyflieTelemetry& telemetry = link_.telemetry();
  report_battery(now);
  const bool has_new_info = telemetry.info_at() != info_reported_;
  if (!has_new_info && telemetry.state_at() == state_reported_) {
    return;
  }
  info_reported_ = telemetry.info_at();
  state_reported_ = telemetry.state_at();
  AutopilotReport report;
  report.armed = sequence_.is_armed(telemetry);
  report.estimator_good = telemetry.is_estimate_good(now);
  report.motor_failed = telemetry.has(info::kLocked) || telemetry.has(info::kCrashed) ||
                        telemetry.has(info::kDeckFault);
  report.tilt_rad = telemetry.tilt_rad();
  report.has_position = telemetry.has_position(now);
  report.position_world_m = telemetry.position_world_m();
  report.velocity_world_mps = telemetry.velocity_world_mps();
  report.has_attitude = telemetry.has_attitude(now);
  report.world_from_body = telemetry.world_from_body();
  report.yaw_rate_radps = telemetry.yaw_rate_radps();
  report.is_in_our_mode = sequence_.has_control(telemetry);
  report.is_landing_itself = telemetry.has(info::kFlying | info::kHighLevelActive);
  guard_.on_autopilot(report, now);
  if (has_new_info) {
    guard_.on_heartbeat(now);
  }
}

void CrazyflieDriver::report_battery(Time now) {
  const CrazyflieTelemetry& telemetry = link_.telemetry();
  if (spec_.battery == scenario::CrazyflieBattery::kNone) {
    if (telemetry.info_at() && telemetry.info_at() != info_reported_) {
      guard_.on_battery(std::max(0.0, 1.0 - flown_s_ / kEnduranceS), now);
    }
    return;
  }
  if (telemetry.battery_at() && telemetry.battery_at() != battery_reported_) {
    battery_reported_ = telemetry.battery_at();
    guard_.on_battery(
        std::clamp((telemetry.battery_v() - spec_.empty_v) / (spec_.full_v - spec_.empty_v), 0.0,
                   1.0),
        now);
  }
}

void CrazyflieDriver::on_mocap(const models::MocapFrame& frame, Time now) {
  // The vehicle trusts every pose that it receives, so only accepted poses are sent.
  if (!accept_pose(frame, now)) {
    return;
  }
  const Pose3& pose = tracker_.state()->world_from_body;
  const CrazyflieTelemetry& telemetry = link_.telemetry();
  if (!is_airborne(orders_.state) && telemetry.info_at() && !telemetry.has(info::kFlying)) {
    ground_m_ = pose.translation_m.z();
    link_.set_start(pose);
  } else {
    link_.set_start(std::nullopt);
  }
  if (now + kPoseSlack >= next_pose_ && link_.is_connected(now)) {
    next_pose_ = std::max(next_pose_ + kPosePeriod, now);
    sent_pose_ = now;
    link_.send(crtp::encode(crtp::ExternalPose{pose.translation_m, pose.rotation}));
  }
  if (may_send_setpoint(now)) {
    fly(now);
  }
}

void CrazyflieDriver::on_command(const models::OperatorCommand& command, Time now) {
  static_cast<void>(guard_.on_command(command, now));  // the guard counts refusals
  if (command.action == models::OperatorAction::kEmergencyStop) {
    next_setpoint_ = now;  // the next tick decides, without waiting for a set-point
  }
}

EndFacts CrazyflieDriver::end_facts(Time now) const {
  const CrazyflieTelemetry& telemetry = link_.telemetry();
  EndFacts out;
  if (is_airborne(orders_.state) || sequence_.is_armed(telemetry)) {
    out.in_flight = InFlight::kYes;
  } else if (telemetry.has_info(now)) {
    out.in_flight = InFlight::kNo;
  }
  out.lands_itself =
      telemetry.has_info(now) && telemetry.has(info::kFlying | info::kHighLevelActive);
  return out;
}

void CrazyflieDriver::tick(Time now) {
  if (now >= next_setpoint_) {
    fly(now);
  }
  link_.tick(now);
}

CrazyflieGoal CrazyflieDriver::goal(const GuardOutput& out) const {
  switch (out.state) {
    case FlightState::kIdle:
      return out.wants_armed ? CrazyflieGoal::kArm : CrazyflieGoal::kGrounded;
    case FlightState::kFollow:
    case FlightState::kHold:
      // A vehicle that was found flying lands; it is never steered.
      return sequence_.goal() == CrazyflieGoal::kLand ||
                     sequence_.goal() == CrazyflieGoal::kGrounded
                 ? CrazyflieGoal::kLand
                 : CrazyflieGoal::kFly;
    case FlightState::kLand: {
      const bool is_vehicles = out.setpoint.kind != FlightSetpoint::Kind::kTrack ||
                               !out.wants_armed || (out.is_sinking && is_below(kHandOverM)) ||
                               sequence_.goal() != CrazyflieGoal::kFly || is_hurried_;
      return is_vehicles ? CrazyflieGoal::kLand : CrazyflieGoal::kFly;
    }
    case FlightState::kKilled:
      return CrazyflieGoal::kKill;
  }
  return CrazyflieGoal::kGrounded;
}

void CrazyflieDriver::fly(Time now) {
  const double elapsed_s = std::min(0.1, update_orders(now));
  flown_s_ += link_.telemetry().has(info::kFlying) ? elapsed_s : 0.0;
  sequence_.set_goal(goal(orders_));

  const std::optional<BodyState>& body = tracker_.state();
  const std::optional<BodyState> seen = seen_body(now);
  CrazyflieSequence::Situation situation;
  situation.now = now;
  situation.may_arm = body && !link_.fault(now) && link_.telemetry().is_estimate_good(now) &&
                      sent_pose_ && to_seconds(now - *sent_pose_) < kSentMaxS;
  situation.ground_m = ground_m_.value_or(0.0);
  situation.height_m = body ? body->world_from_body.translation_m.z() : situation.ground_m;
  situation.is_seen = seen.has_value();
  situation.is_low = seen && ground_m_ && situation.height_m - *ground_m_ < kLowM;
  if (sequence_.step(link_, situation) && orders_.setpoint.kind == FlightSetpoint::Kind::kTrack) {
    send_setpoint(steer(orders_.setpoint, seen, vehicle_));
  }
}

void CrazyflieDriver::send_setpoint(const Setpoint& setpoint) {
  crtp::FullStateSetpoint out;
  out.position_world_m = setpoint.position_world_m;
  out.velocity_world_mps = setpoint.velocity_world_mps;
  out.acceleration_world_mps2 = setpoint.acceleration_world_mps2;
  out.world_from_body = Quaternion(Eigen::AngleAxisd(setpoint.yaw_rad, Eigen::Vector3d::UnitZ()));
  out.rate_body_radps.z() = setpoint.yaw_rate_radps;
  link_.send(crtp::encode(out));
}

models::VehicleStatus CrazyflieDriver::status(Time now) const {
  models::VehicleStatus out = guard_.status(now);
  if (const auto fault = link_.fault(now)) {
    out.reasons.push_back(*fault);
    return out;
  }
  if (!link_.telemetry().is_estimate_good(now)) {
    out.reasons.emplace_back("the vehicle receives no poses, or does not know its position");
  }
  if (spec_.battery == scenario::CrazyflieBattery::kVoltage && !link_.has_battery()) {
    out.reasons.emplace_back(
        "the vehicle does not report its battery: set robots[].crazyflie.battery to none if it "
        "cannot");
  }
  if (const auto& waiting = sequence_.waiting_for()) {
    out.reasons.push_back("waiting for " + *waiting);
  }
  return out;
}

std::vector<models::NamedCount> CrazyflieDriver::counters() const {
  std::vector<models::NamedCount> out = link_.counters();
  append_counters(out, "crazyflie");
  return out;
}

}  // namespace vantage::drivers
