#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "estimator/tracks/gaussian/track.hpp"

namespace vantage::estimator {

/// Table of entries sorted by target id. It contains only known targets. `Kept` must have a member
/// target_id.
template <class Kept>
class TargetTable {
 public:
  /// Number of entries reserved at construction. Up to this number nothing is allocated later.
  static constexpr std::size_t kReserved = 128;
  explicit TargetTable(int target_count = 0) {
    kept_.reserve(std::min(static_cast<std::size_t>(std::max(0, target_count)), kReserved));
  }

  [[nodiscard]] const Kept* find(int target_id) const {
    const auto at = place_of(kept_, target_id);
    return at != kept_.end() && at->target_id == target_id ? &*at : nullptr;
  }
  [[nodiscard]] Kept* find(int target_id) {
    const auto at = place_of(kept_, target_id);
    return at != kept_.end() && at->target_id == target_id ? &*at : nullptr;
  }
  /// Inserts `one`, or replaces the entry of the same target.
  Kept& put(const Kept& one) {
    const auto at = place_of(kept_, one.target_id);
    if (at != kept_.end() && at->target_id == one.target_id) {
      return *at = one;
    }
    return *kept_.insert(at, one);
  }
  template <class Predicate>
  void erase_if(Predicate is_gone) {
    std::erase_if(kept_, is_gone);
  }
  void clear() { kept_.clear(); }
  [[nodiscard]] auto begin() { return kept_.begin(); }
  [[nodiscard]] auto end() { return kept_.end(); }
  [[nodiscard]] auto begin() const { return kept_.begin(); }
  [[nodiscard]] auto end() const { return kept_.end(); }

 private:
  template <class List>
  static auto place_of(List& list, int target_id) {
    return std::lower_bound(list.begin(), list.end(), target_id,
                            [](const Kept& each, int id) { return each.target_id < id; });
  }
  std::vector<Kept> kept_;
};

struct KnownTrack {
  int target_id = 0;
  Track track;
};
using TrackTable = TargetTable<KnownTrack>;

/// Σ_j w_j (Ω_j, ω_j) over the teammates that know the target, w_j = √det Ω_j.
struct ReceivedTrack {
  int target_id = 0;
  Track track;
  double weight = 0.0;  ///< Σ_j w_j
};
using ReceivedTable = TargetTable<ReceivedTrack>;

}  // namespace vantage::estimator
