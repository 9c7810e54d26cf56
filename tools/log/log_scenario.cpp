#include "tools/log/log_scenario.hpp"

#include "bus/channels.hpp"
#include "bus/convert.hpp"
#include "bus/scenario_yaml.hpp"
#include "bus/wire_walk.hpp"
#include "core/check.hpp"

namespace vantage::tools {

std::optional<models::ScenarioNotice> find_scenario_notice(const logs::IndexedLog& log) {
  if (!log.survey().channels.contains(bus::kScenario.name)) {
    return std::nullopt;
  }
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    if (event->channel != bus::kScenario.name) {
      continue;
    }
    if (const auto wire = bus::decode_wire<vantage_lcm::scenario_t>(event->data)) {
      if (auto notice = bus::from_wire(*wire)) {
        return notice;
      }
    }
  }
  return std::nullopt;
}

models::Scenario scenario_of(const logs::IndexedLog& log) {
  const auto notice = find_scenario_notice(log);
  if (!notice) {
    throw StartupError(log.path() + ": no SCENARIO in it that says what was flown");
  }
  return bus::parse_scenario(notice->yaml, log.path() + " (SCENARIO)");
}

}  // namespace vantage::tools
