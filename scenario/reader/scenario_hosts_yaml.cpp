#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "scenario/reader/scenario_agents_yaml.hpp"
#include "scenario/reader/scenario_sections_yaml.hpp"

namespace vantage::scenario {
namespace {

constexpr std::size_t kHostsMax = 32;

void read_part(const Value& item, const Scenario& scenario, HostSpec& host) {
  const std::string part = item.text();
  constexpr std::array<std::string_view, 3> kParts = {kSimPart, kMocapPart, kLoggerPart};
  if (scenario.find_robot(part) == nullptr &&
      std::find(kParts.begin(), kParts.end(), part) == kParts.end()) {
    item.refuse("must be the name of a robot, sim, vicon or logger; is '" + part + "'");
  }
  const auto runs_it = [&](const HostSpec& other) {
    return std::find(other.runs.begin(), other.runs.end(), part) != other.runs.end();
  };
  const auto runner = std::find_if(scenario.hosts.begin(), scenario.hosts.end(), runs_it);
  if (runner != scenario.hosts.end() || runs_it(host)) {
    item.refuse(fmt::format("'{}' already runs on {}", part,
                            runner != scenario.hosts.end() ? runner->name : host.name));
  }
  host.runs.push_back(part);
}

void read_host(Mapping& from, const Scenario& scenario, HostSpec& host) {
  from.require("name");
  from.text("name", host.name);
  if (!is_channel_suffix(host.name)) {
    from.refuse("name", "must contain only A-Z and 0-9, is '" + host.name + "'");
  }
  const auto has_name = [&](const HostSpec& other) { return other.name == host.name; };
  if (std::any_of(scenario.hosts.begin(), scenario.hosts.end(), has_name)) {
    from.refuse("name", "must be unique; an earlier host is called " + host.name);
  }
  if (const std::optional<Value> runs = from.find_required("runs")) {
    for (const Value& item : runs->items()) {
      read_part(item, scenario, host);
    }
  }
}

}  // namespace

void read_hosts(Mapping& top, Scenario& scenario) {
  const std::optional<Value> list = top.find("hosts");
  if (!list) {
    return;
  }
  const std::vector<Value> items = list->items();
  if (items.empty() || items.size() > kHostsMax) {
    list->refuse(fmt::format("must contain at least 1 and at most {} hosts, contains {}", kHostsMax,
                             items.size()));
  }
  for (const Value& item : items) {
    HostSpec host;
    read_mapping({item}, [&](Mapping& from) { read_host(from, scenario, host); });
    scenario.hosts.push_back(std::move(host));
  }
}

}  // namespace vantage::scenario
