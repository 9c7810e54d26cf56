#include "scenario/reader/overrides.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

void write(YAML::Node mapping, const std::string& path, const YAML::Node& value) {
  const std::size_t dot = path.find('.');
  if (dot == std::string::npos) {
    mapping[path] = value;
  } else {
    write(mapping[path.substr(0, dot)], path.substr(dot + 1), value);
  }
}

}  // namespace

bool Overrides::is_empty() const {
  return !seed && !duration_s && !planner && !communication_range_m && !node_budget && !url &&
         keys.empty();
}

std::string apply_overrides(const std::string& yaml, const Overrides& overrides) {
  if (overrides.is_empty()) {
    return yaml;
  }
  YAML::Node root = YAML::Load(yaml);
  if (overrides.seed) {
    root["seed"] = *overrides.seed;
  }
  if (overrides.duration_s) {
    root["duration_s"] = fmt::format("{}", *overrides.duration_s);
  }
  if (overrides.planner) {
    root["planner"]["algorithm"] = *overrides.planner;
  }
  if (overrides.node_budget) {
    root["planner"]["node_budget"] = *overrides.node_budget;
  }
  if (overrides.communication_range_m) {
    root["network"]["communication_range_m"] = fmt::format("{}", *overrides.communication_range_m);
  }
  if (overrides.url) {
    root["network"]["url"] = *overrides.url;
  }
  for (const auto& [path, yaml_of_key] : overrides.keys) {
    write(root, path, YAML::Load(yaml_of_key));
  }
  YAML::Emitter out;
  out << root;
  return std::string(out.c_str()) + "\n";
}

Scenario load_scenario_with(const std::string& path, const Overrides& overrides) {
  Scenario scenario = load_scenario(path);
  if (overrides.is_empty()) {
    return scenario;
  }
  return parse_scenario(apply_overrides(scenario.source_text, overrides), path + " with options");
}

}  // namespace vantage::scenario
