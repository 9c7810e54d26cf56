#include "tools/check/purpose_notes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "models/sensor/law.hpp"
#include "models/target/law.hpp"
#include "scenario/search_name.hpp"

namespace vantage::tools {
namespace {

using models::SensorModel;
using scenario::RobotSpec;
using scenario::Scenario;

using Notes = std::vector<std::string>;

bool tracks_targets(const Scenario& scenario) {
  return scenario.planner.objective == scenario::PlanObjective::kTracking;
}

bool targets_move(const Scenario& scenario) {
  return !scenario.targets.empty() &&
         scenario.target_truth.motion != scenario::TargetMotion::kStill;
}

double world_size_m(const Scenario& scenario) {
  return (scenario.world.bounds.max_m - scenario.world.bounds.min_m).norm();
}

double fastest_mps(const Scenario& scenario) {
  double speed_mps = 0.0;
  for (const RobotSpec& robot : scenario.robots) {
    for (const models::UnicycleControl& control : robot.primitives) {
      speed_mps = std::max(speed_mps, control.speed_mps);
    }
  }
  return speed_mps;
}

double round_s(const scenario::PlannerSpec& planner) {
  return planner.execute_steps * planner.step_s;
}

void note_discovery(const Scenario& scenario, Notes& notes) {
  if (const auto obstacle = discovery_obstacle(scenario)) {
    notes.push_back(*obstacle);
  }
}

// Long function: it checks one rule per parameter of a sensor.
void note_sensors(const Scenario& scenario, Notes& notes) {
  for (const RobotSpec& robot : scenario.robots) {
    const SensorModel& sensor = robot.sensor;
    const models::SensorLaw& law = sensor.kind.law();
    const auto note = [&](std::string_view key, double value, std::string_view consequence) {
      notes.push_back(
          fmt::format("robot {}: sensor.{} {:g}: {}", robot.name, key, value, consequence));
    };
    if (sensor.range_max_m <= robot.limits.radius_m) {
      note("range_max_m", sensor.range_max_m,
           fmt::format("not more than the robot's radius_m {:g}, so the robot sees a target only "
                       "when they touch; increase the range",
                       robot.limits.radius_m));
    }
    if (scenario.estimator.target_model.position_dim == 3 && sensor.range_max_m <= robot.height_m) {
      note("range_max_m", sensor.range_max_m,
           fmt::format("not more than height_m {:g}, so no target on the ground is in range; fly "
                       "lower or increase the range",
                       robot.height_m));
    }
    if (sensor.range_min_m > 0.9 * sensor.range_max_m) {
      note("range_min_m", sensor.range_min_m,
           fmt::format("more than 90 % of range_max_m {:g}, so targets are seen in a thin ring "
                       "only; decrease it",
                       sensor.range_max_m));
    }
    if (degrees(sensor.fov_rad) < 5.0) {
      note("fov_deg", degrees(sensor.fov_rad),
           "targets are rarely in view; fov_deg is the full angle, not half of it");
    }
    if (law.measures_range && sensor.range_sigma_m >= sensor.range_max_m) {
      note("range_sigma_m", sensor.range_sigma_m,
           fmt::format("not less than range_max_m {:g}, so a range gives no information",
                       sensor.range_max_m));
    }
    if (law.measures_bearing && sensor.bearing_sigma_rad >= radians(90.0)) {
      note("bearing_sigma_deg", degrees(sensor.bearing_sigma_rad),
           "a bearing gives no information");
    }
    if (law.is_linear && sensor.position_sigma_m >= world_size_m(scenario)) {
      note("position_sigma_m", sensor.position_sigma_m,
           "a position gives no information in this world");
    }
    if (robot.detection.detection_probability < 0.05) {
      note("detection_probability", robot.detection.detection_probability,
           "almost every target in view is missed");
    }
    if (robot.detection.clutter_per_look > 10.0) {
      note("clutter_per_look", robot.detection.clutter_per_look,
           "most detections are false alarms; tracks are unreliable");
    }
  }
}

void note_detection_belief(const Scenario& scenario, Notes& notes) {
  constexpr double kTolerance = 0.3;
  const double assumed = scenario.estimator.detection_probability;
  for (const RobotSpec& robot : scenario.robots) {
    const double actual = robot.detection.detection_probability;
    if (assumed > 0.0 && assumed > actual + kTolerance) {
      notes.push_back(fmt::format(
          "robot {}: sensor.detection_probability {:g}, but estimator.detection_probability {:g}: "
          "beliefs move away from positions where the sensor only missed a target; set both to the "
          "same value",
          robot.name, actual, assumed));
      return;
    }
  }
}

void note_target_speed(const Scenario& scenario, Notes& notes) {
  if (!targets_move(scenario) ||
      scenario.target_truth.motion != scenario::TargetMotion::kRandomWaypoint) {
    return;
  }
  const double robots_mps = fastest_mps(scenario);
  const double targets_mps = scenario.target_truth.speed_max_mps;
  if (robots_mps > 0.0 && targets_mps > 2.0 * robots_mps) {
    notes.push_back(
        fmt::format("target_truth.speed_max_mps {:g}: targets are more than twice as fast as the "
                    "fastest robot, "
                    "{:g} m/s, which cannot follow them",
                    targets_mps, robots_mps));
  }
  if (scenario.target_truth.pause_max_s > 2.0 * scenario.duration_s) {
    notes.push_back(
        fmt::format("target_truth.pause_max_s {:g}: most pauses are longer than the trial, "
                    "duration_s {:g}, so most targets do not move",
                    scenario.target_truth.pause_max_s, scenario.duration_s));
  }
}

// Adds notes if the position of a target that is unobserved for ten seconds is too uncertain.
void note_target_model(const Scenario& scenario, Notes& notes) {
  constexpr double kUnseen_s = 10.0;
  const models::TargetModel& model = scenario.estimator.target_model;
  const models::TargetLaw& law = model.kind.law();
  // Some kinds of model ignore q. A usual value of q causes no note, because it may stay in the
  // file for comparisons with another kind.
  if (!law.uses_q && std::sqrt(model.q * kUnseen_s) > world_size_m(scenario)) {
    notes.push_back(fmt::format("estimator.target_model.q {:g}: kind {} does not use it; remove it",
                                model.q, law.name));
  }
  if (scenario.targets.empty()) {
    return;
  }
  const double sigma_m = std::sqrt(model.process_noise(kUnseen_s)(0, 0));
  if (law.uses_q && sigma_m > world_size_m(scenario)) {
    notes.push_back(fmt::format(
        "estimator.target_model.q {:g}: 10 s after its last measurement a target's position is "
        "uncertain by {:.3g} m, more than the world's diagonal, {:.3g} m; decrease it, or use the "
        "model that `vantage log fit-motion` finds",
        model.q, sigma_m, world_size_m(scenario)));
  }
  if (scenario.estimator.samples && !model.has_velocity()) {
    notes.push_back(fmt::format(
        "estimator.samples true: kind {} has no velocity, so no samples are used", law.name));
  }
}

void note_estimator(const Scenario& scenario, Notes& notes) {
  const scenario::EstimatorSpec& estimator = scenario.estimator;
  if (estimator.gate_sigma > 0.0 && estimator.gate_sigma < 1.5) {
    notes.push_back(
        fmt::format("estimator.gate_sigma {:g}: most correct detections are rejected; 3 to 5 is "
                    "usual, 0 switches the gate off",
                    estimator.gate_sigma));
  }
  const double fresh_s = round_s(scenario.planner);
  if (estimator.grid_memory_s > 0.0 && estimator.grid_memory_s < fresh_s &&
      tracks_targets(scenario)) {
    notes.push_back(
        fmt::format("estimator.grid_memory_s {:g}: less than a planning round, {:g} s, so the "
                    "whole world always "
                    "counts as unexplored",
                    estimator.grid_memory_s, fresh_s));
  }
}

void note_targets(const Scenario& scenario, Notes& notes) {
  if (tracks_targets(scenario) && scenario.targets.empty() && !scenario.robots.empty()) {
    notes.emplace_back(
        "targets: the scenario has none, so there is nothing to track; add targets, or set "
        "planner.objective: mapping");
  }
}

void note_primitives(const Scenario& scenario, Notes& notes) {
  for (const RobotSpec& robot : scenario.robots) {
    const auto any = [&](const auto& has) {
      return std::any_of(robot.primitives.begin(), robot.primitives.end(), has);
    };
    if (!any([](const auto& control) { return control.speed_mps > 0.0; })) {
      notes.push_back(fmt::format(
          "robot {}: primitives: none has a speed above 0, so it stays at its start; add "
          "one",
          robot.name));
    } else if (!any([](const auto& control) { return control.yaw_rate_radps != 0.0; })) {
      notes.push_back(fmt::format(
          "robot {}: primitives: none has a yaw rate, so it can only fly straight; add turns",
          robot.name));
    }
  }
}

void note_budgets(const Scenario& scenario, Notes& notes) {
  constexpr double kUseful_s = 0.005;
  const scenario::PlannerSpec& planner = scenario.planner;
  const auto robots = static_cast<double>(std::max<std::size_t>(scenario.robots.size(), 1));
  const double slots = planner.slots > 0 ? std::min<double>(planner.slots, robots) : robots;
  const double slot_s = planner.team_budget_s / slots;
  if (planner.node_budget == 0 && slot_s < kUseful_s && !scenario::is_external(planner)) {
    notes.push_back(fmt::format(
        "planner.team_budget_s {:g}: each of {:g} robots has {:.2g} ms per round to plan, which is "
        "too short for a search; {:g} or more is useful",
        planner.team_budget_s, robots, 1e3 * slot_s, kUseful_s * slots));
  }
  std::size_t controls = 0;
  for (const RobotSpec& robot : scenario.robots) {
    controls = std::max(controls, robot.primitives.size());
  }
  const auto one_path = static_cast<std::int64_t>(controls) * planner.horizon_steps;
  if (planner.node_budget > 0 && planner.node_budget < one_path) {
    notes.push_back(fmt::format(
        "planner.node_budget {}: fewer nodes than one path needs ({} primitives · {} steps), so no "
        "search reaches its horizon",
        planner.node_budget, controls, planner.horizon_steps));
  }
}

void note_plans(const Scenario& scenario, Notes& notes) {
  const scenario::PlannerSpec& planner = scenario.planner;
  const double plan_s = planner.horizon_steps * planner.step_s;
  for (const RobotSpec& robot : scenario.robots) {
    const double stop_s = robot.limits.speed_max_mps / robot.limits.brake_mps2;
    if (plan_s < stop_s) {
      notes.push_back(
          fmt::format("planner.step_s {:g}: a plan lasts {:g} s, less than robot {} needs to stop, "
                      "{:.2g} s; increase step_s or horizon_steps",
                      planner.step_s, plan_s, robot.name, stop_s));
      break;
    }
  }
  if (scenario.duration_s < 2.0 * round_s(planner)) {
    notes.push_back(fmt::format(
        "duration_s {:g}: the trial ends before the second planning round; a round lasts {:g} s",
        scenario.duration_s, round_s(planner)));
  }
  if (scenario.robots.size() > 1 && planner.tracking_tolerance_m > 0.5 * planner.separation_m) {
    notes.push_back(fmt::format(
        "planner.tracking_tolerance_m {:g}: more than half of separation_m {:g}, so two "
        "robots within their tolerance may touch",
        planner.tracking_tolerance_m, planner.separation_m));
  }
}

void note_team(const Scenario& scenario, Notes& notes) {
  const scenario::PlannerSpec& planner = scenario.planner;
  const auto robots = static_cast<int>(scenario.robots.size());
  if (planner.team_algorithm.exchanges_solutions() && robots == 1) {
    notes.push_back(fmt::format("planner.team_algorithm {}: has no effect with one robot",
                                planner.team_algorithm.name()));
  }
  const double range_m = scenario.network.communication_range_m;
  if (robots > 1 && range_m > 0.0 && range_m <= planner.separation_m) {
    notes.push_back(fmt::format(
        "network.communication_range_m {:g}: not more than planner.separation_m {:g}, so robots "
        "never exchange beliefs; increase the range, or set 0 if they must not exchange beliefs",
        range_m, planner.separation_m));
  }
}

void note_attacks(const Scenario& scenario, Notes& notes) {
  for (std::size_t i = 0; i < scenario.attacks.size(); ++i) {
    if (scenario.attacks[i].from_s >= scenario.duration_s) {
      notes.push_back(
          fmt::format("attacks[{}].from_s {:g}: not before the end of the trial, duration_s {:g}, "
                      "so the attack never happens",
                      i, scenario.attacks[i].from_s, scenario.duration_s));
    }
  }
}

// Long function: it checks one rule per parameter of the motion capture system.
void note_mocap(const Scenario& scenario, Notes& notes) {
  constexpr double kUsefulRate_hz = 10.0;
  const scenario::MocapSpec& mocap = scenario.mocap;
  if (mocap.rate_hz < kUsefulRate_hz) {
    notes.push_back(
        fmt::format("mocap.rate_hz {:g}: poses are up to {:.2g} s old; sensors and drivers need "
                    "{:g} Hz or more",
                    mocap.rate_hz, 1.0 / mocap.rate_hz, kUsefulRate_hz));
  }
  if (mocap.latency_s > 0.2) {
    notes.push_back(fmt::format(
        "mocap.latency_s {:g}: poses arrive too late to control a vehicle; it then holds or lands",
        mocap.latency_s));
  }
  for (const RobotSpec& robot : scenario.robots) {
    if (mocap.gate_speed_mps > 0.0 && mocap.gate_speed_mps <= robot.limits.speed_max_mps) {
      notes.push_back(fmt::format(
          "mocap.gate_speed_mps {:g}: not more than the speed of robot {}, {:g} m/s, so "
          "its poses are rejected when it moves",
          mocap.gate_speed_mps, robot.name, robot.limits.speed_max_mps));
      break;
    }
  }
  for (const RobotSpec& robot : scenario.robots) {
    if (mocap.gate_turn_radps > 0.0 && mocap.gate_turn_radps <= robot.limits.yaw_rate_max_radps) {
      notes.push_back(fmt::format(
          "mocap.gate_turn_radps {:g}: not more than the yaw rate of robot {}, {:g} rad/s, so its "
          "poses are rejected when it turns",
          mocap.gate_turn_radps, robot.name, robot.limits.yaw_rate_max_radps));
      break;
    }
  }
  if (mocap.position_sigma_m > scenario.planner.tracking_tolerance_m) {
    notes.push_back(fmt::format(
        "mocap.position_sigma_m {:g}: more than planner.tracking_tolerance_m {:g}, so a "
        "vehicle cannot tell whether it follows its plan",
        mocap.position_sigma_m, scenario.planner.tracking_tolerance_m));
  }
}

constexpr void (*kRules[])(const Scenario&, Notes&) = {
    note_discovery,    note_sensors,      note_detection_belief,
    note_target_speed, note_target_model, note_estimator,
    note_targets,      note_primitives,   note_budgets,
    note_plans,        note_team,         note_attacks,
    note_mocap};

}  // namespace

std::optional<std::string> discovery_obstacle(const Scenario& scenario) {
  if (!tracks_targets(scenario) || scenario.targets.empty() || scenario.robots.empty()) {
    return std::nullopt;
  }
  // In a plane, several detections together determine a position (estimator::PositionHypotheses).
  const bool is_planar = scenario.estimator.target_model.position_dim == 2;
  const auto finds = [is_planar](const RobotSpec& robot) {
    return is_planar || robot.sensor.kind.law().position_from != nullptr;
  };
  if (std::any_of(scenario.robots.begin(), scenario.robots.end(), finds)) {
    return std::nullopt;
  }
  std::string kinds;
  for (const models::SensorKind kind : models::all_sensor_kinds()) {
    if (kind.law().position_from != nullptr) {
      kinds.append(kinds.empty() ? "" : ", ").append(kind.name());
    }
  }
  return fmt::format(
      "no target can be found: target_model.position_dim is 3, and no robot's sensor determines a "
      "position (robot {}: sensor.kind {}); set position_dim: 2 or give at least one robot a "
      "sensor of kind {}",
      scenario.robots.front().name, scenario.robots.front().sensor.kind.name(), kinds);
}

std::vector<std::string> purpose_notes(const Scenario& scenario) {
  Notes notes;
  for (const auto rule : kRules) {
    rule(scenario, notes);
  }
  return notes;
}

}  // namespace vantage::tools
