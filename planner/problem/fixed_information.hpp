#pragma once

#include <cstddef>
#include <vector>

#include "models/plan/plan.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// A teammate with a fixed plan: its trajectory and its sensor.
struct FixedTeammate {
  models::Trajectory trajectory;
  models::SensorModel sensor;
  bool jammed = false;    ///< true: its sensor gives no information; it is still an obstacle
  std::size_t robot = 0;  ///< index among the scenario's robots
};

/// Returns the teammates' sensor information about each target's predicted mean along their fixed
/// trajectories, [target][depth − 1], summed over teammates: the input of coordinate descent. The
/// information is about the state if a teammate measures velocities and the target has a velocity,
/// otherwise about the position. Cost: O(N·M·T). Source: dissertation, section 3.B (sequential
/// greedy).
std::vector<std::vector<models::StateMatrix>> fixed_information(
    const SearchProblem& problem, const std::vector<FixedTeammate>& teammates);

}  // namespace vantage::planner
