#include "experiments/tracking/team_trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "scenario/reader/overrides.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "scenario/reader/text_file.hpp"
#include "trial/scenario/config_folder.hpp"
#include "trial/trial.hpp"

namespace vantage::experiments {
namespace {

// Returns the robots' entries in YAML. Robots are evenly spaced on a circle around the centre, face
// outwards and have different heights.
std::string circle_of_robots(int count) {
  constexpr double kRadius_m = 4.0;
  std::string robots;
  for (int i = 0; i < count; ++i) {
    const double at_rad = 2.0 * kPi * i / count;
    robots += fmt::format(
        "{{name: Q{}, start: {{x_m: {:.4f}, y_m: {:.4f}, yaw_deg: {:.4f}}}, height_m: {:.1f}}}, ",
        i + 1, kRadius_m * std::cos(at_rad), kRadius_m * std::sin(at_rad),
        std::remainder(360.0 * i / count, 360.0), 2.0 + 0.5 * i);
  }
  return "[" + robots + "]";
}

scenario::Overrides overrides_of(const TeamTrial& trial, std::size_t robots, std::uint64_t seed) {
  scenario::Overrides out;
  out.seed = seed;
  out.duration_s = trial.duration_s;
  out.planner = trial.planner;
  out.communication_range_m = trial.communication_range_m;
  out.node_budget = static_cast<std::int64_t>(
      std::max(1.0, kReferenceNodesPerS * trial.planning_time_s / static_cast<double>(robots)));
  const auto set = [&](const char* path, const auto& value) {
    if (value) {
      out.keys[path] = fmt::format("{}", *value);
    }
  };
  set("targets.count", trial.targets);
  set("robot_defaults.sensor.range_sigma_m", trial.range_sigma_m);
  set("robot_defaults.sensor.bearing_sigma_deg", trial.bearing_sigma_deg);
  if (trial.robots) {
    out.keys["robots"] = circle_of_robots(*trial.robots);
  }
  return out;
}

}  // namespace

const char* const kTeamTrialColumns =
    "robot_rmse_m,robot_entropy_nats,robot_discovery_s,robot_found_share,rmse_m,entropy_nats,"
    "found_share,undiscovered_share,min_separation_m,collisions,separation_violations,fallbacks,"
    "rounds,rounds_late,messages_lost";

std::string scenario_text(const std::string& file) {
  return scenario::read_text_file(trial::config_path(file));
}

scenario::Scenario scenario_of(const TeamTrial& trial, std::uint64_t seed) {
  const std::string text = scenario_text(trial.file);
  const std::size_t robots = trial.robots
                                 ? static_cast<std::size_t>(*trial.robots)
                                 : scenario::parse_scenario(text, trial.file).robots.size();
  return scenario::parse_scenario(
      scenario::apply_overrides(text, overrides_of(trial, robots, seed)),
      trial.file + " with the settings of the experiment");
}

std::string team_trial_row(const TeamTrial& trial, std::uint64_t seed) {
  const scenario::Scenario scenario = scenario_of(trial, seed);
  const logs::TrialSummary s = trial::run_trial(scenario, trial::trial_recipes(scenario)).summary;
  const double targets = s.targets;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return fmt::format(
      "{:.6f},{:.6f},{:.4f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.4f},{},{},{},{},{},{}",
      s.per_robot.rmse_m.value_or(kNone), s.per_robot.entropy_nats, s.per_robot.discovery_time_s,
      s.per_robot.discovered / targets, s.rmse_m.value_or(kNone), s.entropy_nats,
      s.discovered / targets, s.undiscovered_share, s.min_separation_m.value_or(kNone),
      s.collisions, s.separation_violations, s.fallbacks, s.rounds, s.rounds_late, s.messages_lost);
}

}  // namespace vantage::experiments
