#pragma once

#include <optional>
#include <string>

#include "scenario/localizer_spec.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Returns the section `localizer` of the scenario in the text `yaml`, or nullopt if there is none.
/// `name` is used in error messages. The complete scenario is checked.
/// @throws StartupError as parse_scenario()
std::optional<LocalizerSpec> parse_localizer(const std::string& yaml, const std::string& name);

/// Returns the section `localizer` of the scenario's text; nullopt if there is none. Few processes
/// need this section, so Scenario does not contain it.
std::optional<LocalizerSpec> localizer_of(const Scenario& scenario);

/// Returns the index of `robot` in the section; −1 if it does not compute its pose.
int index_of(const LocalizerSpec& spec, const std::string& robot);

}  // namespace vantage::scenario
