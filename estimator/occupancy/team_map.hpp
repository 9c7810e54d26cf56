#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "estimator/occupancy/occupancy.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Input of one step of a map. Pointers must be valid during the call only.
struct MapInput {
  const models::RobotBelief* belief = nullptr;      ///< this robot's belief; gives time, step, pose
  const models::RobotMap* before = nullptr;         ///< this robot's previous map, or null
  std::span<const models::RangeScan* const> scans;  ///< this robot's scans, not counted yet
  /// Newest map received while in range, one per run of a teammate's estimator.
  std::span<const models::RobotMap* const> teammates;
};

/// Counts of dropped inputs since construction.
struct MapCounters {
  std::int64_t jammed_scans = 0;
  std::int64_t malformed_scans = 0;  ///< scans of another scanner or from outside the grid
  std::int64_t malformed_maps = 0;   ///< maps with a grid that differs from this map's

  [[nodiscard]] std::vector<models::NamedCount> named() const;
};

/// One robot's part of the team's map.
///
/// Each robot counts its own scans per cell, hits minus misses, and publishes all counts. A
/// teammate replaces the previous counts of a robot by the new ones and adds one set of counts per
/// robot. So no scan is counted twice, even if the network repeats, reorders or loses messages. The
/// content of a lost message is contained in the next one. Robots that received the same maps have
/// the same map, bit for bit. A jammed robot's scan is not counted.
///
/// step() is a pure function of its input (except for the counters).
class TeamMap {
 public:
  /// @throws UsageError for a robot that is not in the scenario or an invalid scanner.
  TeamMap(const scenario::Scenario& scenario, const std::string& robot);

  /// Returns the content of MAP_R without run id, sequence number and inputs. Precondition:
  /// `input.belief` is not null.
  models::RobotMap step(const MapInput& input);

  /// True if `theirs` has the grid of this map and can be added; otherwise increments
  /// malformed_maps.
  bool is_of_this_grid(const models::RobotMap& theirs);

  /// True if a robot with belief `own` uses `theirs`: the map has the same grid as this map, is at
  /// most three steps old, and was sent within the communication range.
  [[nodiscard]] bool accepts(const models::RobotBelief& own, const models::RobotMap& theirs) const;

  [[nodiscard]] const MapCounters& counters() const { return counters_; }

 private:
  void count(const models::RangeScan& scan, models::CellCounts& cell_counts);

  std::string robot_;
  models::MappingSpec spec_;
  models::GridGeometry geometry_;
  double communication_range_m_;
  Duration age_max_;
  OccupancyFusion fusion_;
  MapCounters counters_;
};

}  // namespace vantage::estimator
