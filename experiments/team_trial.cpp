#include "experiments/team_trial.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "scenario/reader/text_file.hpp"
#include "trial/scenario/config_folder.hpp"
#include "trial/trial.hpp"

namespace vantage::experiments {
namespace {

// Evenly on a circle around the centre, looking outward, at staggered heights.
YAML::Node circle_of_robots(int count) {
  constexpr double kRadius_m = 4.0;
  YAML::Node robots;
  for (int i = 0; i < count; ++i) {
    const double at_rad = 2.0 * kPi * i / count;
    YAML::Node robot;
    robot["name"] = fmt::format("Q{}", i + 1);
    robot["start"]["x_m"] = fmt::format("{:.4f}", kRadius_m * std::cos(at_rad));
    robot["start"]["y_m"] = fmt::format("{:.4f}", kRadius_m * std::sin(at_rad));
    robot["start"]["yaw_deg"] = fmt::format("{:.4f}", std::remainder(360.0 * i / count, 360.0));
    robot["height_m"] = fmt::format("{:.1f}", 2.0 + 0.5 * i);
    robots.push_back(robot);
  }
  return robots;
}

std::string edited(const TeamTrial& trial, std::uint64_t seed) {
  YAML::Node root = YAML::Load(scenario_text(trial.file));
  const auto number = [](double value) { return fmt::format("{}", value); };
  root["seed"] = seed;
  if (trial.robots) {
    root["robots"] = circle_of_robots(*trial.robots);
  }
  if (trial.targets) {
    root["targets"]["count"] = *trial.targets;
  }
  if (trial.duration_s) {
    root["duration_s"] = number(*trial.duration_s);
  }
  if (trial.planner) {
    root["planner"]["algorithm"] = *trial.planner;
  }
  if (trial.communication_range_m) {
    root["network"]["communication_range_m"] = number(*trial.communication_range_m);
  }
  YAML::Node sensor = root["robot_defaults"]["sensor"];
  if (trial.range_sigma_m) {
    sensor["range_sigma_m"] = number(*trial.range_sigma_m);
  }
  if (trial.bearing_sigma_deg) {
    sensor["bearing_sigma_deg"] = number(*trial.bearing_sigma_deg);
  }
  const auto robots = static_cast<double>(root["robots"].size());
  root["planner"]["node_budget"] = static_cast<std::int64_t>(
      std::max(1.0, kReferenceNodesPerS * trial.planning_time_s / robots));
  YAML::Emitter out;
  out << root;
  return std::string(out.c_str()) + "\n";
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
  return scenario::parse_scenario(edited(trial, seed), trial.file + " as the experiment has it");
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
