#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "estimator/tracks/gaussian/track_table.hpp"
#include "estimator/tracks/samples/samples.hpp"

namespace vantage::estimator {

/// A target that is represented by samples; `samples` is not empty.
struct SampledTarget {
  int target_id = 0;
  Samples samples = {};
};
using SampleTable = TargetTable<SampledTarget>;

/// Collisions between targets. Targets are discs that cannot overlap; a target that walks into
/// another one turns back. Where beliefs allow a collision, samples represent the result, which is
/// not Gaussian (docs/decisions/0024).
///
/// The members are scratch only. Nothing is allocated for up to TrackTable::kReserved targets.
class TargetCollisions {
 public:
  /// Reserves storage for `target_count` targets. Their centres are at least `distance_m` apart.
  TargetCollisions(int target_count, double distance_m);

  /// Applies the collisions of the next dt_s. If a sample of a track collides with another track's
  /// sample, the track has an entry in `sampled` afterwards. The samples are moved such that a
  /// prediction by dt_s gives their states after the collision. `key` selects which sample is
  /// paired with which; the same key and targets give the same pairs.
  /// Precondition: a model with a velocity.
  void apply(const TrackTable& tracks, SampleTable& sampled, double dt_s, std::uint64_t key);

 private:
  /// A target, with a disc that the target leaves within dt_s only with negligible probability.
  struct Disc {
    int target_id = 0;
    Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
    double radius_m = 0.0;
    bool has_collided = false;
    Samples samples = {};  ///< only if another target is near; empty for a singular belief
  };
  [[nodiscard]] bool may_collide(const Disc& one, const Disc& other) const;

  double distance_m_;
  std::vector<Disc> discs_;
};

}  // namespace vantage::estimator
