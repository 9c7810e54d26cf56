#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planner/problem/belief_table.hpp"

namespace vantage::planner {

/// Which targets may be seen from about a place at a depth, so that a node's cost does not depend
/// on how many targets there are elsewhere.
///
/// At each depth only the targets that the start can get near enough to by then matter; among them
/// a square grid lists who is within sight of each cell. A cell is listed when it is first asked
/// for, in O(targets that matter). Lists are complete; their members have to be tested exactly.
/// Allocates nothing after construction: when the pool is full, whole depths are answered.
class CandidateGrid {
 public:
  CandidateGrid(int targets_max, int horizon_max);

  /// For nodes that reach at most depth · reach_m from `start_m`. `beliefs` must outlive queries.
  void reset(const BeliefTable& beliefs, const Eigen::Vector2d& start_m, int horizon_steps,
             double reach_m, double range_max_m);

  /// By ascending index, at least every target whose mean at depth t is nearer than range_max_m +
  /// reach_m to `p_m`. Precondition: 1 ≤ t ≤ horizon_steps, ‖p_m − start‖ ≤ t · reach_m. Good
  /// until the next reset.
  [[nodiscard]] std::span<const std::uint16_t> near(const Eigen::Vector2d& p_m, int t);

 private:
  static constexpr int kSide = 32;  ///< cells along each side of a depth's grid
  struct Cell {
    std::uint32_t begin = 0;
    std::uint16_t count = 0;
    bool is_listed = false;
  };
  [[nodiscard]] std::span<const std::uint16_t> relevant(int t) const;
  /// Lists the cell around `centre_m`, unless the pool is full.
  bool list(const Eigen::Vector2d& centre_m, int t, Cell& cell);

  const BeliefTable* beliefs_ = nullptr;
  Eigen::Vector2d start_m_ = Eigen::Vector2d::Zero();
  double far_m_ = 0.0;  ///< range and one step
  double reach_m_ = 0.0;
  std::vector<double> cell_m_;                 ///< per depth
  std::vector<std::uint32_t> relevant_begin_;  ///< per depth, into relevant_; one more at the end
  std::vector<std::uint16_t> relevant_;
  std::vector<Cell> cells_;  ///< [t − 1][row][column]
  std::vector<std::uint16_t> pool_;
  std::size_t pool_count_ = 0;
};

}  // namespace vantage::planner
