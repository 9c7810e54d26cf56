#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "estimator/tracks/track_store.hpp"

namespace vantage::estimator {

/// The observations of a step, stored so that the step can be repeated with an additional one. The
/// received beliefs are kept by the store of tracks. Storage is reused; it grows only if there are
/// more observations than the constructor reserved.
struct StepRecord {
  Step step;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< m; the robot's position at Step::to
  std::vector<Observation>
      observations;  ///< sorted by time and source; only the first observation_count are used
  int observation_count = 0;

  StepRecord() = default;
  /// Capacity for the detections of all observations together. In a small team every observation
  /// can hold every target. In a large team most observations are out of range, so the same memory
  /// is sufficient.
  static constexpr std::size_t kDetectionsReserved = 512;

  /// Reserves storage for a number of observations and of detections in each of them.
  StepRecord(int detections_max, int observations_max);

  /// Resets the record for `next`.
  void start(const Step& next);
  /// Inserts an empty observation, ordered by `time` and then by `source`. Every robot processes
  /// the team's observations in the same order only if sources have the same order for all robots;
  /// the filter ensures this.
  Observation& insert(Time time, int source);
  /// True if the record contains an observation made at `time` by `source`.
  [[nodiscard]] bool holds(Time time, int source) const;
};

}  // namespace vantage::estimator
