#pragma once

#include <string>

#include "localizer/judge/recording.hpp"
#include "logs/file/log_index.hpp"
#include "logs/mrclam/mrclam.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::tools {

/// Inputs of the localisers of a team, and the robots' true poses if they are known.
struct TeamRecording {
  std::string source;  ///< path of the log or folder
  std::string yaml;    ///< text of the scenario
  scenario::LocalizerSpec spec;
  localizer::Recording recording;  ///< robots in the order of `spec`
};

/// Returns the recording in a folder of the MRCLAM data set, with default sensors and drives.
TeamRecording team_of(const logs::MrclamData& data, const std::string& source);

/// Returns the recording in a log: ODOMETRY_R, SIGHTINGS_R, and the true poses in TRUTH or, without
/// TRUTH, in VICON. @throws StartupError if SCENARIO has no section localizer
TeamRecording team_of(const logs::IndexedLog& log);

/// Reads a log, or a folder of the MRCLAM data set.
/// @throws StartupError if a robot has no odometry
TeamRecording read_team(const std::string& path);

/// Throws StartupError if a robot of `team` has no true pose.
void require_truth(const TeamRecording& team);

/// Replaces sensors, drives and noise of `team` by those in the section localizer of the scenario
/// file `path`. The landmarks and ids remain.
/// @throws StartupError if the section is missing or does not contain all robots
void use_parameters(const std::string& path, TeamRecording& team);

}  // namespace vantage::tools
