#pragma once

#include <vector>

#include "core/deadline.hpp"
#include "models/mapping/cell_counts.hpp"
#include "planner/mapping/mapping_search.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/problem/motion_table.hpp"
#include "planner/problem/problem.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// A plan that gains information about a map.
struct MapPlan {
  /// The cost is the frontier penalty minus the information gain, nats. If the search completed,
  /// the plan is optimal over the controls: bound = cost.
  SearchResult result;
  double gain_nats = 0.0;  ///< gain in addition to the fixed measurements; ≥ 0
};

/// Planner that searches one robot's problem for the plan with the greatest information gain about
/// the map.
///
/// The problem defines the allowed motion: the known world, teammates, and a stop at the end. All
/// robots scan at the same times, once per step_s. The scans at the robot's start and along the
/// teammates' fixed motion are fixed; their information is not counted again.
class MapPlanner {
 public:
  /// @throws UsageError for an invalid scanner.
  explicit MapPlanner(const scenario::Scenario& scenario);

  /// Plans with the look counts `looks`, one per cell of the scenario's map; empty: all cells are
  /// unknown. Jammed teammates give no information but are still obstacles.
  /// @throws UsageError when `looks` has a different number of cells.
  MapPlan plan(const SearchProblem& problem, const models::CellCounts& looks,
               const std::vector<FixedTeammate>& teammates, const Deadline& deadline);

 private:
  models::MappingSpec spec_;
  models::GridGeometry geometry_;
  models::BeamSensor planned_;
  MotionTable motion_;
};

}  // namespace vantage::planner
