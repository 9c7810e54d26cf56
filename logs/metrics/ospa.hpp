#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/assignment.hpp"

namespace vantage::logs {

/// True or estimated position with its label.
struct Labelled {
  std::int64_t label = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
};

/// Error of one set of estimates, compared with the true positions.
struct SetError {
  double ospa_m = 0.0;
  /// Root mean square distance of the pairs in the assignment with the least sum of squared
  /// distances, without a cutoff; 0 without pairs.
  double matched_rmse_m = 0.0;
  int pairs = 0;  ///< number of pairs in the assignment: the size of the smaller set
};

/// Error measures for sets of target estimates with labels that contain no target id. Sets must be
/// judged in the order of time.
///
/// OSPA of order 2 with cutoff c between sets of m ≤ n points: √((Σ min(c, d)² + c² (n − m)) / n),
/// where d are the distances of the best assignment; 0 for two empty sets. A swap is counted if a
/// target is assigned a track closer than c, and the label differs from the label of the target's
/// previous track. Allocates only if a set is larger than all previous sets.
/// Source: Schuhmacher, Vo, Vo, A consistent metric for performance evaluation of multi-object
/// filters (2008); swaps: Bernardin, Stiefelhagen, Evaluating multiple object tracking performance:
/// the CLEAR MOT metrics (2008).
class OspaJudge {
 public:
  explicit OspaJudge(double cutoff_m) : cutoff_m_(cutoff_m) {}

  SetError judge(std::span<const Labelled> truth, std::span<const Labelled> estimates);
  /// Returns the number of swaps since construction, summed over the targets.
  [[nodiscard]] std::int64_t swaps() const { return swaps_; }

 private:
  /// Returns the column assigned to each row. The rows are the points of the smaller set.
  template <class Cost>
  std::span<const int> assign(std::size_t truths, std::size_t estimates, const Cost& cost);

  double cutoff_m_;
  std::int64_t swaps_ = 0;
  std::map<std::int64_t, std::int64_t> tracked_as_;  ///< label of the last track, by target
  std::vector<double> cost_m2_;
  AssignmentSolver solver_;
};

}  // namespace vantage::logs
