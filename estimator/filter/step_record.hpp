#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "estimator/tracks/labelled/multi_target.hpp"
#include "estimator/tracks/labelled/track_labels.hpp"
#include "estimator/tracks/samples/track_table.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// One observation by this robot's sensor or by a teammate's.
struct Observation {
  Time time{};
  int source = -1;  ///< index into FilterSpec::team; −1: this robot, which is not in the team
  models::Viewpoint from;
  std::vector<models::Detection> detections;  ///< with ids: at most one per target, ids in range
  bool counted = false;                       ///< counters include its detections
};

/// All inputs of a step, stored so that the step can be repeated with an additional observation.
/// Storage is reused; it grows only beyond the number of observations given to the constructor.
struct StepRecord {
  Time from{};
  Time to{};
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< m; the robot's position at `to`
  TrackTable before;                                     ///< tracks at `from`
  ReceivedTable received_at_start;  ///< received beliefs of instants ≤ `from`, predicted to `from`
  ReceivedTable received_at_end;    ///< received beliefs of instants > `from`, predicted to `to`
  std::vector<LabelledTrack> labelled_before;  ///< tracks at `from` for sensors without ids
  std::vector<ReceivedLabel> received_labels;  ///< teammates' tracks at `from` or `to`, by teammate
  /// True if a received belief is of instant `to`. Such a belief contains the observations of `to`.
  bool has_belief_of_end = false;
  std::vector<Observation> observations;  ///< by time and source; first observation_count used
  int observation_count = 0;

  StepRecord() = default;
  /// Capacity for the detections of all observations together. In a small team every observation
  /// can hold every target. In a large team most observations are out of range, so the same memory
  /// is sufficient.
  static constexpr std::size_t kDetectionsReserved = 512;

  /// @param observations_max number of observations per step for which storage is reserved
  StepRecord(int target_count, int observations_max);

  /// Resets the record for a step `begin` → `end` from `tracks`.
  void start(Time begin, Time end, const TrackTable& tracks);
  /// Inserts an empty observation, ordered by `time` and then by `source`. Every robot processes
  /// the team's observations in the same order only if sources have the same order for all robots;
  /// the filter ensures this.
  Observation& insert(Time time, int source);
  /// True if the record contains an observation made at `time` by `source`.
  [[nodiscard]] bool holds(Time time, int source) const;
};

}  // namespace vantage::estimator
