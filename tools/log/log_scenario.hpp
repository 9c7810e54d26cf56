#pragma once

#include <optional>

#include "logs/file/log_index.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// The first SCENARIO of the log that can be read; nullopt when there is none.
std::optional<models::ScenarioNotice> find_scenario_notice(const logs::IndexedLog& log);

/// The scenario that the log was flown with. @throws StartupError when the log does not say, or
/// says what this version cannot read.
scenario::Scenario scenario_of(const logs::IndexedLog& log);

}  // namespace vantage::tools
