#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planner/problem/belief_table.hpp"

namespace vantage::planner {

/// Spatial index of the targets that may be visible near a position at a depth. With this index,
/// the time to evaluate a node is independent of the number of targets elsewhere.
///
/// At each depth only targets that may be in range from a reachable position are relevant. A square
/// grid lists the targets in range of each cell. A cell's list is made at its first query, in
/// O(relevant targets). Lists are complete but may contain targets out of range, so their members
/// must be tested. Allocates nothing after construction; if the pool is full, a query returns all
/// relevant targets of the depth.
class CandidateGrid {
 public:
  CandidateGrid(int targets_max, int horizon_max);

  /// Prepares for nodes within depth · reach_m of `start_m`. `beliefs` must outlive the queries.
  void reset(const BeliefTable& beliefs, const Eigen::Vector2d& start_m, int horizon_steps,
             double reach_m, double range_max_m);

  /// Returns, by ascending index, at least all targets with a mean at depth t that is closer than
  /// range_max_m + reach_m to `p_m`. Precondition: 1 ≤ t ≤ horizon_steps, ‖p_m − start‖ ≤ t ·
  /// reach_m. Valid until the next reset.
  [[nodiscard]] std::span<const std::uint16_t> near(const Eigen::Vector2d& p_m, int t);

 private:
  static constexpr int kSide = 32;  ///< cells along each side of a depth's grid
  struct Cell {
    std::uint32_t begin = 0;
    std::uint16_t count = 0;
    bool is_listed = false;
  };
  [[nodiscard]] std::span<const std::uint16_t> relevant(int t) const;
  /// Fills the list of the cell around `centre_m`; false if the pool is full.
  bool list(const Eigen::Vector2d& centre_m, int t, Cell& cell);

  const BeliefTable* beliefs_ = nullptr;
  Eigen::Vector2d start_m_ = Eigen::Vector2d::Zero();
  double far_m_ = 0.0;  ///< m; range plus one step
  double reach_m_ = 0.0;
  std::vector<double> cell_m_;  ///< per depth
  std::vector<std::uint32_t>
      relevant_begin_;  ///< per depth: start index in relevant_; the last entry is the end
  std::vector<std::uint16_t> relevant_;
  std::vector<Cell> cells_;  ///< indexed by [t − 1][row][column]
  std::vector<std::uint16_t> pool_;
  std::size_t pool_count_ = 0;
};

}  // namespace vantage::planner
