#pragma once

#include <memory>
#include <string>

#include "models/world/grid.hpp"
#include "models/world/world.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::tools {

/// A planning problem of a file, with the world that it points to. Moving it is safe: the world
/// and the field stay where they are.
struct PlanningProblem {
  std::string name;  ///< "" when the file gives none
  std::unique_ptr<models::World> world;
  std::unique_ptr<models::DistanceField> field;
  planner::SearchProblem problem;
};

/// Reads the JSON schema of docs/planning-problems.md: one point robot that may neither leave the
/// map nor touch a box at any time, in metres, seconds and (where a key says so) degrees.
/// `sensor.fov_deg` is the full angle, as in scenario files and SensorModel::fov_rad.
/// @throws StartupError "source: path: rule, got what" at the first thing that cannot be true, and
/// "source:line:column: …" for text that is no JSON.
PlanningProblem parse_problem(const std::string& text, const std::string& source);

/// parse_problem() of a file. @throws StartupError also when it cannot be read.
PlanningProblem load_problem(const std::string& path);

}  // namespace vantage::tools
