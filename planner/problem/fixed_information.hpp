#pragma once

#include <cstddef>
#include <vector>

#include "models/plan/plan.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// A teammate whose plan is fixed: where it will go and what it sees with.
struct FixedTeammate {
  models::Trajectory trajectory;
  models::SensorModel sensor;
  bool jammed = false;    ///< then it sees nothing, but is still there
  std::size_t robot = 0;  ///< which of the scenario's it is
};

/// Coordinate descent's view of the teammates: the sensor information matrices along their fixed
/// trajectories about each target's predicted mean, [target][depth − 1], summed over teammates.
/// O(N·M·T). Source: dissertation 3 B (sequential greedy).
std::vector<std::vector<models::PositionMatrix>> fixed_information(
    const SearchProblem& problem, const std::vector<FixedTeammate>& teammates);

}  // namespace vantage::planner
