#pragma once

#include <memory>

#include "models/world/grid.hpp"
#include "models/world/world.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// A problem with ownership of the world that it points to, if any. The object can be moved safely,
/// because world and field keep their addresses.
struct OwnedProblem {
  std::unique_ptr<models::World> world;
  std::unique_ptr<models::DistanceField> field;
  SearchProblem problem;
};

}  // namespace vantage::planner
