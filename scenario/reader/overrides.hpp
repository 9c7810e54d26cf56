#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// What a command line, a program or a sweep changes in a scenario file. Empty members change
/// nothing.
struct Overrides {
  std::optional<std::uint64_t> seed;
  std::optional<double> duration_s;
  std::optional<std::string> planner;  ///< planner.algorithm
  std::optional<double> communication_range_m;
  std::optional<std::int64_t> node_budget;
  std::optional<std::string> url;
  /// What else: by a key's whole path ("robot_defaults.sensor.range_sigma_m") what then stands
  /// there as YAML, a number or a whole list ("0.3", "[{name: Q1}]"). What holds the key must be a
  /// mapping or not be there.
  std::map<std::string, std::string> keys;

  [[nodiscard]] bool is_empty() const;
};

/// The scenario text with the overrides written into it; the text itself when there are none. What
/// runs is always what the log's SCENARIO says, to the last option.
std::string apply_overrides(const std::string& yaml, const Overrides& overrides);

/// Reads a scenario file and applies the overrides; `source_text` is the result's own text.
/// @throws StartupError as scenario::load_scenario
Scenario load_scenario_with(const std::string& path, const Overrides& overrides);

}  // namespace vantage::scenario
