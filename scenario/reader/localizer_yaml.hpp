#pragma once

#include <optional>
#include <string>

#include "scenario/localizer_spec.hpp"

namespace vantage::scenario {

/// Returns the section `localizer` of the scenario in the text `yaml`, or nullopt if there is none.
/// `name` is used in error messages. The complete scenario is checked.
/// @throws StartupError as parse_scenario()
std::optional<LocalizerSpec> parse_localizer(const std::string& yaml, const std::string& name);

}  // namespace vantage::scenario
