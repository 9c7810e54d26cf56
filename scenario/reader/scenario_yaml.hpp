#pragma once

#include <string>
#include <vector>

#include "scenario/reader/key_table.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads a scenario file. Keys are the field names of scenario/scenario.hpp, including units.
/// @throws StartupError "file:line: key: what is wrong and what was expected" for an unknown or
///         duplicate key, a wrong type or unit, a value out of range, a missing file.
Scenario load_scenario(const std::string& path);

/// Returns the line, from 1, of the key at `path` ("targets", "network.url") in a valid scenario
/// text. If the text contains only the first keys of the path, returns the line of the last of
/// these keys. Returns 0 if the text contains no key of the path.
int line_of_key(const std::string& text, const std::string& path);

/// Reads a scenario from text. `name` is used as the file name in error messages.
Scenario parse_scenario(const std::string& yaml, const std::string& name);

/// Returns the rules of all keys that are read for the scenario file at `path`. Keys of absent
/// sections and lists are omitted. `robot_defaults` is merged into `robots[]`, which has the same
/// keys.
/// @throws StartupError as load_scenario()
std::vector<KeyRule> keys_of_scenario(const std::string& path);

}  // namespace vantage::scenario
