#pragma once

#include <string>
#include <vector>

namespace vantage::trial {

/// The folder of the scenario files that came with this program: share/vantage/config beside its
/// bin/ where it was installed, else that of its sources. @throws StartupError when there is none.
std::string config_folder();

/// Their names, without .yaml, in order.
std::vector<std::string> config_names();

/// The file of the one called `name`, with or without .yaml.
/// @throws StartupError for an unknown one, with what may have been meant.
std::string config_path(const std::string& name);

/// The file that a person means by `word`: that file; where there is none and `word` is no path,
/// the scenario of that name that came with this program.
/// @throws StartupError when there is neither, with the name that may have been meant.
std::string scenario_path(const std::string& word);

}  // namespace vantage::trial
