#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "estimator/occupancy.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// What one step of a map is made from. Pointers must be valid during the call only.
struct MapInput {
  const models::RobotBelief* belief = nullptr;  ///< own, of this step: its instant, step and pose
  const models::RobotMap* before = nullptr;     ///< own, of the step before; null: the first
  std::span<const models::RangeScan* const> scans;  ///< own, not counted yet
  /// Of each teammate's run the newest that was ever heard in range.
  std::span<const models::RobotMap* const> teammates;
};

/// What was left out, since construction.
struct MapCounters {
  std::int64_t jammed_scans = 0;
  std::int64_t malformed_scans = 0;  ///< not of the scenario's scanner, or from outside the grid
  std::int64_t malformed_maps = 0;   ///< of another grid

  [[nodiscard]] std::vector<models::NamedCount> named() const;
};

/// One robot's share of the team's map.
///
/// Each robot counts the looks of its own scans and publishes the counts whole; a teammate replaces
/// what it heard before by what it hears now and adds up one count of each. So nothing is counted
/// twice whatever the network repeats, reorders or loses, what was missed comes with the next
/// message, and robots that have heard the same know the same map, bit by bit. A jammed robot's
/// scan tells nothing and is not counted.
///
/// step() is a pure function of its input (but for the counters).
class TeamMap {
 public:
  /// @throws UsageError for a robot that is not in the scenario or a scanner that makes no sense.
  TeamMap(const scenario::Scenario& scenario, const std::string& robot);

  /// Content of MAP_R; run id, sequence and inputs are the caller's. Precondition: a belief.
  models::RobotMap step(const MapInput& input);

  /// Whether `theirs` can be added up with this map; counted when not.
  bool is_of_this_grid(const models::RobotMap& theirs);

  /// Whether a robot that knows `own` takes up `theirs`: of this grid, no older than three steps,
  /// and sent from within the communication range.
  [[nodiscard]] bool hears(const models::RobotBelief& own, const models::RobotMap& theirs) const;

  [[nodiscard]] const MapCounters& counters() const { return counters_; }

 private:
  void count(const models::RangeScan& scan, models::Looks& looks);

  std::string robot_;
  models::MappingSpec spec_;
  models::GridGeometry geometry_;
  double communication_range_m_;
  Duration age_max_;
  OccupancyFusion fusion_;
  MapCounters counters_;
};

}  // namespace vantage::estimator
