#pragma once

#include <cstdint>

#include "core/pose.hpp"
#include "core/reserved_array.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Metric of δ-crossing on SE(2): d(a, b) = hypot(‖p_a − p_b‖, w · |Δyaw|).
struct PoseMetric {
  double yaw_weight_m_per_rad = 0.0;
  [[nodiscard]] double squared(const Pose2& a, const Pose2& b) const {
    const double dx = a.x_m - b.x_m;
    const double dy = a.y_m - b.y_m;
    double turn = a.yaw_rad - b.yaw_rad;  // both yaws are in (−π, π]
    turn = turn > kPi ? turn - 2.0 * kPi : turn <= -kPi ? turn + 2.0 * kPi : turn;
    turn *= yaw_weight_m_per_rad;
    return dx * dx + dy * dy + turn * turn;
  }
  /// True if d(a, b) ≤ δ. At δ = 0 the poses must be equal, including the heading. Without this
  /// rule, two headings at the same position would cross if w² is 0 in double precision, although
  /// their sensors see different targets.
  [[nodiscard]] bool crosses(const Pose2& a, const Pose2& b, double delta_m) const {
    return delta_m > 0.0 ? squared(a, b) <= delta_m * delta_m : a == b;
  }
};

/// Spatial hash of the opened nodes of one depth: finds the nodes within δ of a pose without
/// testing all nodes. reset() and insertion are O(1); a query visits nine cells. Allocates nothing
/// after construction.
class CrossingIndex {
 public:
  explicit CrossingIndex(std::size_t entries_max);

  /// See Tree::prefault().
  void prefault();

  /// Empties the index and prepares for crossings at `delta_m` ≥ 0 (0: equal positions).
  void reset(double delta_m);
  /// Inserts a node; false if the index is full.
  bool insert(const Pose2& pose, NodeId id);
  [[nodiscard]] std::size_t size() const { return count_ - 1; }
  [[nodiscard]] static std::size_t bytes_per_entry() { return sizeof(Entry); }
  /// Calls `visit(id)` for the inserted nodes in the cells around `pose` until `visit` returns
  /// false.
  template <class Visit>
  void near(const Pose2& pose, Visit&& visit) const;

 private:
  struct Entry {
    NodeId id = kNoNode;
    std::uint32_t next = 0;  ///< 0: end
    std::int32_t cell_x = 0;
    std::int32_t cell_y = 0;
  };
  [[nodiscard]] std::int32_t cell_of(double coordinate_m) const;
  [[nodiscard]] std::size_t bucket(std::int32_t x, std::int32_t y) const;

  double cell_m_ = 1.0;
  std::uint32_t epoch_ = 0;
  ReservedArray<std::uint32_t> heads_;  ///< index into entries_; valid only if epochs_ matches
  ReservedArray<std::uint32_t> epochs_;
  ReservedArray<Entry> entries_;
  std::size_t count_ = 1;
};

template <class Visit>
void CrossingIndex::near(const Pose2& pose, Visit&& visit) const {
  const std::int32_t cx = cell_of(pose.x_m);
  const std::int32_t cy = cell_of(pose.y_m);
  for (std::int32_t y = cy - 1; y <= cy + 1; ++y) {
    for (std::int32_t x = cx - 1; x <= cx + 1; ++x) {
      const std::size_t b = bucket(x, y);
      if (epochs_[b] != epoch_) {
        continue;
      }
      for (std::uint32_t e = heads_[b]; e != 0; e = entries_[e].next) {
        if (entries_[e].cell_x == x && entries_[e].cell_y == y && !visit(entries_[e].id)) {
          return;
        }
      }
    }
  }
}

}  // namespace vantage::planner
