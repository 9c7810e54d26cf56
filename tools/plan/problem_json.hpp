#pragma once

#include <string>

#include "planner/problem/owned_problem.hpp"

namespace vantage::tools {

/// Planning problem read from a file.
struct PlanningProblem : planner::OwnedProblem {
  std::string name;  ///< empty if the file has none
};

/// Reads the JSON schema of docs/guide/planning-problems.md: one point robot that must stay inside
/// the map and outside the boxes at all times. Units are metres, seconds and, in keys that end in
/// `_deg`, degrees. `sensor.fov_deg` is the full angle, as in scenario files and
/// SensorModel::fov_rad.
/// @throws StartupError "source:line: path: rule, is value" for the first invalid value, and
/// "source:line:column: …" for invalid JSON.
PlanningProblem parse_problem(const std::string& text, const std::string& source);

/// Reads a file by parse_problem(). @throws StartupError also if the file cannot be read.
PlanningProblem load_problem(const std::string& path);

}  // namespace vantage::tools
