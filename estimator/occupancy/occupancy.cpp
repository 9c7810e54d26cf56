#include "estimator/occupancy/occupancy.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "models/mapping/ray_walk.hpp"

namespace vantage::estimator {

OccupancyFusion::OccupancyFusion(const models::BeamSensor& sensor,
                                 const models::InverseBeamModel& inverse)
    : sensor_(sensor), inverse_(inverse) {
  models::require_valid(sensor);
  require(inverse.hit_log_odds > 0.0, "a hit must raise the log-odds");
  require(inverse.miss_log_odds < 0.0, "a miss must lower the log-odds");
}

void OccupancyFusion::mark(int cell, Mark as) {
  Mark& mark = marks_[static_cast<std::size_t>(cell)];
  if (mark == Mark::kNone) {
    touched_.push_back(cell);
  }
  mark = std::max(mark, as);
}

// Marks the cells of one beam. Returns true if the beam hit a surface within the grid.
bool OccupancyFusion::mark_beam(const models::GridGeometry& geometry, const Pose2& world_from_body,
                                int beam, double range_m) {
  const bool may_hit = range_m < sensor_.no_hit_range_m();
  const double bearing_rad = world_from_body.yaw_rad + sensor_.bearing_rad(beam);
  models::RayWalk walk(geometry, world_from_body.position_m(), bearing_rad, sensor_.range_max_m);
  while (walk.next()) {
    if (may_hit && walk.exit_m() > range_m + 2.0 * sensor_.sigma_m) {
      if (walk.enter_m() > 0.0) {
        mark(walk.cell(), Mark::kHit);
      }  // otherwise the surface is in the vehicle's own cell
      return true;
    }
    if (walk.enter_m() == 0.0 || 0.5 * (walk.enter_m() + walk.exit_m()) < range_m) {
      mark(walk.cell(), Mark::kMiss);
    }
  }
  return false;
}

ScanCounts OccupancyFusion::mark_scan(const models::GridGeometry& geometry,
                                      const Pose2& world_from_body,
                                      std::span<const double> ranges_m) {
  ScanCounts counts;
  touched_.clear();
  if (ranges_m.size() != static_cast<std::size_t>(sensor_.beams) ||
      geometry.index_of(world_from_body.position_m()) < 0 ||
      !std::isfinite(world_from_body.yaw_rad)) {
    counts.ignored = static_cast<std::int64_t>(ranges_m.size());
    return counts;
  }
  marks_.assign(static_cast<std::size_t>(geometry.size()), Mark::kNone);
  const double least_m = sensor_.range_min_m > 0.0 ? sensor_.range_min_m - 3.0 * sensor_.sigma_m
                                                   : -3.0 * sensor_.sigma_m;
  for (int beam = 0; beam < sensor_.beams; ++beam) {
    const double range_m = ranges_m[static_cast<std::size_t>(beam)];
    if (!std::isfinite(range_m) || range_m < least_m) {
      ++counts.ignored;
    } else if (mark_beam(geometry, world_from_body, beam, range_m)) {
      ++counts.hits;
    } else {
      ++counts.misses;
    }
  }
  return counts;
}

ScanCounts OccupancyFusion::fuse(const Pose2& world_from_body, std::span<const double> ranges_m,
                                 models::OccupancyBelief& belief) {
  const ScanCounts counts = mark_scan(belief.geometry(), world_from_body, ranges_m);
  for (const int cell : touched_) {
    belief.add_log_odds(cell, is_hit(cell) ? inverse_.hit_log_odds : inverse_.miss_log_odds);
  }
  return counts;
}

ScanCounts OccupancyFusion::count(const models::GridGeometry& geometry,
                                  const Pose2& world_from_body, std::span<const double> ranges_m,
                                  models::CellCounts& cell_counts) {
  const ScanCounts counts = mark_scan(geometry, world_from_body, ranges_m);
  for (const int cell : touched_) {
    models::count_scan(cell_counts, cell, is_hit(cell));
  }
  return counts;
}

}  // namespace vantage::estimator
