#pragma once

#include <string>
#include <vector>

#include "scenario/reader/key_table.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads a scenario file. Keys are the field names of scenario/scenario.hpp, units included.
/// @throws StartupError "file:line: key: what is wrong and what was expected" for an unknown or
///         duplicate key, a wrong type or unit, a value out of range, a missing file.
Scenario load_scenario(const std::string& path);

/// Returns the line, from 1, of the key at `path` ("targets", "network.url") in a valid scenario
/// text. If the text has only a part of the path, returns the line of the innermost key present; 0
/// if it has none.
int line_of_key(const std::string& text, const std::string& path);

/// Reads a scenario from text; `name` stands for the file in messages.
Scenario parse_scenario(const std::string& yaml, const std::string& name);

/// Returns the rules of all keys that the reader of the scenario file at `path` asks for. Keys of
/// a section or list that the file does not have are missing. `robot_defaults` is merged into
/// `robots[]`, which takes the same keys.
/// @throws StartupError as load_scenario()
std::vector<KeyRule> keys_of_scenario(const std::string& path);

}  // namespace vantage::scenario
