#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/pose.hpp"
#include "models/mapping/beam.hpp"
#include "models/mapping/beam_information.hpp"
#include "models/mapping/cell_counts.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::estimator {

/// Numbers of beams by result.
struct ScanCounts {
  std::int64_t hits = 0;    ///< hit a surface
  std::int64_t misses = 0;  ///< reached the maximum range, or left the grid
  /// Range is not finite or is too short even with noise, or the whole scan is invalid (pose
  /// outside the grid, wrong number of ranges).
  std::int64_t ignored = 0;
};

/// Fusion of range scans into an occupancy belief by log-odds.
///
/// A range z marks the cell at range z + 2 σ along the beam as hit. If z itself were used, noise
/// would move half of the hits one cell too near, because a surface is at the near side of its
/// cell. The cells between the sensor and the hit cell are marked as missed if their centres are
/// nearer than z. The sensor's own cell is marked as missed. A scan changes a cell only once, and a
/// hit overrides a miss; otherwise beams almost parallel to a wall would erase the wall.
/// Source: log-odds of the inverse sensor model: Moravec and Elfes (1985); one change per cell and
/// scan, hits before misses: Hornung et al., OctoMap (2013), IV-B.
class OccupancyFusion {
 public:
  /// @throws UsageError for an invalid sensor, a hit that does not raise the odds, or a miss that
  /// does not lower them.
  OccupancyFusion(const models::BeamSensor& sensor, const models::InverseBeamModel& inverse);

  /// Updates `belief` with one range per beam, measured at pose `world_from_body`.
  /// Precondition: `ranges_m` has one entry per beam (otherwise the whole scan is ignored and
  /// counted).
  ScanCounts fuse(const Pose2& world_from_body, std::span<const double> ranges_m,
                  models::OccupancyBelief& belief);
  /// Like fuse(), but adds the scan to `cell_counts` (per cell, hits minus misses), which can be
  /// summed over robots.
  ScanCounts count(const models::GridGeometry& geometry, const Pose2& world_from_body,
                   std::span<const double> ranges_m, models::CellCounts& cell_counts);

 private:
  enum class Mark : std::uint8_t { kNone, kMiss, kHit };
  void mark(int cell, Mark as);
  bool mark_beam(const models::GridGeometry& geometry, const Pose2& world_from_body, int beam,
                 double range_m);
  /// Fills touched_ and sets the marks of the touched cells.
  ScanCounts mark_scan(const models::GridGeometry& geometry, const Pose2& world_from_body,
                       std::span<const double> ranges_m);
  [[nodiscard]] bool is_hit(int cell) const {
    return marks_[static_cast<std::size_t>(cell)] == Mark::kHit;
  }

  models::BeamSensor sensor_;
  models::InverseBeamModel inverse_;
  std::vector<Mark> marks_;   // mark that the last scan gave to each cell
  std::vector<int> touched_;  // cells with a mark other than kNone
};

}  // namespace vantage::estimator
