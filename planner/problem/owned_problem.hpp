#pragma once

#include <memory>

#include "models/world/grid.hpp"
#include "models/world/world.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// A problem together with the world that it points to, or without one. Moving it is safe: world
/// and field stay where they are.
struct OwnedProblem {
  std::unique_ptr<models::World> world;
  std::unique_ptr<models::DistanceField> field;
  SearchProblem problem;
};

}  // namespace vantage::planner
