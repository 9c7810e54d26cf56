#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Returns the reason why no target can be found although the scenario has targets; nullopt if a
/// target can be found. In a plane, any sensor can find a target. In space, a robot needs a sensor
/// whose measurement determines a position.
std::optional<std::string> discovery_obstacle(const scenario::Scenario& scenario);

/// Returns notes about valid settings with which a trial cannot fulfil its purpose: settings that
/// prevent discovery, tracking, motion or agreement, and settings without effect. Each note names
/// the key, its value, the consequence and a remedy.
std::vector<std::string> purpose_notes(const scenario::Scenario& scenario);

}  // namespace vantage::tools
