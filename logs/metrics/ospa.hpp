#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/assignment.hpp"

namespace vantage::logs {

/// Who is where, or is said to be.
struct Labelled {
  std::int64_t label = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
};

/// What one set of estimates is worth against the truth.
struct SetError {
  double ospa_m = 0.0;
  /// Root mean square distance of the pairs of the assignment of least squared distance, without a
  /// cutoff; 0 where nothing is paired.
  double matched_rmse_m = 0.0;
  int pairs = 0;  ///< of that assignment: the smaller of the two numbers
};

/// Judges estimates of several targets whose names mean nothing, instant by instant.
///
/// OSPA of order 2 with cutoff c between sets of m ≤ n points: √((Σ min(c, d)² + c² (n − m)) / n),
/// d the distances of the best assignment; 0 of two empty sets. A swap is a target that the same
/// assignment gives to a track, nearer than c, of another label than that it last had.
/// Allocates only for more points than any set before.
/// Source: Schuhmacher, Vo, Vo, A consistent metric for performance evaluation of multi-object
/// filters (2008); swaps: Bernardin, Stiefelhagen, Evaluating multiple object tracking performance:
/// the CLEAR MOT metrics (2008).
class OspaJudge {
 public:
  explicit OspaJudge(double cutoff_m) : cutoff_m_(cutoff_m) {}

  SetError judge(std::span<const Labelled> truth, std::span<const Labelled> estimates);
  /// Since construction, all targets together.
  [[nodiscard]] std::int64_t swaps() const { return swaps_; }

 private:
  /// Column of each row, the smaller set's points being the rows.
  template <class Cost>
  std::span<const int> assign(std::size_t truths, std::size_t estimates, const Cost& cost);

  double cutoff_m_;
  std::int64_t swaps_ = 0;
  std::map<std::int64_t, std::int64_t> tracked_as_;  ///< label of the track, by target
  std::vector<double> cost_m2_;
  AssignmentSolver solver_;
};

}  // namespace vantage::logs
