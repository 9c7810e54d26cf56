#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "experiments/sweep/sweep.hpp"
#include "scenario/scenario.hpp"

namespace vantage::experiments {

/// Nodes per second of ARVI on tracking problems on the reference machine (one core of a 2-core
/// virtual machine, release preset). A slot of T_ARVI / n seconds is converted into nodes, so that
/// a trial is the same on every machine.
inline constexpr double kReferenceNodesPerS = 6.0e6;

/// A scenario of config/ and the experiment's changes to it.
struct TeamTrial {
  std::string file;  ///< "field.yaml"
  std::optional<std::string> planner = {};
  std::optional<double> communication_range_m = {};
  double planning_time_s = 0.5;  ///< s; T_ARVI, planning time of the whole team
  std::optional<double> range_sigma_m = {};
  std::optional<double> bearing_sigma_deg = {};
  std::optional<int> robots = {};  ///< number of robots, on a circle, facing outwards
  std::optional<int> targets = {};
  std::optional<double> duration_s = {};
};

/// Returns the text of a scenario file shipped with vantage.
/// @throws StartupError when it does not exist
std::string scenario_text(const std::string& file);

/// Returns the trial's scenario.
/// @throws StartupError when the file cannot be read or its content is invalid
scenario::Scenario scenario_of(const TeamTrial& trial, std::uint64_t seed);

/// Columns of team_trial_row(): measures per robot (each from the robot's own belief, mean over the
/// robots), measures of the team (from the best informed robot of each step), and counters of
/// safety and timing.
extern const char* const kTeamTrialColumns;

/// Runs the trial in virtual time and returns its row. The result depends only on the arguments.
std::string team_trial_row(const TeamTrial& trial, std::uint64_t seed);

}  // namespace vantage::experiments
