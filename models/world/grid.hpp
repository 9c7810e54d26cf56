#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/index.hpp"
#include "core/time.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::models {

/// A rectangle divided into square cells; row-major from the minimum corner, x fastest.
struct GridGeometry {
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< minimum corner of cell (0, 0)
  double resolution_m = 0.25;
  int columns = 0;
  int rows = 0;

  static GridGeometry covering(const Rectangle& bounds, double resolution_m);
  [[nodiscard]] int size() const { return columns * rows; }
  [[nodiscard]] Eigen::Vector2d centre_m(int cell) const;
  /// Returns the index of the cell that contains `p_m`, or −1 outside.
  [[nodiscard]] int index_of(const Eigen::Vector2d& p_m) const;
  /// Returns the sub-grid of the cells that overlap the square of half side `half_m` around
  /// `around_m`; at least the cell nearest to `around_m`.
  [[nodiscard]] GridGeometry window(const Eigen::Vector2d& around_m, double half_m) const;
  /// Returns the column and row in this grid of the other grid's cell (0, 0), which may be outside
  /// this grid; nullopt if the cells of the two grids do not coincide.
  [[nodiscard]] std::optional<Eigen::Vector2i> cell_offset_of(const GridGeometry& other) const;
  friend bool operator==(const GridGeometry&, const GridGeometry&) = default;
};

/// Stores the newer of the two stamps in each cell that both grids have. Stamps in `theirs` are
/// limited to `limit_utime`. Returns false without any change if the cells do not coincide, or if
/// the number of stamps of a grid differs from its number of cells.
bool merge_stamps(const GridGeometry& geometry, std::vector<std::int64_t>& stamps_utime,
                  const GridGeometry& their_geometry, const std::vector<std::int64_t>& theirs_utime,
                  std::int64_t limit_utime);

/// Cells that an obstacle overlaps (1) or not (0); a shared edge does not count.
struct OccupancyGrid {
  GridGeometry geometry;
  std::vector<std::uint8_t> occupied;
};
OccupancyGrid rasterise(const World& world, double resolution_m);

/// Table of lower bounds of clearance_m(): per cell the exact clearance at the centre minus half
/// the cell's diagonal. A disc of this radius around any point of the cell is free of obstacles.
class DistanceField {
 public:
  DistanceField() = default;
  DistanceField(const World& world, double resolution_m);
  /// Returns a value ≤ clearance_m(world, p_m); −1 outside the bounds.
  [[nodiscard]] double lower_bound_m(const Eigen::Vector2d& p_m) const;
  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }

 private:
  GridGeometry geometry_;
  std::vector<float> distance_m_;
};

/// The time at which each cell was last in a field of view. A cell that was not seen for `memory_s`
/// is unexplored again, because a moving target may have entered it.
class VisibilityGrid {
 public:
  static constexpr std::int64_t kNeverSeen = 0;

  VisibilityGrid() = default;
  /// Cells with a centre inside an obstacle are never frontiers. `memory_s` ≤ 0: cells stay
  /// explored.
  VisibilityGrid(const World& world, double resolution_m, double memory_s);
  /// Creates a grid of `geometry`, which is a part of the world.
  VisibilityGrid(const World& world, const GridGeometry& geometry, double memory_s);

  /// Stamps every free cell with a centre in view of `sensor` and in line of sight.
  void see(const SensorModel& sensor, const Viewpoint& from, const World& world, Time now);
  /// Stores the newer of the two stamps in every cell. Precondition: equal geometry.
  void merge(const VisibilityGrid& other);
  /// As merge(other), for stamps of this geometry; stamps are limited to `limit_utime`.
  void merge(const std::vector<std::int64_t>& last_seen_utime, std::int64_t limit_utime);
  /// As merge(other), for stamps of another geometry; see merge_stamps().
  bool merge(const GridGeometry& geometry, const std::vector<std::int64_t>& last_seen_utime,
             std::int64_t limit_utime) {
    return merge_stamps(geometry_, last_seen_, geometry, last_seen_utime, limit_utime);
  }
  [[nodiscard]] bool is_explored(int cell, Time now) const;
  /// Returns the time since the free cell was seen as a share of the memory, in [0, 1]; 1 if never
  /// seen. This is the probability that the cell contains an undiscovered target, divided by the
  /// same probability for a cell that was never seen.
  [[nodiscard]] double unexplored_share(int cell, Time now) const;
  [[nodiscard]] bool is_free(int cell) const { return free_[index(cell)] != 0; }
  /// Returns the centres of unexplored free cells next to an explored free cell (4 neighbours).
  /// Centres are considered in index order; a centre nearer than `spacing_m` to a selected centre
  /// is skipped. While no cell is explored, every free cell counts as a frontier.
  [[nodiscard]] std::vector<Eigen::Vector2d> frontiers(Time now, double spacing_m) const;

  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }
  /// Returns the utime at which each cell was last seen, or kNeverSeen; messages use this format.
  [[nodiscard]] const std::vector<std::int64_t>& last_seen_utime() const { return last_seen_; }
  /// Replaces the stamps by the stamps of a message. Precondition: geometry().size() entries.
  void set_last_seen(std::vector<std::int64_t> last_seen_utime);

 private:
  GridGeometry geometry_;
  double memory_s_ = 0.0;
  std::vector<std::uint8_t> free_;
  std::vector<std::int64_t> last_seen_;
};

}  // namespace vantage::models
