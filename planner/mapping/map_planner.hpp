#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/deadline.hpp"
#include "models/exchange/messages.hpp"
#include "models/mapping/looks.hpp"
#include "planner/mapping/mapping_search.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/problem/motion_table.hpp"
#include "planner/problem/problem.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Searches one robot's problem for the plan that tells most of the map.
///
/// What is known is the map that the robot's estimator says, all of it unknown while none was
/// heard. Which motion is allowed is the problem's: the world that is known to be there, teammates,
/// and a stop at the end. Every robot scans each step_s of the common time: the looks of the own
/// start and of the teammates' fixed motion over the horizon count as taken, and what they tell is
/// not told again.
class MapPlanner {
 public:
  /// @throws UsageError for a scanner that makes no sense.
  explicit MapPlanner(const scenario::Scenario& scenario);

  /// What the next search works on. Teammates that are jammed see nothing, but are still there.
  void set_up(const SearchProblem& problem, const std::optional<models::RobotMap>& map,
              const std::vector<FixedTeammate>& teammates);

  /// Cost is the negative of what the plan is worth, nats: its information less the pull of the
  /// frontier. A search that comes to its end proves it optimal over the controls: bound = cost.
  /// `problem` is that of set_up().
  SearchResult search(const SearchProblem& problem, const Deadline& deadline);

  /// What the last plan found adds to the looks it was planned against, nats; ≥ 0.
  [[nodiscard]] double gain_nats() const { return gain_nats_; }
  /// Maps of another grid than the scenario's, which nothing was planned on.
  [[nodiscard]] std::int64_t unusable_maps() const { return unusable_maps_; }

 private:
  models::MappingSpec spec_;
  models::GridGeometry geometry_;
  models::Looks looks_;
  models::BeamSensor planned_;
  MotionTable motion_;
  std::vector<MapRoute> fixed_;  ///< scans that are taken anyway
  double gain_nats_ = 0.0;
  std::int64_t unusable_maps_ = 0;
};

}  // namespace vantage::planner
