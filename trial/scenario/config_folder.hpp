#pragma once

#include <string>
#include <vector>

namespace vantage::trial {

/// Returns the folder of the scenario files of this program: share/vantage/config next to its bin/
/// if installed, otherwise that of its sources. @throws StartupError when there is none.
std::string config_folder();

/// Returns the names of these files without .yaml, sorted.
std::vector<std::string> config_names();

/// Returns the path of the file named `name`, with or without .yaml.
/// @throws StartupError for an unknown name, with a suggestion.
std::string config_path(const std::string& name);

/// Returns the scenario file for a command-line argument: the file `word` if it exists; otherwise,
/// if `word` is not a path, the file of that name in config_folder().
/// @throws StartupError when there is neither, with a suggestion.
std::string scenario_path(const std::string& word);

}  // namespace vantage::trial
