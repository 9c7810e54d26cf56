#include "drivers/safety/limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/check.hpp"
#include "wire/autopilot/parameter_rules.hpp"

namespace vantage::drivers {
namespace {

// s; a Crazyflie keeps its last set-point for 0.5 s, then levels without braking
constexpr double kCrazyflieSetpointLossS = 0.5;

struct Bound {
  const char* name;
  double value;
};

void require_less(const Bound& low, const Bound& high) {
  require(low.value > 0.0 && low.value < high.value && std::isfinite(high.value),
          std::string("safety limits: 0 < ") + low.name + " < " + high.name);
}

/// Returns the delay from the capture of a pose to the first change of velocity, s.
double reaction_s(models::AutopilotDialect dialect) {
  switch (dialect) {
    case models::AutopilotDialect::kPx4:
      return 0.20;
    case models::AutopilotDialect::kArdupilot:
      return 0.20;
  }
  return 0.20;
}

/// Returns the longest set-point timeout with which an autopilot may be armed, s.
double setpoint_timeout_max_s(models::AutopilotDialect dialect) {
  const char* const name =
      dialect == models::AutopilotDialect::kPx4 ? "COM_OF_LOSS_T" : "GUID_TIMEOUT";
  const std::vector<wire::ParameterRule>& rules = wire::parameter_rules(dialect);
  const auto rule = std::find_if(rules.begin(), rules.end(),
                                 [name](const auto& each) { return each.name == name; });
  require(
      rule != rules.end() && rule->kind == wire::ParameterRule::Kind::kAtMost && !rule->is_advised,
      std::string("config/autopilot: ") + name + " needs a rule that begins with `at most`");
  return rule->bounds[0];
}

/// Returns the additional time of flight after the last set-point, s: the timeout, and an allowance
/// for the gentler braking of ArduPilot. Measured by 15 kills of a driver for each autopilot.
double setpoint_loss_s(models::AutopilotDialect dialect) {
  constexpr double kArdupilotGentleS = 0.15;
  return setpoint_timeout_max_s(dialect) +
         (dialect == models::AutopilotDialect::kArdupilot ? kArdupilotGentleS : 0.0);
}

double distance_to_stop_m(double speed_mps, double on_s, double brake_mps2) {
  return speed_mps * on_s + 0.5 * speed_mps * speed_mps / brake_mps2;
}

}  // namespace

double stopping_distance_m(const SafetyLimits& limits, double speed_mps) {
  return distance_to_stop_m(speed_mps, limits.reaction_s, limits.vehicle.brake_mps2);
}

double stopping_distance_after_loss_m(const SafetyLimits& limits, double speed_mps) {
  return distance_to_stop_m(speed_mps, limits.setpoint_loss_s + limits.reaction_s,
                            limits.vehicle.brake_mps2);
}

double half_window_s(const models::VehicleLimits& vehicle) {
  return vehicle.speed_max_mps / (2.0 * vehicle.brake_mps2);
}

SafetyLimits limits_for(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* spec = scenario.find_robot(robot);
  require(spec != nullptr, "flight safety: robot " + robot + " is not in the scenario");
  SafetyLimits limits;
  limits.fence = scenario.world;
  limits.vehicle = spec->limits;
  if (spec->autopilot) {
    limits.reaction_s = reaction_s(spec->autopilot->dialect);
    limits.setpoint_loss_s = setpoint_loss_s(spec->autopilot->dialect);
  }
  if (spec->crazyflie) {
    limits.setpoint_loss_s = kCrazyflieSetpointLossS;
  }
  limits.take_off_height_m = spec->height_m;
  limits.start = spec->start;
  // The planner ensures separation_m; the margin allows for rounding in messages.
  limits.plan_separation_m = scenario.planner.separation_m - 0.01;
  const double contact_m = 2.0 * spec->limits.radius_m;
  limits.separation_land_m = contact_m;
  limits.separation_hold_m =
      contact_m + 0.5 * std::max(0.02, scenario.planner.separation_m - contact_m);
  limits.landing_clearance_m = contact_m + 0.2;
  // Less than half the separation: an accepted pose is closer to the vehicle than to other bodies.
  limits.pose_gate_max_m = std::min(0.6, 0.48 * limits.separation_hold_m);
  limits.pose_gate_m = std::min(limits.pose_gate_m, 0.95 * limits.pose_gate_max_m);
  // Closer to an obstacle a vehicle would hover forever, since the planner finds no path from
  // there.
  limits.hover_clearance_m = std::max(0.05, scenario.planner.obstacle_margin_m);
  const double round_s = scenario.planner.execute_steps * scenario.planner.step_s;
  limits.round_s = round_s;
  limits.plan_age_hold_s = std::max(limits.plan_age_hold_s, round_s + 0.5);
  limits.plan_silent_warn_s = limits.plan_age_hold_s;
  limits.planner_lease_s = std::max(limits.planner_lease_s, round_s + 0.5);
  limits.plan_future_max_s = std::max(limits.plan_future_max_s, 2.0 * round_s);
  limits.tracking_hold_m = 2.0 * scenario.planner.tracking_tolerance_m;
  limits.hover_off_m = scenario.planner.tracking_tolerance_m;
  limits.tracking_land_m = 5.0 * scenario.planner.tracking_tolerance_m;
  limits.plan_start_tolerance_m = 2.0 * scenario.planner.tracking_tolerance_m;
  check_limits(limits);
  return limits;
}

// Long function: it checks one rule per limit.
void check_limits(const SafetyLimits& l) {
  require_less({"pose_age_warn_s", l.pose_age_warn_s}, {"pose_age_hold_s", l.pose_age_hold_s});
  require_less({"pose_age_hold_s", l.pose_age_hold_s}, {"pose_age_land_s", l.pose_age_land_s});
  require_less({"pose_age_land_s", l.pose_age_land_s}, {"pose_age_kill_s", l.pose_age_kill_s});
  require_less({"pose_gate_m", l.pose_gate_m}, {"pose_gate_max_m", l.pose_gate_max_m});
  require_less({"pose_sigma_hold_m", l.pose_sigma_hold_m},
               {"pose_sigma_land_m", l.pose_sigma_land_m});
  require_less({"tracking_hold_m", l.tracking_hold_m}, {"tracking_land_m", l.tracking_land_m});
  require_less({"lift_other_rise_m", l.lift_other_rise_m}, {"lift_risen_m", l.lift_risen_m});
  require_less({"lift_risen_m", l.lift_risen_m}, {"lift_height_m", l.lift_height_m});
  require_less({"lift_height_m", l.lift_height_m}, {"lift_done_m", l.lift_done_m});
  require_less({"lift_step_m", l.lift_step_m}, {"lift_deviation_m", l.lift_deviation_m});
  require_less({"separation_land_m", l.separation_land_m},
               {"separation_hold_m", l.separation_hold_m});
  require_less({"battery_empty_share", l.battery_empty_share},
               {"battery_land_share", l.battery_land_share});
  require_less({"battery_land_share", l.battery_land_share},
               {"battery_low_share", l.battery_low_share});
  require_less({"battery_low_share", l.battery_low_share},
               {"battery_arm_share", l.battery_arm_share});
  require_less({"heartbeat_age_hold_s", l.heartbeat_age_hold_s},
               {"heartbeat_age_land_s", l.heartbeat_age_land_s});
  require_less({"estimate_error_hold_m", l.estimate_error_hold_m},
               {"estimate_error_land_m", l.estimate_error_land_m});
  require_less({"velocity_error_hold_mps", l.velocity_error_hold_mps},
               {"velocity_error_land_mps", l.velocity_error_land_mps});
  require_less({"operator_age_hold_s", l.operator_age_hold_s},
               {"operator_age_land_s", l.operator_age_land_s});
  require_less({"low_descent_mps", l.low_descent_mps}, {"descent_mps", l.descent_mps});
  require_less({"processor_wait_arm_s", l.processor_wait_arm_s},
               {"processor_wait_hold_s", l.processor_wait_hold_s});
  const std::array<Bound, 24> positive = {{
      {"safe_height_m", l.safe_height_m},
      {"reaction_s", l.reaction_s},
      {"setpoint_loss_s", l.setpoint_loss_s},
      {"plan_separation_m", l.plan_separation_m},
      {"planner_lease_s", l.planner_lease_s},
      {"climb_mps", l.climb_mps},
      {"other_turn_mps2", l.other_turn_mps2},
      {"other_prediction_s", l.other_prediction_s},
      {"landing_prediction_s", l.landing_prediction_s},
      {"descent_prediction_s", l.descent_prediction_s},
      {"low_height_m", l.low_height_m},
      {"flight_max_s", l.flight_max_s},
      {"lift_wait_s", l.lift_wait_s},
      {"lift_proof_s", l.lift_proof_s},
      {"arm_wait_s", l.arm_wait_s},
      {"clear_s", l.clear_s},
      {"velocity_memory_s", l.velocity_memory_s},
      {"hover_speed_mps", l.hover_speed_mps},
      {"hover_off_m", l.hover_off_m},
      {"sink_error_m", l.sink_error_m},
      {"speed_max_mps", l.vehicle.speed_max_mps},
      {"yaw_rate_max_radps", l.vehicle.yaw_rate_max_radps},
      {"brake_mps2", l.vehicle.brake_mps2},
      {"take_off_height_m", l.take_off_height_m},
  }};
  for (const Bound& bound : positive) {
    require(std::isfinite(bound.value) && bound.value > 0.0,
            std::string("safety limits: ") + bound.name + " must be positive and finite");
  }
  require(l.take_off_height_m < l.fence.ceiling_m,
          "safety limits: take_off_height_m must be below the ceiling");
}

}  // namespace vantage::drivers
