#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::models {

/// How a rectangle is cut into square cells; row-major from the minimum corner, x fastest.
struct GridGeometry {
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< minimum corner of cell (0, 0)
  double resolution_m = 0.25;
  int columns = 0;
  int rows = 0;

  static GridGeometry covering(const Rectangle& bounds, double resolution_m);
  [[nodiscard]] int size() const { return columns * rows; }
  [[nodiscard]] Eigen::Vector2d centre_m(int index) const;
  /// Index of the cell that holds `p_m`, or −1 outside.
  [[nodiscard]] int index_of(const Eigen::Vector2d& p_m) const;
  /// Its whole cells that reach into the square of half side `half_m` around `around_m`; at least
  /// one, the nearest.
  [[nodiscard]] GridGeometry window(const Eigen::Vector2d& around_m, double half_m) const;
  /// (column, row) here of the other's cell (0, 0), within or not; nullopt when the cells of both
  /// are not the same squares.
  [[nodiscard]] std::optional<Eigen::Vector2i> place_of(const GridGeometry& other) const;
  friend bool operator==(const GridGeometry&, const GridGeometry&) = default;
};

/// Takes the newer of both stamps in every cell that both grids have; none of `theirs` counts as
/// later than `limit_utime`. False, and nothing done, when their cells are not the same squares or
/// the number of stamps is not that of the cells.
bool merge_stamps(const GridGeometry& geometry, std::vector<std::int64_t>& stamps_utime,
                  const GridGeometry& their_geometry, const std::vector<std::int64_t>& theirs_utime,
                  std::int64_t limit_utime);

/// Which cells an obstacle overlaps (1) or not (0); a shared edge is no overlap.
struct OccupancyGrid {
  GridGeometry geometry;
  std::vector<std::uint8_t> occupied;
};
OccupancyGrid rasterise(const World& world, double resolution_m);

/// A lower bound of clearance_m() by one look-up: exact clearance at each cell's centre less half
/// the cell's diagonal. The sphere around a point with this radius is free.
class DistanceField {
 public:
  DistanceField() = default;
  DistanceField(const World& world, double resolution_m);
  /// ≤ clearance_m(world, p_m); −1 outside the bounds.
  [[nodiscard]] double lower_bound_m(const Eigen::Vector2d& p_m) const;
  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }

 private:
  GridGeometry geometry_;
  std::vector<float> distance_m_;
};

/// When each cell was last covered by some field of view. What has not been seen for `memory_s` is
/// unexplored again, since a moving target may have entered it.
class VisibilityGrid {
 public:
  static constexpr std::int64_t kNeverSeen = 0;

  VisibilityGrid() = default;
  /// Cells whose centre lies in an obstacle are never frontiers. `memory_s` ≤ 0: for ever.
  VisibilityGrid(const World& world, double resolution_m, double memory_s);
  /// Of a part of the world.
  VisibilityGrid(const World& world, const GridGeometry& geometry, double memory_s);

  /// Marks every free cell whose centre is in view of `sensor` with line of sight.
  void see(const SensorModel& sensor, const Viewpoint& from, const World& world, Time now);
  /// Takes the newer of both stamps in every cell. Precondition: equal geometry.
  void merge(const VisibilityGrid& other);
  /// The same of stamps of this geometry; none counts as later than `limit_utime`.
  void merge(const std::vector<std::int64_t>& last_seen_utime, std::int64_t limit_utime);
  /// merge_stamps() of another geometry's.
  bool merge(const GridGeometry& geometry, const std::vector<std::int64_t>& last_seen_utime,
             std::int64_t limit_utime) {
    return merge_stamps(geometry_, last_seen_, geometry, last_seen_utime, limit_utime);
  }
  [[nodiscard]] bool is_explored(int index, Time now) const;
  [[nodiscard]] bool is_free(int index) const {
    return free_[static_cast<std::size_t>(index)] != 0;
  }
  /// Share of the free cells that are explored, in [0, 1].
  [[nodiscard]] double explored_share(Time now) const;
  /// Centres of unexplored free cells that have an explored free cell beside them (4 neighbours),
  /// thinned so that no two are nearer than `spacing_m`; in index order, hence deterministic.
  /// While nothing is explored at all: every free cell counts as a frontier.
  [[nodiscard]] std::vector<Eigen::Vector2d> frontiers(Time now, double spacing_m) const;

  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }
  /// utime of the last look at each cell, kNeverSeen for none; for the wire.
  [[nodiscard]] const std::vector<std::int64_t>& last_seen_utime() const { return last_seen_; }
  /// Replaces the stamps (from the wire). Precondition: geometry().size() entries.
  void set_last_seen(std::vector<std::int64_t> last_seen_utime);

 private:
  GridGeometry geometry_;
  double memory_s_ = 0.0;
  std::vector<std::uint8_t> free_;
  std::vector<std::int64_t> last_seen_;
};

}  // namespace vantage::models
