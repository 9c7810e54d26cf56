#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "estimator/occupancy.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Input of one step of a map. Pointers must be valid during the call only.
struct MapInput {
  const models::RobotBelief* belief = nullptr;  ///< own, of this step; gives instant, step and pose
  const models::RobotMap* before = nullptr;     ///< own, of the previous step; null in the first
  std::span<const models::RangeScan* const> scans;  ///< own, not counted yet
  /// Newest map of each teammate's run received so far while in range.
  std::span<const models::RobotMap* const> teammates;
};

/// Counts of dropped inputs since construction.
struct MapCounters {
  std::int64_t jammed_scans = 0;
  std::int64_t malformed_scans = 0;  ///< not from the scenario's scanner, or from outside the grid
  std::int64_t malformed_maps = 0;   ///< their grid differs

  [[nodiscard]] std::vector<models::NamedCount> named() const;
};

/// One robot's part of the team's map.
///
/// Each robot counts its own scans per cell, hits minus misses, and publishes all counts. A
/// teammate replaces the previous counts of a robot by the new ones and adds one set of counts per
/// robot. So nothing is counted twice whatever the network repeats, reorders or loses. What was
/// lost arrives with the next message. Robots that received the same maps have the same map, bit by
/// bit. A jammed robot's scan is not counted.
///
/// step() is a pure function of its input (except for the counters).
class TeamMap {
 public:
  /// @throws UsageError for a robot that is not in the scenario or an invalid scanner.
  TeamMap(const scenario::Scenario& scenario, const std::string& robot);

  /// Returns the content of MAP_R without run id, sequence and inputs.
  /// Precondition: a belief.
  models::RobotMap step(const MapInput& input);

  /// True if `theirs` has the grid of this map and can be added; counted otherwise.
  bool is_of_this_grid(const models::RobotMap& theirs);

  /// True if a robot with belief `own` uses `theirs`: it has this grid, is at most three steps old,
  /// and was sent within the communication range.
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
