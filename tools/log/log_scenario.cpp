#include "tools/log/log_scenario.hpp"

#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

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

scenario::Scenario scenario_of(const logs::IndexedLog& log) {
  const auto notice = find_scenario_notice(log);
  if (!notice) {
    throw StartupError(
        log.path() +
        ": contains no SCENARIO message; this command needs the scenario of the trial");
  }
  return scenario::parse_scenario(notice->yaml, log.path() + " (SCENARIO)");
}

}  // namespace vantage::tools
