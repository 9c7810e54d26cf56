#include "planner/search/capacity.hpp"

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::planner {

void require_fits(const SearchProblem& problem, const SearchCapacity& capacity) {
  demand(problem.horizon_steps <= capacity.horizon_max,
         "search: horizon_steps must be at most the search capacity");
  demand(problem.targets.size() <= index(capacity.targets_max),
         "search: number of targets must be at most the search capacity");
  demand(problem.teammates.size() <= index(capacity.teammates_max),
         "search: number of teammates must be at most the search capacity");
}

}  // namespace vantage::planner
