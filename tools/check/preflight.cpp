#include "tools/check/preflight.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bus/transport/url.hpp"
#include "core/check.hpp"
#include "drivers/safety/limits.hpp"
#include "drivers/safety/plan_check.hpp"
#include "models/plan/plan.hpp"
#include "models/target/law.hpp"
#include "models/world/world.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "scenario/search_name.hpp"
#include "scenario/vehicle_kinds.hpp"
#include "sim/rover/starts.hpp"
#include "tools/check/purpose_notes.hpp"
#include "tools/up/process_plan.hpp"

namespace vantage::tools {
namespace {

using scenario::Scenario;

const char* name_of(scenario::DeviceSource source) {
  switch (source) {
    case scenario::DeviceSource::kDirect:
      return "simulated";
    case scenario::DeviceSource::kWire:
      return "simulated behind its protocol";
    case scenario::DeviceSource::kReal:
      return "real";
  }
  return "unknown";
}

void describe(const Scenario& scenario, std::vector<std::string>& out) {
  const Eigen::Vector2d size_m = scenario.world.bounds.max_m - scenario.world.bounds.min_m;
  out.push_back(fmt::format("{}: {:g} x {:g} m, {} obstacles, {} regions; {:g} s, seed {}",
                            scenario.name, size_m.x(), size_m.y(), scenario.world.obstacles.size(),
                            scenario.world.regions.size(), scenario.duration_s, scenario.seed));
  for (const scenario::RobotSpec& robot : scenario.robots) {
    out.push_back(fmt::format(
        "robot {}: {}, starts at ({:g}, {:g}) at {:g} m, {} primitives up to {:g} m/s, sensor "
        "range {:g} m over {:.0f} deg ({})",
        robot.name, name_of(robot.device), robot.start.x_m, robot.start.y_m, robot.height_m,
        robot.primitives.size(), robot.limits.speed_max_mps, robot.sensor.range_max_m,
        degrees(robot.sensor.fov_rad), robot.sensor.kind.name()));
  }
  const bool has_ids = scenario.robots.empty() || scenario.robots.front().detection.detects_ids;
  out.push_back(fmt::format(
      "{} targets{}; {}", scenario.targets.size(), has_ids ? "" : ", detected without ids",
      scenario.network.communication_range_m > 0.0
          ? fmt::format("communication within {:g} m", scenario.network.communication_range_m)
          : std::string("no communication of beliefs")));
  if (const auto localizer = scenario::localizer_of(scenario)) {
    const bool is_simulated = localizer->simulation.has_value();
    out.push_back(fmt::format(
        "{} robots compute their pose with {} landmarks{}{}; without mocap, rovers {} by this pose",
        localizer->robots.size(), localizer->landmarks.size(),
        is_simulated ? "; odometry and sightings are simulated" : "",
        is_simulated && !localizer->simulation->mocap_withheld.empty()
            ? ", motion capture is withheld"
            : "",
        localizer->safety.rovers_may_drive ? "drive" : "do not drive"));
  }
  const scenario::PlannerSpec& planner = scenario.planner;
  const double round_s = planner.execute_steps * planner.step_s;
  const std::string budget =
      planner.node_budget > 0
          ? fmt::format("{} nodes per slot", planner.node_budget)
          : fmt::format("{:g} s planning time for the team", planner.team_budget_s);
  out.push_back(fmt::format("planner {}: horizon {} x {:g} s, a round every {:g} s, {}",
                            scenario::search_name(planner), planner.horizon_steps, planner.step_s,
                            round_s, budget));
}

void check_robots(const Scenario& scenario, std::vector<std::string>& faults) {
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const scenario::RobotSpec& robot = scenario.robots[i];
    const double clear_m = models::clearance_m(scenario.world, robot.start.position_m());
    const double needed_m = robot.limits.radius_m + scenario.planner.obstacle_margin_m;
    if (clear_m <= needed_m) {
      faults.push_back(fmt::format(
          "robot {}: its start is {:.2f} m from the nearest obstacle or wall; it needs more than "
          "{:.2f} m (radius_m + obstacle_margin_m)",
          robot.name, clear_m, needed_m));
    }
    if (robot.primitives.empty()) {
      faults.push_back(
          fmt::format("robot {}: it has no primitives, so it cannot move", robot.name));
    }
    const Eigen::Vector3d a_m = lift(robot.start, robot.height_m).translation_m;
    for (std::size_t j = i + 1; j < scenario.robots.size(); ++j) {
      const scenario::RobotSpec& other = scenario.robots[j];
      const double apart_m = (a_m - lift(other.start, other.height_m).translation_m).norm();
      if (apart_m < scenario.planner.separation_m) {
        faults.push_back(
            fmt::format("robots {} and {}: their starts are {:.2f} m apart, but must be at least "
                        "planner.separation_m ({:g} m) apart",
                        robot.name, other.name, apart_m, scenario.planner.separation_m));
      }
    }
  }
}

// Adds faults for vehicles that touch at the separation, and for limits and primitives that flight
// safety refuses.
void check_safety(const Scenario& scenario, std::vector<std::string>& faults) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (scenario.planner.separation_m <= 2.0 * robot.limits.radius_m) {
      faults.push_back(
          fmt::format("robot {}: planner.separation_m is {:g}; vehicles of radius {:g} m touch at "
                      "that distance; increase it",
                      robot.name, scenario.planner.separation_m, robot.limits.radius_m));
    }
    drivers::SafetyLimits limits;
    try {
      limits = drivers::limits_for(scenario, robot.name);
    } catch (const UsageError& error) {
      faults.push_back(fmt::format("robot {}: {}", robot.name, error.what()));
      continue;
    }
    for (const models::UnicycleControl& control : robot.primitives) {
      models::Trajectory trajectory;
      trajectory.segments = {{control, scenario.planner.step_s, 0.0}};
      for (const models::PlanSegment& stop :
           models::brake(control.speed_mps, robot.limits.brake_mps2)) {
        trajectory.segments.push_back(stop);
      }
      drivers::HeldPlan plan;
      if (drivers::hold_plan(trajectory, plan) &&
          drivers::check_shape(plan, limits) != drivers::PlanVerdict::kAccepted) {
        faults.push_back(
            fmt::format("robot {}: flight safety rejects the primitive {:g} m/s, {:g} rad/s: {}",
                        robot.name, control.speed_mps, control.yaw_rate_radps,
                        drivers::name_of(drivers::check_shape(plan, limits))));
      }
    }
  }
}

// Returns `words` after the line number of a key in the scenario file: "line 12: …".
std::string at_line(const Scenario& scenario, const std::string& key, const std::string& words) {
  const int line =
      scenario.source_text.empty() ? 0 : scenario::line_of_key(scenario.source_text, key);
  return line > 0 ? fmt::format("line {}: {}", line, words) : words;
}

void check_network(const Scenario& scenario, std::vector<std::string>& faults) {
  try {
    const bus::Url url = bus::parse_url(scenario.network.url);
    if (url.scheme == "udpm") {
      static_cast<void>(bus::parse_udpm(url));
    }
  } catch (const StartupError& error) {
    faults.push_back(at_line(scenario, "network.url",
                             "network.url '" + scenario.network.url + "': " + error.what()));
  }
}

// Adds a fault if the simulator could not find free positions for the targets.
void check_free_ground(const Scenario& scenario, std::vector<std::string>& faults) {
  try {
    static_cast<void>(sim::target_starts(scenario, scenario.seed));
  } catch (const UsageError& error) {
    faults.push_back(
        at_line(scenario, "targets",
                std::string(error.what()) + "; use fewer targets or larger world.bounds"));
  }
}

void check_targets(const Scenario& scenario, std::vector<std::string>& faults) {
  for (const scenario::TargetSpec& target : scenario.targets) {
    if (target.start &&
        models::clearance_m(scenario.world, target.start->position_m()) <= target.radius_m) {
      faults.push_back(
          fmt::format("target {}: its start touches an obstacle or wall", target.name));
    }
  }
}

void check_round(const Scenario& scenario, std::vector<std::string>& faults) {
  const scenario::PlannerSpec& planner = scenario.planner;
  const double round_s = planner.execute_steps * planner.step_s;
  if (planner.team_budget_s + planner.publish_margin_s > round_s) {
    faults.push_back(
        fmt::format("planner: team_budget_s + publish_margin_s is {:g} s, but must be at most the "
                    "round of {:g} s",
                    planner.team_budget_s + planner.publish_margin_s, round_s));
  }
  if (planner.execute_steps > planner.horizon_steps) {
    faults.emplace_back("planner: execute_steps must not be greater than horizon_steps");
  }
}

double speed_max_mps(const scenario::RobotSpec& robot) {
  double out = 0.0;
  for (const models::UnicycleControl& control : robot.primitives) {
    out = std::max(out, std::abs(control.speed_mps));
  }
  return out;
}

// Adds a note if the separation or the obstacle margin is too small for a driver that dies while
// its vehicle moves. Plans are checked with stopping_distance_m(). stopping_distance_after_loss_m()
// also includes the distance flown during the autopilot's time-out.
void note_driver_loss(const Scenario& scenario, std::vector<std::string>& notes) {
  struct Lost {
    const scenario::RobotSpec* robot = nullptr;
    double speed_mps = 0.0;
    double distance_m = 0.0;  ///< m; distance until the vehicle hovers
    double beyond_m = 0.0;    ///< m; part of distance_m that is beyond the checked path
  };
  Lost worst;
  double radius_m = 0.0;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    radius_m = std::max(radius_m, robot.limits.radius_m);
    if (robot.device == scenario::DeviceSource::kDirect) {
      continue;  // a robot with the device `direct` has no driver
    }
    drivers::SafetyLimits limits;
    try {
      limits = drivers::limits_for(scenario, robot.name);
    } catch (const UsageError&) {
      continue;  // check_safety() reports invalid limits
    }
    const double speed_mps = speed_max_mps(robot);
    const double distance_m = drivers::stopping_distance_after_loss_m(limits, speed_mps);
    const double beyond_m = distance_m - drivers::stopping_distance_m(limits, speed_mps);
    if (worst.robot == nullptr || beyond_m > worst.beyond_m) {
      worst = {&robot, speed_mps, distance_m, beyond_m};
    }
  }
  if (worst.robot == nullptr) {
    return;
  }
  const double separation_m = 2.0 * radius_m + kLossSpareM + worst.beyond_m;
  const double margin_m = kLossSpareM + worst.beyond_m;
  const scenario::PlannerSpec& planner = scenario.planner;
  std::vector<std::string> changes;
  if (planner.separation_m < separation_m - 1e-9 && scenario.robots.size() > 1) {
    changes.push_back(
        fmt::format("planner.separation_m {:.2f} (is {:g})", separation_m, planner.separation_m));
  }
  const auto [lowest, highest] =
      std::minmax_element(scenario.robots.begin(), scenario.robots.end(),
                          [](const auto& a, const auto& b) { return a.height_m < b.height_m; });
  if (!planner.separation_from_above && lowest->height_m < highest->height_m) {
    changes.push_back("planner.separation_from_above (the vehicle lands straight down)");
  }
  if (planner.obstacle_margin_m < margin_m - 1e-9) {
    changes.push_back(fmt::format("planner.obstacle_margin_m {:.2f} (is {:g})", margin_m,
                                  planner.obstacle_margin_m));
  }
  if (!changes.empty()) {
    notes.push_back(fmt::format(
        "if a driver fails, its vehicle flies on: robot {} at {:g} m/s stops after {:.2f} m, "
        "{:.2f} m beyond the checked path. To avoid contact then, set {}, or fly slower",
        worst.robot->name, worst.speed_mps, worst.distance_m, worst.beyond_m,
        fmt::join(changes, " and ")));
  }
}

// Adds a note if plans are published too late. A vehicle cannot change its motion instantly, so it
// starts to change its motion before the plan begins (drivers::Course). If the plan is published
// after this instant, the vehicle deviates farther from it.
void note_late_plans(const Scenario& scenario, std::vector<std::string>& notes) {
  double early_s = 0.0;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    const scenario::VehicleKind* const kind = scenario::vehicle_kind(robot);
    if (robot.device != scenario::DeviceSource::kDirect && kind != nullptr && kind->flies) {
      early_s = std::max(
          early_s, drivers::SafetyLimits{}.setpoint_lead_s + drivers::half_window_s(robot.limits));
    }
  }
  if (scenario.planner.publish_margin_s < early_s) {
    notes.push_back(fmt::format(
        "the robot that plans last in a round deviates from its plan about twice as far as the "
        "others: plans are published {:g} s before they begin, but a vehicle starts to change its "
        "motion {:.2f} s before its plan begins; set planner.publish_margin_s to {:.2f} or more",
        scenario.planner.publish_margin_s, early_s, early_s));
  }
}

void note_wind(const Scenario& scenario, std::vector<std::string>& notes) {
  const bool is_felt =
      std::any_of(scenario.robots.begin(), scenario.robots.end(), [](const auto& robot) {
        const scenario::VehicleKind* kind = scenario::vehicle_kind(robot);
        return robot.device != scenario::DeviceSource::kReal && (kind == nullptr || kind->flies);
      });
  if (scenario.wind && !is_felt) {
    notes.push_back(
        fmt::format("wind x_mps {:g}, y_mps {:g} has no effect: it only moves simulated flying "
                    "vehicles, and this scenario has none",
                    scenario.wind->x_mps, scenario.wind->y_mps));
  }
}

// With a static target model each measurement shrinks the covariance, even if the measurement
// contradicts the belief. After 20 s the belief may be 10⁹ times too confident.
void note_static_model_of_moving_targets(const Scenario& scenario,
                                         std::vector<std::string>& notes) {
  const models::TargetModel& believed = scenario.estimator.target_model;
  const models::TargetLaw& law = believed.kind.law();
  const bool is_assumed_stationary = law.is_constant || (law.uses_q && believed.q == 0.0);
  if (!is_assumed_stationary || scenario.targets.empty() ||
      scenario.target_truth.motion == scenario::TargetMotion::kStill) {
    return;
  }
  notes.push_back(fmt::format(
      "beliefs will be far too certain: the targets move, but the estimator assumes that they are "
      "stationary (estimator.target_model: {}); use the model that `vantage log fit-motion` finds",
      law.is_constant ? fmt::format("kind {}", law.name) : "q 0"));
}

}  // namespace

MemoryCheck check_planner_memory(const Scenario& scenario,
                                 std::optional<std::uint64_t> free_bytes) {
  std::size_t robots = scenario.hosts.empty() ? scenario.robots.size() : 0;
  for (const scenario::HostSpec& host : scenario.hosts) {
    const auto here = std::count_if(
        scenario.robots.begin(), scenario.robots.end(),
        [&](const scenario::RobotSpec& robot) { return scenario.runs_on(host.name, robot.name); });
    robots = std::max(robots, static_cast<std::size_t>(here));
  }
  const double needed = kPlannerBytes * static_cast<double>(robots);
  constexpr double kGiga = 1e9;
  const std::string words =
      fmt::format("memory: {} planners on one host need up to {:.1f} GB{}", robots, needed / kGiga,
                  free_bytes ? fmt::format("; {:.1f} GB are free on this host",
                                           static_cast<double>(*free_bytes) / kGiga)
                             : std::string());
  const bool is_enough = !free_bytes || static_cast<double>(*free_bytes) >= needed;
  return {is_enough, is_enough ? words : at_line(scenario, "robots", words)};
}

std::optional<std::uint64_t> free_memory_bytes() {
  std::ifstream file("/proc/meminfo");
  std::string name;
  std::uint64_t kibibytes = 0;
  for (std::string rest; file >> name >> kibibytes; std::getline(file, rest)) {
    if (name == "MemAvailable:") {
      return kibibytes << 10U;
    }
  }
  return std::nullopt;
}

Preflight check_preflight(const Scenario& scenario) {
  Preflight out;
  describe(scenario, out.understood);
  if (scenario.robots.empty()) {
    out.faults.emplace_back("the scenario has no robot");
  }
  check_robots(scenario, out.faults);
  check_safety(scenario, out.faults);
  check_targets(scenario, out.faults);
  check_free_ground(scenario, out.faults);
  check_network(scenario, out.faults);
  check_round(scenario, out.faults);
  for (std::string& fault : device_faults(scenario)) {
    out.faults.push_back(std::move(fault));
  }
  note_driver_loss(scenario, out.notes);
  note_late_plans(scenario, out.notes);
  note_wind(scenario, out.notes);
  note_static_model_of_moving_targets(scenario, out.notes);
  for (std::string& note : purpose_notes(scenario)) {
    out.notes.push_back(std::move(note));
  }
  return out;
}

}  // namespace vantage::tools
