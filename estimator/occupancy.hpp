#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/pose.hpp"
#include "models/mapping/beam.hpp"
#include "models/mapping/beam_information.hpp"
#include "models/mapping/looks.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::estimator {

/// What became of the beams of a scan.
struct ScanCounts {
  std::int64_t hits = 0;     ///< ended on something
  std::int64_t misses = 0;   ///< came to their greatest range, or left the grid
  std::int64_t ignored = 0;  ///< not finite, negative beyond noise, too near, or sent from outside
};

/// Fuses scans into an occupancy belief by log-odds.
///
/// A reading z hits the cell that holds the range z + 2 σ: a surface stands at the near side of its
/// cell, and with z itself noise would put half of the hits one cell too near. The cells before it
/// whose middle is nearer than z are missed. A cell is changed once by a scan, and a hit wins over
/// a miss: beams that graze a wall would otherwise wipe it out. The cell of the sensor is missed.
/// Source: log-odds of the inverse sensor model: Moravec and Elfes (1985); once a scan, hits first:
/// Hornung et al., OctoMap (2013), IV-B.
class OccupancyFusion {
 public:
  /// Throws UsageError for a sensor that makes no sense, a hit that does not raise the odds, or a
  /// miss that does not lower them.
  OccupancyFusion(const models::BeamSensor& sensor, const models::InverseBeamModel& inverse);

  /// Changes `belief` by one reading of every beam, taken at `world_from_body`. Precondition:
  /// `ranges_m` has one entry a beam (otherwise all of the scan is ignored and counted).
  ScanCounts fuse(const Pose2& world_from_body, std::span<const double> ranges_m,
                  models::OccupancyBelief& belief);
  /// The same scan as looks, to be added up and merged.
  ScanCounts count(const models::GridGeometry& geometry, const Pose2& world_from_body,
                   std::span<const double> ranges_m, models::Looks& looks);

 private:
  enum class Mark : std::uint8_t { kNone, kMiss, kHit };
  void mark(int cell, Mark as);
  bool mark_beam(const models::GridGeometry& geometry, const Pose2& world_from_body, int beam,
                 double range_m);
  /// Fills touched_ and the marks of the cells in it.
  ScanCounts mark_scan(const models::GridGeometry& geometry, const Pose2& world_from_body,
                       std::span<const double> ranges_m);
  [[nodiscard]] bool is_hit(int cell) const {
    return marks_[static_cast<std::size_t>(cell)] == Mark::kHit;
  }

  models::BeamSensor sensor_;
  models::InverseBeamModel inverse_;
  std::vector<Mark> marks_;   // per cell, of the last scan
  std::vector<int> touched_;  // the cells that are not
};

}  // namespace vantage::estimator
