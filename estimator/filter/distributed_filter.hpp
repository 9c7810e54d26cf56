#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/index.hpp"
#include "core/time.hpp"
#include "estimator/filter/step_record.hpp"
#include "estimator/tracks/filter_spec.hpp"
#include "estimator/tracks/gaussian/track.hpp"
#include "estimator/tracks/track_store.hpp"
#include "models/exchange/messages.hpp"
#include "models/world/grid.hpp"

namespace vantage::estimator {

/// Input of one step. Pointers must be valid during the call only.
struct StepInput {
  Time time{};  ///< t; later than the time of the previous step
  /// viewpoint of this robot at t; absent: the viewpoint of the previous step is used
  std::optional<models::Viewpoint> viewpoint;
  /// Observations of this robot and of teammates, made at any instants ≤ t. Observations of a robot
  /// that is not in FilterSpec::team are used as this robot's own.
  std::span<const models::RobotMeasurement* const> measurements;
  std::span<const models::RobotBelief* const> beliefs;  ///< newest belief of each teammate
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
/// own time: after the fusion of the earlier step and before the fusion of the later step. A late
/// observation is inserted at its instant. All later steps are repeated with the beliefs that they
/// used, so the result is the same as if the observation had arrived in time. For missed detections
/// see missed_detection(), for the free space see confine(). With gate_sigma, a detection outside
/// its target's gate is not used but doubted, see doubt(). Only sensors that measure position have
/// a gate. A swapped or false id thus does not change a mean. After an unexpected motion, or if a
/// false id started the track, the track follows its target from the next consistent detection on.
///
/// A convex combination of conservative beliefs is conservative, whatever information they share.
/// Observations are never added to a belief that contains them: if a received belief belongs to t,
/// the observations made at t are used before the fusion. A repeated observation is dropped. Thus
/// no observation is counted twice, even if the network repeats, reorders or loses messages. The
/// covariance of an unseen target grows to the stationary covariance of the damped oscillator. With
/// other models it grows until the world's bounds limit it, or without limit if targets_stay_inside
/// is off.
///
/// A TrackStore represents the beliefs: GaussianTracks, SampleTracks (EstimatorSpec::samples) or
/// LabelledTracks (sensors without ids, FilterSpec::detection). The formulas above are those of
/// GaussianTracks. After rebase(), each target is a single Gaussian, so later results of
/// SampleTracks and LabelledTracks differ from those of the filter that published the belief.
///
/// With a neighbourhood, targets beyond it are deleted and not published. A published belief thus
/// contains all tracks, and another filter can continue from it (rebase()).
///
/// Copies are independent. The same inputs give the same result.
/// Source: dissertation, sections 3.3 and 3.4, theorem 9. Source of the covariance intersection:
/// Julier, Uhlmann (1997).
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
  /// MIXTURE_R without run id, sequence and step.
  [[nodiscard]] models::BeliefMixture mixture() const;
  /// Returns the current estimate: the content of BELIEF_R without run id, sequence, step and
  /// inputs.
  [[nodiscard]] models::RobotBelief belief() const;
  /// Continues from `belief` as if this filter had computed it, and deletes the history of steps.
  /// Can also be used to set a prior.
  void rebase(const models::RobotBelief& belief);

  /// Returns a copy of the track, because tracks move in memory when another target is discovered.
  /// Returns a default Track if the target is unknown, or if detections have no ids.
  [[nodiscard]] Track track(int target_id) const {
    const Track* const known = tracks_->find(target_id);
    return known == nullptr ? Track{} : *known;
  }
  [[nodiscard]] const models::VisibilityGrid& grid() const { return grid_; }
  [[nodiscard]] const FilterCounters& counters() const { return counters_; }
  [[nodiscard]] const FilterSpec& spec() const { return spec_; }

 private:
  void collect_beliefs(const StepInput& input, const Step& step);
  void merge_grid(const models::RobotBelief& belief);
  /// Returns the index in spec_.team of the robot that made an observation. For a robot outside the
  /// team it returns the index of this robot, or −1 if this robot is not in the team either.
  [[nodiscard]] int source_of(const models::RobotMeasurement& look) const;
  [[nodiscard]] bool is_self(int source) const;
  [[nodiscard]] const ObservationSource& source_at(int source) const;
  /// Returns the number of records after the step to which an observation belongs. If the
  /// observation cannot be used, counts it and returns −1.
  int age_of(const models::RobotMeasurement& look, int source, Time now);
  /// Stores an observation in the record of its step. Returns the result of age_of().
  int file(const models::RobotMeasurement& look, Time now);
  void run(StepRecord& record);
  void apply(Observation& look);
  /// Moves the grid to the robot's position.
  void move_grid();
  /// Returns the index of a record in records_, which is also the slot of its step.
  [[nodiscard]] int slot(int age) const;
  StepRecord& record(int age) { return records_[index(slot(age))]; }

  FilterSpec spec_;
  ObservationSource self_;    ///< this robot's own sensor
  std::optional<Time> time_;  ///< instant of tracks_; absent before the first step
  models::Viewpoint viewpoint_;
  int degree_ = 0;
  OwnedTracks tracks_;
  models::VisibilityGrid grid_;
  std::vector<StepRecord> records_;  ///< ring buffer of past steps
  int newest_ = 0;
  int recorded_ = 0;
  std::unordered_map<std::string, int> source_indices_;  ///< indices into spec_.team
  std::vector<const models::RobotBelief*> in_range_;     ///< scratch of collect_beliefs()
  FilterCounters counters_;
};

}  // namespace vantage::estimator
