#pragma once

#include <string>
#include <vector>

namespace vantage::trial {

/// Returns this program's folder of scenario files: share/vantage/config next to bin/ if the
/// program is installed, otherwise the folder in the source tree. @throws StartupError when neither
/// folder exists.
std::string config_folder();

/// Returns the names of the scenario files in config_folder(), without .yaml, sorted.
std::vector<std::string> config_names();

/// Returns the path of the scenario file `name` (with or without .yaml) in config_folder().
/// @throws StartupError for an unknown name, with a suggestion.
std::string config_path(const std::string& name);

/// Returns the scenario file for a command-line argument: the file `word` if it exists; otherwise,
/// if `word` is not a path, the file with this name in config_folder().
/// @throws StartupError when neither exists, with a suggestion.
std::string scenario_path(const std::string& word);

}  // namespace vantage::trial
