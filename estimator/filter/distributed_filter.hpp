#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/time.hpp"
#include "estimator/filter/step_record.hpp"
#include "estimator/tracks/labelled/multi_target.hpp"
#include "estimator/tracks/labelled/track_labels.hpp"
#include "estimator/tracks/samples/target_collisions.hpp"
#include "estimator/tracks/samples/track_table.hpp"
#include "models/exchange/messages.hpp"
#include "models/world/grid.hpp"
#include "scenario/scenario.hpp"

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
  /// The filter uses the observations of these robots in addition to this robot's own. The order is
  /// the same for all robots. This robot may be included.
  std::vector<ObservationSource> team;
  models::Viewpoint start;  ///< assumed own viewpoint until the first pose arrives
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
  double belief_age_max_s = 1.5;  ///< s; older beliefs of teammates are ignored
  int history_steps = 8;  ///< number of past steps into which a late observation can be inserted
};

/// Returns the spec of `robot` in `scenario`, with belief_age_max_s = 3 τ.
/// @throws UsageError when the scenario has no such robot.
FilterSpec filter_spec(const scenario::Scenario& scenario, const std::string& robot);

/// Input of one step. Pointers must be valid during the call only.
struct StepInput {
  Time time{};                                 ///< t; later than the previous step's
  std::optional<models::Viewpoint> viewpoint;  ///< own, at t; absent: as in the previous step
  /// Own and teammates' observations, of any instants ≤ t. Observations of a robot that is not in
  /// FilterSpec::team are used as this robot's own.
  std::span<const models::RobotMeasurement* const> measurements;
  std::span<const models::RobotBelief* const> beliefs;  ///< newest belief of each teammate
};

/// Numbers of dropped or unusable inputs since construction.
struct FilterCounters {
  std::int64_t steps_out_of_order = 0;    ///< not later than the previous step: ignored
  std::int64_t stale_beliefs = 0;         ///< beliefs older than belief_age_max_s
  std::int64_t future_beliefs = 0;        ///< beliefs of an instant after t
  std::int64_t out_of_range_beliefs = 0;  ///< teammate beyond communication_range_m
  std::int64_t out_of_range_looks = 0;    ///< teammate beyond communication_range_m
  std::int64_t repeated_looks = 0;        ///< same robot and instant as an observation already used
  std::int64_t malformed_beliefs = 0;     ///< a target's block has the wrong dimension
  std::int64_t grid_mismatches = 0;       ///< a teammate's grid geometry differs
  std::int64_t late_measurements = 0;  ///< older than the previous step, inserted at their instant
  std::int64_t too_late_measurements = 0;  ///< observations older than the history: dropped
  std::int64_t future_measurements = 0;    ///< observations of an instant after t: dropped
  std::int64_t jammed_looks = 0;
  std::int64_t malformed_detections = 0;  ///< wrong dimension, or second of one target
  std::int64_t surplus_detections = 0;    ///< without ids: beyond the capacity per observation
  std::int64_t gated = 0;
  std::int64_t unknown_ids = 0;        ///< ids that are neither a target nor a track label
  std::int64_t undiscoverable = 0;     ///< first detection gives no position
  std::int64_t singular = 0;           ///< a matrix that could not be inverted
  std::int64_t missed_detections = 0;  ///< belief updates by missed detections
  Reconciled reconciled;               ///< reconciliation of tracks without ids

  /// Returns the nonzero counters that indicate problems, by name. The result omits
  /// out_of_range_beliefs, out_of_range_looks, missed_detections and reconciled, which count normal
  /// events.
  [[nodiscard]] std::vector<models::NamedCount> named() const;
};

/// One robot's part of the team's distributed information filter.
///
/// Robots broadcast their observations, and a robot uses observations of teammates within
/// communication range like its own observations. Each robot uses each measurement once. If every
/// robot receives all observations, each robot has the estimate of the central filter. Information
/// from observations that were not received arrives through teammates' beliefs.
///
/// For each target, step(t) first fuses the own track with all received beliefs of the previous
/// step's instant:
///   Ω ← (1 − κ) Ω + κ Σ_j w_j Ω_j / Σ_j w_j,  ω likewise,  w_j = √det Ω_j,
/// over the teammates that know the target. κ in [0, 1] maximises det Ω (covariance intersection);
/// it is 0 when the teammates add no information. If the target is unknown, the teammates' belief
/// is used unchanged. Then all tracks are predicted to t, so that walls and collisions act on the
/// received information too. Then the measurements of t are added. A belief of an instant after the
/// previous step is fused in the same way at t. Observations between two steps are used at their
/// own time: after the fusion of the earlier step and before that of the later step. A late
/// observation is inserted at its instant. All steps after it are repeated with the beliefs that
/// they used, and the result equals that of timely arrival. For missed detections see
/// missed_detection(), for the free space see confine(). With gate_sigma, a detection outside its
/// target's gate is not used but doubted, see doubt(). Only sensors that measure position have a
/// gate. A swapped or false id thus does not change a mean. After an unexpected motion, or if a
/// false id started the track, the track follows its target from the next consistent detection on.
///
/// A convex combination of conservative beliefs is conservative, whatever information they share.
/// Observations are never added to a belief that contains them. Observations of t are used after
/// the fusion only if no received belief is of t, and a repeated observation is dropped. Thus no
/// observation is counted twice, even if the network repeats, reorders or loses messages. The
/// covariance of an unseen target grows to the stationary covariance of the damped oscillator. With
/// other models it grows until the world's bounds limit it, or without limit if targets_stay_inside
/// is off.
///
/// Where sensors report no ids (FilterSpec::detection), observations are exchanged, stored and
/// inserted in the same way, but a MultiTargetFilter uses them. Tracks are named by labels from
/// kTrackLabelMin on (track_labels.hpp). Robots that have used the same observations have the same
/// tracks, bit for bit. A teammate's belief of the previous or of this step's instant, or between
/// them, is reconciled with the own tracks; an older belief is not used. After rebase(), each track
/// is a single Gaussian, so later results differ from those of the filter that published the
/// belief.
///
/// With EstimatorSpec::samples, Samples represent a target with a velocity after its belief was
/// changed by a wall, a collision with another target (TargetCollisions) or a missed detection. A
/// detection, or the belief of a teammate with a newer detection, makes it a Gaussian again.
/// belief() contains the samples' moments, mixture() a mixture. After rebase(), only the moments
/// remain.
///
/// With a neighbourhood, targets beyond it are deleted and not published. A published belief thus
/// contains all tracks, and another filter can continue from it (rebase()).
///
/// Copies are independent. The same inputs give the same result.
/// Source: dissertation 3.3, 3.4, Thm 9; covariance intersection: Julier, Uhlmann (1997).
class DistributedFilter {
 public:
  /// @throws UsageError for an invalid spec.
  explicit DistributedFilter(FilterSpec spec);

  /// Calls advance(), then returns belief().
  models::RobotBelief step(const StepInput& input);
  /// Performs one step. It allocates only in these cases: more than four observations plus one per
  /// teammate in one step, more than 64 teammates, more detections than the capacity of StepRecord,
  /// teammates' grids, and obstacles near an observation.
  void advance(const StepInput& input);
  /// Returns the mixtures of the targets with a belief that is not Gaussian: the content of
  /// MIXTURE_R without run id, sequence and step. A target is omitted if its samples form only one
  /// part. Without ids, all confirmed tracks are included.
  [[nodiscard]] models::BeliefMixture mixture() const;
  /// Returns the current estimate: the content of BELIEF_R without run id, sequence, step and
  /// inputs.
  [[nodiscard]] models::RobotBelief belief() const;
  /// Continues from `belief` as if this filter had computed it, and deletes the history of steps.
  /// This function also sets a prior.
  void rebase(const models::RobotBelief& belief);

  /// Returns a copy of the track, because tracks move in memory when another target is discovered.
  /// For an unknown target it returns a default Track.
  [[nodiscard]] Track track(int target_id) const {
    const KnownTrack* known = tracks_.find(target_id);
    return known == nullptr ? Track{} : known->track;
  }
  /// Returns the tracks of sensors without ids; empty otherwise.
  [[nodiscard]] const std::vector<LabelledTrack>& labelled_tracks() const { return labelled_; }
  [[nodiscard]] const models::VisibilityGrid& grid() const { return grid_; }
  [[nodiscard]] const FilterCounters& counters() const { return counters_; }
  [[nodiscard]] const FilterSpec& spec() const { return spec_; }

 private:
  void collect_beliefs(const StepInput& input, StepRecord& record);
  /// Returns the belief conditioned on the free space; nullopt if its covariance is then singular.
  [[nodiscard]] std::optional<models::Information> kept_inside(
      const models::Information& information) const;
  void add_belief(const models::RobotBelief& belief, StepRecord& record);
  /// Like add_belief(), for sensors without ids.
  void add_labelled_belief(const models::RobotBelief& belief, StepRecord& record);
  void merge_grid(const models::RobotBelief& belief);
  /// Returns the index in spec_.team of the robot that made an observation. For a robot outside the
  /// team it returns the index of this robot, or −1 if this robot is not in the team either.
  [[nodiscard]] int source_of(const models::RobotMeasurement& look) const;
  [[nodiscard]] const models::SensorModel& sensor_of(int source) const;
  [[nodiscard]] const models::DetectionModel& detection_of(int source) const;
  [[nodiscard]] bool is_self(int source) const;
  /// Stores an observation in the record of its step. Returns the number of records after that
  /// step, −1 if the observation was dropped.
  int file(const models::RobotMeasurement& look, Time now);
  void run(StepRecord& record);
  void rebase_tracks(const models::RobotBelief& belief);
  /// True if samples represent beliefs that are not Gaussian.
  [[nodiscard]] bool uses_samples() const;
  /// True if targets are discs that can collide.
  [[nodiscard]] bool can_collide() const;
  void propagate_all(Time from, Time to);
  void apply(Observation& look);
  void apply_missed_detections(const Observation& look, FilterCounters& count);
  void fuse(const ReceivedTable& all_received);
  /// Reconciles the labelled tracks, which are of instant `at`, with the received beliefs of `at`.
  void reconcile_labels(const StepRecord& record, Time at);
  /// Erases tracks with known == false.
  void drop_unknown();
  void confine_all();
  /// Forgets targets beyond the neighbourhood of `position_m`.
  void forget_far(const Eigen::Vector2d& position_m);
  /// Moves the grid to the robot's position.
  void move_grid();
  StepRecord& record(int age);

  FilterSpec spec_;
  models::World free_space_;  ///< free space of the targets' centres
  std::optional<Time> time_;  ///< instant of tracks_; absent before the first step
  models::Viewpoint viewpoint_;
  int degree_ = 0;
  TrackTable tracks_;
  TargetCollisions collisions_;
  std::optional<MultiTargetFilter> multi_target_;  ///< for sensors without ids
  std::vector<LabelledTrack> labelled_;            ///< replaces tracks_ for sensors without ids
  std::vector<ReceivedLabel> received_labels_;     ///< scratch of reconcile_labels()
  models::VisibilityGrid grid_;
  std::vector<StepRecord> records_;  ///< ring buffer of past steps
  int newest_ = 0;
  int recorded_ = 0;
  std::unordered_map<std::string, int> source_indices_;  ///< indices into spec_.team
  std::vector<const models::RobotBelief*> in_range_;     ///< scratch of collect_beliefs()
  FilterCounters counters_;
};

}  // namespace vantage::estimator
