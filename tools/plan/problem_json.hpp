#pragma once

#include <string>

#include "planner/problem/owned_problem.hpp"

namespace vantage::tools {

/// A planning problem of a file.
struct PlanningProblem : planner::OwnedProblem {
  std::string name;  ///< "" when the file gives none
};

/// Reads the JSON schema of docs/guide/planning-problems.md: one point robot that may neither leave the
/// map nor touch a box at any time, in metres, seconds and (where a key says so) degrees.
/// `sensor.fov_deg` is the full angle, as in scenario files and SensorModel::fov_rad.
/// @throws StartupError "source:line: path: rule, is what" at the first thing that cannot be true,
/// and "source:line:column: …" for text that is no JSON.
PlanningProblem parse_problem(const std::string& text, const std::string& source);

/// parse_problem() of a file. @throws StartupError also when it cannot be read.
PlanningProblem load_problem(const std::string& path);

}  // namespace vantage::tools
