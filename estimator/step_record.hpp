#pragma once

#include <vector>

#include "core/time.hpp"
#include "estimator/track.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// One look of the own sensor, by target.
struct Look {
  Time time{};
  models::Viewpoint from;
  std::vector<models::Detection> detections;  ///< at most one a target, ids in range
  bool counted = false;  ///< what became of its detections is in the counters already
};

/// Everything that a step was made from, so that it can be done again with one look more.
/// Storage is reused; it grows only beyond kLooks looks.
struct StepRecord {
  static constexpr int kLooks = 4;

  Time from{};
  Time to{};
  std::vector<Track> before;  ///< tracks at `from`
  /// Σ_j κ_ij (Ω_j, ω_j) at `to` over the teammates who know the target; by target.
  std::vector<Track> heard;
  std::vector<double> heard_weight;  ///< Σ_j κ_ij over them; 0: nobody
  double own_weight = 1.0;           ///< κ_ii
  std::vector<Look> looks;           ///< the first look_count, by time; the rest is spare
  int look_count = 0;

  StepRecord() = default;
  explicit StepRecord(int target_count);

  /// Starts over for a step `begin` → `end` from `tracks`.
  void start(Time begin, Time end, const std::vector<Track>& tracks);
  /// A cleared place for a look of instant `time`, after those of the same instant.
  Look& insert(Time time);
};

}  // namespace vantage::estimator
