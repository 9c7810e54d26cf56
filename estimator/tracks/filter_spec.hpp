#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "models/sensor/clutter.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"
#include "scenario/scenario.hpp"

// Parameters and counters that a filter shares with its store of tracks.

namespace vantage::estimator {

/// Sensor of a robot that provides observations.
struct ObservationSource {
  std::string robot;
  models::SensorModel sensor;
  models::DetectionModel detection{};
};

/// Parameters of one robot's filter: the robot, its team and the world.
struct FilterSpec {
  std::string robot;
  models::SensorModel sensor;
  models::DetectionModel detection{};  ///< detects_ids applies to the whole team
  /// The filter uses the observations of these robots in addition to this robot's own. Every robot
  /// lists them in the same order. This robot may be included.
  std::vector<ObservationSource> team;
  models::Viewpoint
      start;  ///< viewpoint that is assumed for this robot until its first pose arrives
  scenario::EstimatorSpec estimator;
  models::World world;
  int target_count = 0;  ///< ids are 0 … target_count − 1
  /// m; smallest radius of the targets, 0: points. Centres stay this distance away from walls, and
  /// twice this distance away from each other.
  double target_radius_m = 0.0;
  double step_s = 0.5;                 ///< τ
  double communication_range_m = 0.0;  ///< m; ≤ 0: no communication
  /// m; radius of the neighbourhood. Tracks of targets farther away are deleted and left to other
  /// robots; the grid covers only the neighbourhood. 0: unlimited.
  double neighbourhood_m = 0.0;
  double belief_age_max_s = 1.5;  ///< s; teammates' beliefs that are older are ignored
  int history_steps = 8;  ///< number of past steps into which a late observation can be inserted
};

/// Returns the spec of `robot` in `scenario`, with belief_age_max_s = 3 τ.
/// @throws UsageError when the scenario has no such robot.
FilterSpec filter_spec(const scenario::Scenario& scenario, const std::string& robot);

/// Counts of the results of reconcile(), see track_labels.hpp.
struct Reconciled {
  std::int64_t relabelled = 0;  ///< tracks of this robot that were given an older label
  std::int64_t adopted = 0;  ///< teammates' tracks that match no track of this robot and were added
  /// tracks of this robot that were replaced by a teammate's more informative belief
  std::int64_t taken_over = 0;
};

/// Numbers of dropped or unusable inputs since construction.
struct FilterCounters {
  /// steps ignored because their time was not later than that of the previous step
  std::int64_t steps_out_of_order = 0;
  std::int64_t stale_beliefs = 0;         ///< beliefs older than belief_age_max_s
  std::int64_t future_beliefs = 0;        ///< beliefs of an instant after t
  std::int64_t out_of_range_beliefs = 0;  ///< beliefs of teammates beyond communication_range_m
  std::int64_t out_of_range_looks = 0;  ///< observations of teammates beyond communication_range_m
  /// observations by a robot at an instant for which one was already used
  std::int64_t repeated_looks = 0;
  /// beliefs in which a target's block has the wrong dimension
  std::int64_t malformed_beliefs = 0;
  std::int64_t grid_mismatches = 0;  ///< beliefs with another grid geometry
  /// observations older than the previous step, inserted at their instant
  std::int64_t late_measurements = 0;
  std::int64_t too_late_measurements = 0;  ///< observations older than the history: dropped
  std::int64_t future_measurements = 0;    ///< observations of an instant after t: dropped
  std::int64_t jammed_looks = 0;
  /// detections of wrong dimension, or second detections of one target
  std::int64_t malformed_detections = 0;
  /// detections without ids beyond the capacity per observation
  std::int64_t surplus_detections = 0;
  std::int64_t gated = 0;
  std::int64_t unknown_ids = 0;        ///< ids that name neither a target nor a track
  std::int64_t undiscoverable = 0;     ///< first detections from which no position can be computed
  std::int64_t singular = 0;           ///< matrices that could not be inverted
  std::int64_t missed_detections = 0;  ///< belief updates by missed detections
  Reconciled reconciled;               ///< reconciliation of tracks without ids

  /// Returns the nonzero counters that indicate problems, by name. The result omits
  /// out_of_range_beliefs, out_of_range_looks, missed_detections and reconciled, which count normal
  /// events.
  [[nodiscard]] std::vector<models::NamedCount> named() const;
};

}  // namespace vantage::estimator
