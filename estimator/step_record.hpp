#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "estimator/multi_target.hpp"
#include "estimator/track_labels.hpp"
#include "estimator/track_table.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// One observation of the own sensor or of a teammate's.
struct Look {
  Time time{};
  int looker = -1;  ///< index into FilterSpec::team; −1: own, of a robot not in the team
  models::Viewpoint from;
  std::vector<models::Detection> detections;  ///< with ids: at most one per target, ids in range
  bool counted = false;                       ///< its detections are counted already
};

/// All inputs of a step, so that it can be repeated with an additional observation. Storage is
/// reused; it grows only beyond the number of observations given to the constructor.
struct StepRecord {
  Time from{};
  Time to{};
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< m; the robot's position at `to`
  TrackTable before;                                  ///< tracks at `from`
  HeardTable heard_of_start;  ///< received beliefs of instants ≤ `from`, at `from`
  HeardTable heard;           ///< received beliefs of instants > `from`, at `to`
  std::vector<LabelledTrack> labelled_before;  ///< tracks at `from` for sensors without ids
  std::vector<HeardLabel> heard_labels;        ///< teammates' tracks at `from` or `to`, by teammate
  /// A received belief is of `to` and contains the observations of `to`.
  bool is_heard_of_end = false;
  std::vector<Look> looks;  ///< the first look_count, by time and looker; the others are spare
  int look_count = 0;

  StepRecord() = default;
  /// Capacity for detections in all observations together. In a small team every observation has
  /// room for every target. A large team's observations, most of them out of range, use no more
  /// memory.
  static constexpr std::size_t kDetectionsReserved = 512;

  /// @param looks_max  observations of one step for which room is reserved
  StepRecord(int target_count, int looks_max);

  /// Resets the record for a step `begin` → `end` from `tracks`.
  void start(Time begin, Time end, const TrackTable& tracks);
  /// Inserts an empty observation, ordered by `time` and then by `looker`. Every robot processes
  /// the team's observations in the same order only if lookers have the same order for all robots;
  /// the filter ensures this.
  Look& insert(Time time, int looker);
  /// True if an observation of that instant by that looker is present.
  [[nodiscard]] bool holds(Time time, int looker) const;
};

}  // namespace vantage::estimator
