#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/assignment.hpp"

namespace vantage::estimator {

/// Joint association probabilities of tracks and detections. Each track causes at most one
/// detection, and each detection belongs to at most one track.
///
/// An association a assigns detection a_i to track i, or none (a_i = 0). Its probability is ∝ Π_i
/// w_{i a_i} over all a that use each detection at most once. The class computes the marginals β_ij
/// = P(a_i = j), with Σ_j β_ij + β_i0 = 1 and Σ_i β_ij ≤ 1, and the most likely a. The constructor
/// reserves all storage; nothing is allocated later.
/// Source: Bar-Shalom, Fortmann, Scheffe, Joint probabilistic data association for multiple targets
/// in clutter (1980).
class Association {
 public:
  /// Exact marginals are computed by a sum over subsets of the smaller side of a group of competing
  /// tracks and detections, up to this size. Larger groups use belief propagation.
  static constexpr int kExactMax = 10;

  Association() = default;
  Association(int tracks_max, int detections_max);

  /// Sets the numbers of tracks and detections; all odds are 0, so that every track is missed.
  /// Precondition: at most the numbers given to the constructor.
  void start(int tracks, int detections);
  /// Sets w_ij / w_i0 ≥ 0: the odds that detection j belongs to track i, against the case that
  /// track i is missed and detection j belongs to no track.
  void set(int track, int detection, double odds) { odds_[at(track, detection)] = odds; }
  [[nodiscard]] double odds(int track, int detection) const { return odds_[at(track, detection)]; }

  /// Returns the detection of each track in the most likely association, −1 for none. The result is
  /// valid until the next call.
  /// Cost: O(tracks² · (tracks + detections)).
  std::span<const int> best();
  /// Computes the marginals. In a group, p is the smaller and q the larger of the numbers of tracks
  /// and detections. Up to p = kExactMax the cost is O(p q 2^p). Above it, belief propagation needs
  /// at most 200 iterations of O(p q), and the result is approximate.
  void solve();
  /// Returns β_ij of the last solve(); miss_probability() returns β_i0.
  [[nodiscard]] double probability(int track, int detection) const {
    return probabilities_[at(track, detection)];
  }
  [[nodiscard]] double miss_probability(int track) const;
  /// Returns 1 − Σ_i β_ij, the probability that detection j belongs to no track.
  [[nodiscard]] double unassigned_probability(int detection) const;

 private:
  [[nodiscard]] std::size_t at(int track, int detection) const {
    return static_cast<std::size_t>(track * detections_ + detection);
  }
  /// Returns the odds of a row and a column of the group. Rows are the tracks or the detections of
  /// the group, whichever are more numerous.
  [[nodiscard]] double group_odds(int row, int column) const;
  void set_group_probability(int row, int column, double probability);
  void gather_group(int first_track);
  void solve_exactly();
  void solve_by_messages();

  int tracks_ = 0;
  int detections_ = 0;
  std::vector<double> odds_;
  std::vector<double> probabilities_;
  std::vector<char> is_grouped_;   // by track: nonzero if it already belongs to a group
  std::vector<char> is_in_group_;  // by detection: nonzero if it belongs to the current group
  std::vector<int> group_tracks_;  // the group's competing tracks
  std::vector<int> group_detections_;
  bool has_tracks_as_rows_ = true;
  std::vector<double>
      forward_;  // exact method: (rows + 1) · 2^columns sums; belief propagation: messages
  std::vector<double> backward_;  // exact method: 2 · 2^columns sums; belief propagation: messages
  std::vector<double> cost_;
  std::vector<int> best_;
  AssignmentSolver solver_;
};

}  // namespace vantage::estimator
