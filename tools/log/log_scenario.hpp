#pragma once

#include <optional>

#include "logs/file/log_index.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Returns the first readable SCENARIO message of the log; nullopt if there is none.
std::optional<models::ScenarioNotice> find_scenario_notice(const logs::IndexedLog& log);

/// Returns the scenario of the log. @throws StartupError if the log has no SCENARIO message, or one
/// that this version cannot read.
scenario::Scenario scenario_of(const logs::IndexedLog& log);

}  // namespace vantage::tools
