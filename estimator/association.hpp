#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/assignment.hpp"

namespace vantage::estimator {

/// How likely it is that each track was seen as each detection, if each was seen as at most one and
/// each detection is of at most one.
///
/// An association a gives track i the detection a_i or none (a_i = 0); its probability is
/// ∝ Π_i w_{i a_i} over all a that give no detection twice. What is asked for is the marginals
/// β_ij = P(a_i = j), in which Σ_j β_ij + β_i0 = 1 and Σ_i β_ij ≤ 1, and the likeliest a.
/// Storage is of the size that it was made for; nothing else is allocated.
/// Source: Bar-Shalom, Fortmann, Scheffe, Joint probabilistic data association for multiple targets
/// in clutter (1980).
class Association {
 public:
  /// The more numerous side of a group of tracks and detections that compete is summed over subsets
  /// of the less numerous one, exactly, up to this many of them; larger groups are left to belief
  /// propagation.
  static constexpr int kExactMax = 10;

  Association() = default;
  Association(int tracks_max, int detections_max);

  /// Starts anew with tracks that were all missed. Precondition: within what it was made for.
  void start(int tracks, int detections);
  /// w_ij / w_i0 ≥ 0: what speaks for detection j being track i, against track i being missed and
  /// detection j being nobody's.
  void set(int track, int detection, double odds) { odds_[at(track, detection)] = odds; }
  [[nodiscard]] double odds(int track, int detection) const { return odds_[at(track, detection)]; }

  /// Detection of each track in the likeliest association, −1: none. Valid until the next call.
  /// Cost: O(tracks² · (tracks + detections)).
  std::span<const int> best();
  /// Computes the marginals. Cost of a group of competing tracks and detections, p the fewer and q
  /// the more of them: O(p q 2^p) up to p = kExactMax, else of at most 200 rounds of O(p q), and
  /// then approximate.
  void solve();
  /// β_ij and β_i0 of the last solve().
  [[nodiscard]] double probability(int track, int detection) const {
    return probabilities_[at(track, detection)];
  }
  [[nodiscard]] double miss_probability(int track) const;
  /// 1 − Σ_i β_ij: that detection j is none of the tracks.
  [[nodiscard]] double nobodys_probability(int detection) const;

 private:
  [[nodiscard]] std::size_t at(int track, int detection) const {
    return static_cast<std::size_t>(track * detections_ + detection);
  }
  /// Odds of row against column of the group, rows the more numerous side.
  [[nodiscard]] double group_odds(int row, int column) const;
  void set_group_probability(int row, int column, double probability);
  void gather_group(int first_track);
  void solve_exactly();
  void solve_by_messages();

  int tracks_ = 0;
  int detections_ = 0;
  std::vector<double> odds_;
  std::vector<double> probabilities_;
  std::vector<char> is_grouped_;   // by track
  std::vector<char> is_in_group_;  // by detection
  std::vector<int> group_tracks_;  // that compete with each other
  std::vector<int> group_detections_;
  bool has_tracks_as_rows_ = true;
  std::vector<double> forward_;   // rows + 1 times 2^columns; messages
  std::vector<double> backward_;  // 2^columns, twice
  std::vector<double> cost_;
  std::vector<int> best_;
  AssignmentSolver solver_;
};

}  // namespace vantage::estimator
