#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/time.hpp"
#include "estimator/meetings.hpp"
#include "estimator/multi_target.hpp"
#include "estimator/step_record.hpp"
#include "estimator/track_labels.hpp"
#include "estimator/track_table.hpp"
#include "models/exchange/messages.hpp"
#include "models/world/grid.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// A robot whose looks are used.
struct Looker {
  std::string robot;
  models::SensorModel sensor;
  models::DetectionModel detection{};
};

/// What one robot's filter has to know of itself, its team and the world.
struct FilterSpec {
  std::string robot;
  models::SensorModel sensor;
  models::DetectionModel detection{};  ///< detects_ids: of the whole team
  /// Whose looks are used besides the own ones, in an order that is the same for all; the robot
  /// itself may be among them.
  std::vector<Looker> team;
  models::Viewpoint start;  ///< taken for its own place until the first pose arrives
  scenario::EstimatorSpec estimator;
  models::World world;
  int target_count = 0;  ///< ids are 0 … target_count − 1
  /// The smallest: no middle is nearer to a wall, no two are nearer than twice it; 0: points.
  double target_radius_m = 0.0;
  double step_s = 0.5;                 ///< τ
  double communication_range_m = 0.0;  ///< ≤ 0: no communication
  /// Targets farther off than this are others' business: what was known of them is forgotten, and
  /// the grid is that part of the world's. 0: everything is this robot's business.
  double neighbourhood_m = 0.0;
  double belief_age_max_s = 1.5;  ///< older beliefs of teammates are stale
  int history_steps = 8;          ///< how far back a late measurement can be put in its place
};

/// The spec of `robot` in `scenario`, with belief_age_max_s = 3 τ.
/// @throws UsageError when the scenario has no such robot.
FilterSpec filter_spec(const scenario::Scenario& scenario, const std::string& robot);

/// What one step works on. Pointers must be valid during the call only.
struct StepInput {
  Time time{};                                 ///< t; later than that of the step before
  std::optional<models::Viewpoint> viewpoint;  ///< own, at t; absent: as in the step before
  /// Own and teammates' looks, of any instants ≤ t; those of a robot that is not in
  /// FilterSpec::team count as own.
  std::span<const models::DetectionSet* const> looks;
  std::span<const models::RobotBelief* const> beliefs;  ///< newest of each teammate, one each
};

/// Everything that was dropped or could not be done, since construction.
struct FilterCounters {
  std::int64_t steps_out_of_order = 0;     ///< not later than the step before: ignored
  std::int64_t stale_beliefs = 0;          ///< older than belief_age_max_s
  std::int64_t future_beliefs = 0;         ///< of an instant after t
  std::int64_t out_of_range_beliefs = 0;   ///< teammate beyond communication_range_m
  std::int64_t out_of_range_looks = 0;     ///< the same of a teammate's look
  std::int64_t repeated_looks = 0;         ///< of a robot and an instant that is there already
  std::int64_t malformed_beliefs = 0;      ///< a target's block has the wrong dimension
  std::int64_t grid_mismatches = 0;        ///< a teammate's grid has another geometry
  std::int64_t late_measurements = 0;      ///< older than the step before, put in their place
  std::int64_t too_late_measurements = 0;  ///< older than the history: dropped
  std::int64_t future_measurements = 0;    ///< of an instant after t: dropped
  std::int64_t jammed_looks = 0;
  std::int64_t malformed_detections = 0;  ///< wrong dimension, or the second of one target
  std::int64_t surplus_detections = 0;    ///< of a look without ids: more than there is room for
  std::int64_t gated = 0;
  std::int64_t unknown_ids = 0;        ///< target ids nobody announced
  std::int64_t undiscoverable = 0;     ///< seen first by a sensor that cannot tell where
  std::int64_t singular = 0;           ///< a matrix that could not be inverted
  std::int64_t missed_detections = 0;  ///< looks that moved a belief by finding nothing
  Reconciled reconciled;               ///< of tracks without ids

  /// The non-zero ones that tell of trouble, by name: all but out_of_range_beliefs,
  /// out_of_range_looks, missed_detections and reconciled, which are the ordinary course of a
  /// trial.
  [[nodiscard]] std::vector<models::NamedCount> named() const;
};

/// One robot's share of the team's information filter.
///
/// The team's looks travel as they are, and a robot takes those of teammates within communication
/// range for its own: what is measured is used by everyone once, and where all hear all, each robot
/// is the central filter. What a look that was not heard has told arrives in its maker's belief.
///
/// step(t): fuse own tracks with every belief heard of the step before's instant, per target,
///   Ω ← (1 − κ) Ω + κ Σ_j w_j Ω_j / Σ_j w_j,  ω likewise,  w_j = √det Ω_j,
/// over those who know it, κ in [0, 1] such that det Ω is largest (covariance intersection): 0
/// where the others know nothing that is not known already; a target we do not know is taken
/// whole. Then bring all to t, so that walls and meetings happen to what was heard as well, and add
/// the measurements of t. A belief heard of later than the step before is fused in the same way at
/// t. Looks of instants between two steps are used at their own time, before the fusion of the
/// later step. A late look is put in its place by doing the steps
/// from there on again, with what was heard then: the result is that of timely arrival. Where a
/// target was expected and not reported, see missed_detection; that targets keep to the free world,
/// see confine. With gate_sigma, a detection that is not where its target may be is not used but
/// doubted (see doubt()), where its sensor can tell where that is: a swapped or false id moves
/// nothing, and what did the unforeseen, or was founded by a false id, is followed from the next
/// detection that says the same.
///
/// A convex combination of conservative beliefs is conservative whatever they have in common, and
/// no look is added to what holds it already: looks of t come after the fusion only where no belief
/// of t is in it, and a look of a robot and instant that is there is not used again. So nothing is
/// counted twice whatever the network repeats, reorders or loses. Covariances of targets that
/// nobody sees grow to a damped oscillator's surroundings; with other models until the world's
/// bounds confine them, or without end where targets_stay_inside is off.
///
/// Where sensors tell no ids (FilterSpec::detection), looks travel, are filed and are put in their
/// place all the same, but a MultiTargetFilter uses them, and tracks go by labels
/// (track_labels.hpp) from kTrackLabelMin on. Robots that have used the same looks have the same
/// tracks, to the last bit. A teammate's belief of the step before, or of this one, is reconciled
/// with the own tracks of its instant; an older one is not used. rebase() knows of each track what
/// the belief tells, one Gaussian: what follows is not what the filter that made it would have gone
/// on to.
///
/// With EstimatorSpec::samples, what a wall, another target (Meetings) or an empty look leaves of a
/// target with a velocity is told by Samples from there on, until a detection, or the belief of a
/// teammate who knows of a newer one, makes it a Gaussian again. belief() has their moments,
/// mixture() tells them in parts. They are not in a belief: after rebase() as of tracks without
/// ids.
///
/// In a neighbourhood, a belief is all that is known: what lies beyond is not told, and not kept
/// either, so that another filter can go on from any of the beliefs (rebase()).
///
/// A value: copies are independent. Pure: same inputs, same result.
/// Source: dissertation 3.3, 3.4, Thm 9; covariance intersection: Julier, Uhlmann (1997).
class DistributedFilter {
 public:
  /// @throws UsageError for a spec that makes no sense.
  explicit DistributedFilter(FilterSpec spec);

  /// advance(), then belief().
  models::RobotBelief step(const StepInput& input);
  /// The arithmetic of one step. Allocates nothing, but for more than four looks and one of each
  /// teammate, or 64 teammates, in one step, for more detections in them than StepRecord has room
  /// for, for teammates' grids, and for obstacles near a look.
  void advance(const StepInput& input);
  /// What of it is no Gaussian, in several each: content of MIXTURE_R, the same being the caller's.
  /// Of targets whose samples are in one part nothing; of tracks without ids, all that are told.
  [[nodiscard]] models::BeliefMixture mixture() const;
  /// What is known now: content of BELIEF_R; run id, sequence, step and inputs are the caller's.
  [[nodiscard]] models::RobotBelief belief() const;
  /// Continues from `belief` as if this filter had made it; forgets the history of steps. Also
  /// how a prior is set.
  void rebase(const models::RobotBelief& belief);

  /// A copy, because it moves when another target is discovered.
  [[nodiscard]] Track track(int target_id) const {
    const KnownTrack* known = tracks_.find(target_id);
    return known == nullptr ? Track{} : known->track;
  }
  /// Of sensors that tell no ids; else none.
  [[nodiscard]] const std::vector<LabelledTrack>& labelled_tracks() const { return labelled_; }
  [[nodiscard]] const models::VisibilityGrid& grid() const { return grid_; }
  [[nodiscard]] const FilterCounters& counters() const { return counters_; }
  [[nodiscard]] const FilterSpec& spec() const { return spec_; }

 private:
  void listen(const StepInput& input, StepRecord& record);
  /// What of it keeps to where targets can be; nullopt where nothing definite is left.
  [[nodiscard]] std::optional<models::Information> kept_inside(
      const models::Information& information) const;
  void hear(const models::RobotBelief& belief, StepRecord& record);
  /// The same where sensors tell no ids.
  void hear_labels(const models::RobotBelief& belief, StepRecord& record);
  void merge_grid(const models::RobotBelief& belief);
  /// Index of a look's maker in spec_.team, −1 when it is not there.
  [[nodiscard]] int looker_of(const models::DetectionSet& look) const;
  [[nodiscard]] const models::SensorModel& sensor_of(int looker) const;
  [[nodiscard]] const models::DetectionModel& detection_of(int looker) const;
  [[nodiscard]] bool is_self(int looker) const;
  /// Files a look under the step it belongs to; that step's age in records, −1 if dropped.
  int file(const models::DetectionSet& look, Time now);
  void run(StepRecord& record);
  void rebase_tracks(const models::RobotBelief& belief);
  /// Whether what no Gaussian tells is told by samples.
  [[nodiscard]] bool takes_samples() const;
  /// Whether targets are discs that turn each other back.
  [[nodiscard]] bool can_meet() const;
  void propagate_all(Time from, Time to);
  void apply(Look& look);
  void look_for_misses(const Look& look, FilterCounters& count);
  void fuse(const HeardTable& all_heard);
  /// With what was heard of instant `at`, which the labelled tracks are of.
  void reconcile_labels(const StepRecord& record, Time at);
  /// Lets go of tracks of which nothing is known any more.
  void drop_unknown();
  void confine_all();
  /// Forgets targets beyond the neighbourhood of `place_m`.
  void forget_far(const Eigen::Vector2d& place_m);
  /// Moves the grid to where the robot is.
  void move_grid();
  StepRecord& record(int age);

  FilterSpec spec_;
  models::World room_;        ///< where the middles of targets can be
  std::optional<Time> time_;  ///< of tracks_; absent before the first step
  models::Viewpoint viewpoint_;
  int degree_ = 0;
  TrackTable tracks_;
  Meetings meetings_;
  std::optional<MultiTargetFilter> multi_target_;  ///< of sensors that tell no ids
  std::vector<LabelledTrack> labelled_;            ///< then instead of tracks_
  std::vector<HeardLabel> heard_labels_;           ///< scratch of reconcile_labels()
  models::VisibilityGrid grid_;
  std::vector<StepRecord> records_;  ///< ring
  int newest_ = 0;
  int recorded_ = 0;
  std::unordered_map<std::string, int> lookers_;      ///< indices into spec_.team
  std::vector<const models::RobotBelief*> in_range_;  ///< scratch of listen()
  FilterCounters counters_;
};

}  // namespace vantage::estimator
