#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "experiments/sweep/sweep.hpp"
#include "scenario/scenario.hpp"

namespace vantage::experiments {

/// Nodes of work a second of ARVI on tracking problems on the reference machine (one core of a
/// 2-core virtual machine, release preset): a slot of T_ARVI / n seconds is as many nodes, so that
/// a trial is the same on every machine.
inline constexpr double kReferenceNodesPerS = 6.0e6;

/// A scenario of config/ and what an experiment changes in it.
struct TeamTrial {
  std::string file;  ///< "field.yaml"
  std::optional<std::string> planner = {};
  std::optional<double> communication_range_m = {};
  double planning_time_s = 0.5;  ///< T_ARVI, of the whole team
  std::optional<double> range_sigma_m = {};
  std::optional<double> bearing_sigma_deg = {};
  std::optional<int> robots = {};  ///< on a circle around the centre, looking outward
  std::optional<int> targets = {};
  std::optional<double> duration_s = {};
};

/// The text of a scenario file that comes with vantage. @throws StartupError when it is not there
std::string scenario_text(const std::string& file);

/// The trial's scenario. @throws StartupError when the file cannot be read or says what cannot be
scenario::Scenario scenario_of(const TeamTrial& trial, std::uint64_t seed);

/// Columns of what team_trial_row() gives: measures of a robot (each by its own belief, mean over
/// the robots), of the team (the best informed robot of each step), and what must not happen.
extern const char* const kTeamTrialColumns;

/// Runs it in virtual time. A pure function of its arguments.
std::string team_trial_row(const TeamTrial& trial, std::uint64_t seed);

}  // namespace vantage::experiments
