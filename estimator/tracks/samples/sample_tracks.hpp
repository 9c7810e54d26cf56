#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "estimator/tracks/gaussian/gaussian_tracks.hpp"
#include "estimator/tracks/samples/target_collisions.hpp"

namespace vantage::estimator {

/// Store of targets with ids and a velocity. A target is represented by samples after its belief
/// was changed by a wall, a collision with another target or a missed detection. A detection, or
/// the belief of a teammate with a newer detection, makes it a Gaussian again. The Gaussian of a
/// track with samples has the moments of the samples.
class SampleTracks : public GaussianTracks {
 public:
  explicit SampleTracks(const FilterSpec& spec);
  [[nodiscard]] std::unique_ptr<TrackStore> clone() const override;

  void save(int slot) override;
  void restore(int slot) override;
  void propagate(Time from, Time to, FilterCounters& count) override;
  void forget_far(const Eigen::Vector2d& position_m) override;
  /// A target is omitted if its samples form only one part.
  [[nodiscard]] std::vector<models::TargetMixture> mixtures() const override;
  void rebase(std::span<const models::TargetBelief> targets, FilterCounters& count) override;

 protected:
  void predict_track(KnownTrack& known, Time from, Time to, FilterCounters& count) override;
  void confine_track(KnownTrack& known, FilterCounters& count) override;
  bool measure_track(KnownTrack& known, const Observation& observation,
                     const models::SensorModel& sensor, const models::Measurement& measurement,
                     FilterCounters& count) override;
  void miss_track(KnownTrack& known, const Observation& observation,
                  const models::SensorModel& sensor, double detection_probability,
                  FilterCounters& count) override;
  bool fuse_track(KnownTrack& known, const Track& received) override;

 private:
  /// Returns the samples of a track. A track without samples gets samples of its Gaussian if
  /// `change` would change the Gaussian; otherwise the result is null.
  template <class Change>
  Samples* samples_changed_by(const KnownTrack& known, const Change& change);
  /// Represents the target by its Gaussian.
  void drop_samples(int target_id);

  SampleTable samples_;
  std::vector<SampleTable> history_;
  TargetCollisions collisions_;
};

}  // namespace vantage::estimator
