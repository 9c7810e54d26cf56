#pragma once

#include <memory>

#include "models/world/grid.hpp"
#include "models/world/world.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// A problem and the world that it points to, if any. Can be moved safely: world and field keep
/// their addresses.
struct OwnedProblem {
  std::unique_ptr<models::World> world;
  std::unique_ptr<models::DistanceField> field;
  SearchProblem problem;
};

}  // namespace vantage::planner
