#pragma once

#include <cstddef>
#include <vector>

#include "models/world/grid.hpp"

namespace vantage::models {

/// Converts between probability and log-odds: p = 1/(1 + e^−l), l = log(p/(1 − p)).
double probability_of(double log_odds);
double log_odds_of(double probability);
/// Returns the entropy −p log p − (1 − p) log(1 − p) in nats; 0 at p = 0 and p = 1.
double binary_entropy_nats(double probability);

/// Belief of a grid whose cells are occupied or free, independently of each other.
///
/// A cell whose log-odds are at the clamp is *settled*: observing it again gives no information,
/// and occupancy() returns 0 or 1. Without settled cells a team keeps observing known areas,
/// because the small remaining uncertainty of every known cell adds up over many beams.
/// Source: dissertation 4 F.2; Moravec and Elfes (1985); the clamp: Hornung et al., OctoMap (2013).
class OccupancyBelief {
 public:
  /// Initialises every cell to probability 1/2. @param clamp_log_odds > 0
  OccupancyBelief(const GridGeometry& geometry, double clamp_log_odds);

  /// Updates the log-odds: l ← clamp(l + Δ). The order of updates does not matter until the clamp
  /// is reached.
  void add_log_odds(int cell, double delta);

  [[nodiscard]] double log_odds(int cell) const { return log_odds_[at(cell)]; }
  /// Returns the probability that `cell` is occupied, in [0, 1]; exactly 0 or 1 if it is settled.
  [[nodiscard]] double occupancy(int cell) const { return occupancy_[at(cell)]; }
  [[nodiscard]] bool is_settled(int cell) const {
    return occupancy(cell) == 0.0 || occupancy(cell) == 1.0;
  }
  /// Returns the entropy of one cell from its log-odds, nats; a settled cell has the entropy of the
  /// clamp.
  [[nodiscard]] double entropy_nats(int cell) const;
  /// Returns the sum of the entropies of all cells, nats. O(cells).
  [[nodiscard]] double entropy_nats() const;
  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }

 private:
  static std::size_t at(int cell) { return static_cast<std::size_t>(cell); }

  GridGeometry geometry_;
  double clamp_log_odds_ = 0.0;
  std::vector<double> log_odds_;
  std::vector<double> occupancy_;
};

}  // namespace vantage::models
