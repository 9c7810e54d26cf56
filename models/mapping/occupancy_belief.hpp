#pragma once

#include <cstddef>
#include <vector>

#include "core/index.hpp"
#include "models/world/grid.hpp"

namespace vantage::models {

/// Convert between probability and log-odds: p = 1/(1 + e^−l), l = log(p/(1 − p)).
double probability_of(double log_odds);
double log_odds_of(double probability);
/// Returns −p log p − (1 − p) log(1 − p), nats; 0 at 0 and at 1.
double binary_entropy_nats(double probability);

/// Belief about a grid of cells, each occupied or free independently of the others.
///
/// A cell with log-odds at the clamp is *settled*: more scans give no information, and occupancy()
/// returns 0 or 1. Without this rule, robots would keep scanning known cells, because the small
/// remaining entropies of many cells add up along many beams.
/// Source: dissertation, section 4.F.2; Moravec and Elfes (1985). Source of the clamp: Hornung et
/// al., OctoMap (2013).
class OccupancyBelief {
 public:
  /// Sets every cell to probability 1/2. @param clamp_log_odds > 0
  OccupancyBelief(const GridGeometry& geometry, double clamp_log_odds);

  /// Adds `delta` to the log-odds of `cell` and clamps them. The order of calls does not matter
  /// until the clamp is reached.
  void add_log_odds(int cell, double delta);

  [[nodiscard]] double log_odds(int cell) const { return log_odds_[index(cell)]; }
  /// Returns the probability that `cell` is occupied, in [0, 1]; exactly 0 or 1 when it is settled.
  [[nodiscard]] double occupancy(int cell) const { return occupancy_[index(cell)]; }
  /// Returns the entropy of one cell from its log-odds, nats; a settled cell has the entropy of the
  /// clamp value.
  [[nodiscard]] double entropy_nats(int cell) const;
  /// Returns the sum of the cells' entropies, nats. O(cells).
  [[nodiscard]] double entropy_nats() const;
  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }

 private:
  GridGeometry geometry_;
  double clamp_log_odds_ = 0.0;
  std::vector<double> log_odds_;
  std::vector<double> occupancy_;
};

}  // namespace vantage::models
