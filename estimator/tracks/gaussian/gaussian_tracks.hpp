#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "estimator/tracks/gaussian/position_hypotheses.hpp"
#include "estimator/tracks/gaussian/track_table.hpp"
#include "estimator/tracks/track_store.hpp"

namespace vantage::estimator {

/// Store of targets with ids: one Gaussian per target.
///
/// Tracks are kept in information form, because a detection and a fusion then add matrices without
/// an inversion, and a published belief is exactly the track (docs/decisions/0027).
///
/// If one detection does not determine a target's position, for example a single range, the target
/// is not a track until several detections by any robots determine it (PositionHypotheses).
/// rebase() forgets these detections.
class GaussianTracks : public TrackStore {
 public:
  explicit GaussianTracks(const FilterSpec& spec);
  [[nodiscard]] std::unique_ptr<TrackStore> clone() const override;

  [[nodiscard]] int detections_reserved() const override { return spec_.target_count; }
  [[nodiscard]] bool has_one_observation_per_instant() const override { return false; }
  void file(const models::Detection& detection, bool has_right_dimension, Observation& observation,
            FilterCounters& count) const override;

  void start(const Step& step) override;
  void receive(const models::RobotBelief& belief, const Step& step, FilterCounters& count) override;
  void save(int slot) override;
  void restore(int slot) override;

  void fuse(const Step& step, FusionPoint point, FilterCounters& count) override;
  void propagate(Time from, Time to, FilterCounters& count) override;
  void confine(FilterCounters& count) override;
  void use(const Observation& observation, const ObservationSource& source,
           FilterCounters& count) override;
  void forget_far(const Eigen::Vector2d& position_m) override;

  [[nodiscard]] std::vector<models::TargetBelief> beliefs() const override;
  [[nodiscard]] std::vector<models::TargetMixture> mixtures() const override { return {}; }
  void rebase(std::span<const models::TargetBelief> targets, FilterCounters& count) override;
  [[nodiscard]] const Track* find(int target_id) const override;

 protected:
  [[nodiscard]] const FilterSpec& spec() const { return spec_; }
  [[nodiscard]] const models::World& free_space() const { return free_space_; }
  [[nodiscard]] const TrackTable& tracks() const { return tracks_; }
  /// Sets the track's information from `belief`. If the covariance is singular, counts it, changes
  /// nothing and returns false.
  static bool set_belief(KnownTrack& known, const models::Gaussian& belief, FilterCounters& count);
  /// Marks the track as updated by a detection made at `time`.
  static void mark_detected(Track& track, Time time);

  // Operations on one track. measure_track() and fuse_track() return true if they changed it.

  virtual void predict_track(KnownTrack& known, Time from, Time to, FilterCounters& count);
  virtual void confine_track(KnownTrack& known, FilterCounters& count);
  virtual bool measure_track(KnownTrack& known, const Observation& observation,
                             const models::SensorModel& sensor,
                             const models::Measurement& measurement, FilterCounters& count);
  /// Uses an observation that did not report the target.
  virtual void miss_track(KnownTrack& known, const Observation& observation,
                          const models::SensorModel& sensor, double detection_probability,
                          FilterCounters& count);
  virtual bool fuse_track(KnownTrack& known, const Track& received);

 private:
  /// A target whose position the detections so far do not determine.
  struct PendingTarget {
    int target_id = 0;
    PositionHypotheses hypotheses;
  };
  using PendingTable = TargetTable<PendingTarget>;

  /// Beliefs of this robot and of teammates in one step. A received belief is predicted to `from`
  /// if its instant is ≤ `from`, otherwise to `to`.
  struct Record {
    TrackTable before;
    PendingTable pending;
    ReceivedTable received_at_start;
    ReceivedTable received_at_end;
    /// True if a received belief belongs to instant `to`. Such a belief contains the observations
    /// made at `to`.
    bool has_belief_of_end = false;
  };

  [[nodiscard]] Record& record(int slot) { return history_[static_cast<std::size_t>(slot)]; }
  /// Returns a received belief predicted to `now`; nullopt if it is singular.
  [[nodiscard]] std::optional<models::Information> predicted(const models::TargetBelief& target,
                                                             Time at, Time now) const;
  /// Returns the belief conditioned on the free space; nullopt if its covariance is then singular.
  [[nodiscard]] std::optional<models::Information> kept_inside(
      const models::Information& information) const;
  void fuse_all(const ReceivedTable& all_received);
  void add_track(int target_id, const Track& track);
  /// Uses a detection that alone does not determine the target's position. Returns the belief once
  /// all detections so far together determine the position; nullopt before.
  std::optional<models::Information> locate(int target_id, const Observation& observation,
                                            const models::SensorModel& sensor,
                                            const models::Measurement& measurement);
  /// Uses an observation for the pending targets that it did not report.
  void miss_pending(const Observation& observation, const models::SensorModel& sensor,
                    double detection_probability);

  FilterSpec spec_;
  models::World free_space_;  ///< free space of the targets' centres
  TrackTable tracks_;
  PendingTable pending_;
  std::vector<Record> history_;
};

}  // namespace vantage::estimator
