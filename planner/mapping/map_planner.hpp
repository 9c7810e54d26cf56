#pragma once

#include <vector>

#include "core/deadline.hpp"
#include "models/mapping/looks.hpp"
#include "planner/mapping/mapping_search.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/problem/motion_table.hpp"
#include "planner/problem/problem.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// A plan that tells of a map.
struct MapPlan {
  /// Cost is the negative of what the plan is worth, nats: its information less the pull of the
  /// frontier. A search that comes to its end proves it optimal over the controls: bound = cost.
  SearchResult result;
  double gain_nats = 0.0;  ///< what it adds to the looks it was planned against; ≥ 0
};

/// Searches one robot's problem for the plan that tells most of the map.
///
/// Which motion is allowed is the problem's: the world that is known to be there, teammates, and a
/// stop at the end. Every robot scans each step_s of the common time: the looks of the own start
/// and of the teammates' fixed motion over the horizon count as taken, and what they tell is not
/// told again.
class MapPlanner {
 public:
  /// @throws UsageError for a scanner that makes no sense.
  explicit MapPlanner(const scenario::Scenario& scenario);

  /// `looks` are what is known, of each cell of the scenario's map; empty: all of it is unknown.
  /// Teammates that are jammed see nothing, but are still there.
  /// @throws UsageError for looks of another number of cells.
  MapPlan plan(const SearchProblem& problem, const models::Looks& looks,
               const std::vector<FixedTeammate>& teammates, const Deadline& deadline);

 private:
  models::MappingSpec spec_;
  models::GridGeometry geometry_;
  models::BeamSensor planned_;
  MotionTable motion_;
};

}  // namespace vantage::planner
