#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "estimator/multi_target.hpp"
#include "estimator/track_labels.hpp"
#include "estimator/track_table.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// One look of the own sensor or of a teammate's, by target.
struct Look {
  Time time{};
  int looker = -1;  ///< whose, an index into FilterSpec::team; −1: own, of a robot not in there
  models::Viewpoint from;
  std::vector<models::Detection> detections;  ///< at most one a target, ids in range
  bool counted = false;  ///< what became of its detections is in the counters already
};

/// Everything that a step was made from, so that it can be done again with one look more.
/// Storage is reused; it grows only beyond the looks that it was made for.
struct StepRecord {
  Time from{};
  Time to{};
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< the robot's own, at `to`
  TrackTable before;                                  ///< tracks at `from`
  HeardTable heard_of_start;                          ///< at `from`, told of then or earlier
  HeardTable heard;                                   ///< at `to`, told of later than `from`
  std::vector<LabelledTrack> labelled_before;         ///< of sensors that tell no ids, at `from`
  std::vector<HeardLabel> heard_labels;               ///< theirs, at `from` or at `to`, by teller
  bool is_heard_of_end = false;  ///< some of it is of `to` itself, with the looks of `to`
  std::vector<Look> looks;       ///< the first look_count, by time and looker; the rest is spare
  int look_count = 0;

  StepRecord() = default;
  /// Detections of all looks together that there is room for, where every look of a small team has
  /// room for every target: a large team's looks, most of them out of hearing, cost no more.
  static constexpr std::size_t kDetectionsReserved = 512;

  /// @param looks_max  looks of one step that there is room for at once
  StepRecord(int target_count, int looks_max);

  /// Starts over for a step `begin` → `end` from `tracks`.
  void start(Time begin, Time end, const TrackTable& tracks);
  /// A cleared place for a look of instant `time` by `looker`: after those of before, and of the
  /// same instant after those of lookers up to it. Every robot works through the team's looks in
  /// the same order only if lookers of one instant are in the same order for all, which is the
  /// filter's business.
  Look& insert(Time time, int looker);
  /// True when a look of that instant by that looker is there.
  [[nodiscard]] bool holds(Time time, int looker) const;
};

}  // namespace vantage::estimator
