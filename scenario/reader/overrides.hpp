#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Changes to a scenario file from a command line, a program or a sweep. Empty members change
/// nothing.
struct Overrides {
  std::optional<std::uint64_t> seed;
  std::optional<double> duration_s;
  std::optional<std::string> planner;  ///< planner.algorithm
  std::optional<double> communication_range_m;
  std::optional<std::int64_t> node_budget;
  std::optional<std::string> url;
  /// Other changes: maps a key's full path ("robot_defaults.sensor.range_sigma_m") to its new value
  /// in YAML, a number or a whole list ("0.3", "[{name: Q1}]"). The parent of the key must be a
  /// mapping or absent.
  std::map<std::string, std::string> keys;

  [[nodiscard]] bool is_empty() const;
};

/// Returns the scenario text with the overrides inserted; without overrides the text is unchanged.
/// The SCENARIO message in the log then contains exactly the scenario that is used.
std::string apply_overrides(const std::string& yaml, const Overrides& overrides);

/// Reads a scenario file and applies the overrides; the result's `source_text` includes them.
/// @throws StartupError as scenario::load_scenario
Scenario load_scenario_with(const std::string& path, const Overrides& overrides);

}  // namespace vantage::scenario
