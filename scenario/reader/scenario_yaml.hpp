#pragma once

#include <string>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads a scenario file. Keys are the field names of models/scenario, units included.
/// @throws StartupError "file:line: key: what is wrong and what was expected" for an unknown or
///         duplicate key, a wrong type or unit, a value out of range, a missing file.
Scenario load_scenario(const std::string& path);

/// The line, from 1, on which the text of a scenario that was read gives the key at `path`
/// ("targets", "network.url"): of the innermost one that it gives; 0 when it gives none of it.
int line_of_key(const std::string& text, const std::string& path);

/// The same from text; `name` stands for the file in messages.
Scenario parse_scenario(const std::string& yaml, const std::string& name);

}  // namespace vantage::scenario
