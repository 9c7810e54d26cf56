#include "estimator/tracks/samples/target_collisions.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "models/belief/gaussian.hpp"

namespace vantage::estimator {
namespace {

/// The probability that a target is farther than this from its mean, in σ, is neglected.
constexpr double kReach_sigma = 4.0;

/// Returns kReach_sigma times the larger σ of the coordinates `first` and `first` + 1.
double reach_of(const models::Gaussian& belief, Eigen::Index first) {
  return kReach_sigma * std::sqrt(belief.covariance.diagonal().segment<2>(first).maxCoeff());
}

}  // namespace

TargetCollisions::TargetCollisions(int target_count, double distance_m) : distance_m_(distance_m) {
  discs_.reserve(
      std::min(static_cast<std::size_t>(std::max(0, target_count)), TrackTable::kReserved));
}

bool TargetCollisions::may_collide(const Disc& one, const Disc& other) const {
  const double reach_m = one.radius_m + other.radius_m + distance_m_;
  return reach_m > 0.0 && (one.centre_m - other.centre_m).squaredNorm() < reach_m * reach_m;
}

void TargetCollisions::apply(const TrackTable& tracks, SampleTable& sampled, double dt_s,
                             std::uint64_t key) {
  discs_.clear();
  for (const KnownTrack& each : tracks) {
    Disc& disc = discs_.emplace_back();
    disc.target_id = each.target_id;
    const auto belief = models::to_gaussian(each.track.information);
    if (!belief) {
      disc.radius_m = -std::numeric_limits<double>::infinity();  // no other target is near
      continue;
    }
    const double speed_max_mps = belief->mean.segment<2>(2).norm() + reach_of(*belief, 2);
    disc.centre_m = belief->mean.head<2>();
    disc.radius_m = reach_of(*belief, 0) + speed_max_mps * dt_s;
  }
  const auto samples_of = [&](std::size_t i) -> Samples& {
    Samples& samples = discs_[i].samples;
    if (samples.empty()) {
      if (const SampledTarget* const known = sampled.find(discs_[i].target_id)) {
        samples = known->samples;
      } else {
        const KnownTrack& track = *(tracks.begin() + static_cast<std::ptrdiff_t>(i));
        samples.spread(*models::to_gaussian(track.track.information));
      }
    }
    return samples;
  };
  for (std::size_t i = 0; i < discs_.size(); ++i) {
    for (std::size_t j = i + 1; j < discs_.size(); ++j) {
      Disc& one = discs_[i];
      Disc& other = discs_[j];
      if (!may_collide(one, other) || samples_of(i).empty() || samples_of(j).empty()) {
        continue;
      }
      const std::uint64_t pair = (static_cast<std::uint64_t>(one.target_id) << 32U) +
                                 static_cast<std::uint64_t>(other.target_id);
      const std::uint64_t pair_key = key ^ (pair << 8U);
      const Samples before = one.samples;
      one.has_collided |= one.samples.collide_with(other.samples, distance_m_, dt_s, pair_key);
      other.has_collided |= other.samples.collide_with(before, distance_m_, dt_s, ~pair_key);
    }
  }
  for (const Disc& disc : discs_) {
    if (disc.has_collided) {
      sampled.put({disc.target_id, disc.samples});
    }
  }
}

}  // namespace vantage::estimator
