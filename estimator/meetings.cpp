#include "estimator/meetings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "models/belief/gaussian.hpp"

namespace vantage::estimator {
namespace {

/// Farther than so many σ from its mean a target is not looked for.
constexpr double kReach_sigma = 4.0;

/// The greatest of two coordinates' σ, times kReach_sigma.
double reach_of(const models::Gaussian& belief, Eigen::Index first) {
  return kReach_sigma * std::sqrt(belief.covariance.diagonal().segment<2>(first).maxCoeff());
}

}  // namespace

Meetings::Meetings(int target_count, double distance_m) : distance_m_(distance_m) {
  parties_.reserve(
      std::min(static_cast<std::size_t>(std::max(0, target_count)), TrackTable::kReserved));
}

bool Meetings::may_meet(const Party& one, const Party& other) const {
  const double reach_m = one.radius_m + other.radius_m + distance_m_;
  return !one.samples.empty() && !other.samples.empty() &&
         (one.centre_m - other.centre_m).squaredNorm() < reach_m * reach_m;
}

void Meetings::let_meet(TrackTable& tracks, double dt_s, std::uint64_t key) {
  parties_.clear();
  for (const KnownTrack& each : tracks) {
    Party& party = parties_.emplace_back();
    party.target_id = each.target_id;
    const auto belief = models::to_gaussian(each.track.information);
    if (!belief) {
      continue;
    }
    const double speed_max_mps = belief->mean.segment<2>(2).norm() + reach_of(*belief, 2);
    party.centre_m = belief->mean.head<2>();
    party.radius_m = reach_of(*belief, 0) + speed_max_mps * dt_s;
    party.samples = each.samples;
    if (party.samples.empty()) {
      party.samples.spread(*belief);
    }
  }
  for (std::size_t i = 0; i < parties_.size(); ++i) {
    for (std::size_t j = i + 1; j < parties_.size(); ++j) {
      Party& one = parties_[i];
      Party& other = parties_[j];
      const auto pair = (static_cast<std::uint64_t>(one.target_id) << 32U) +
                        static_cast<std::uint64_t>(other.target_id);
      if (may_meet(one, other) &&
          meet(one.samples, other.samples, distance_m_, dt_s, key ^ (pair << 8U))) {
        one.has_met = other.has_met = true;
      }
    }
  }
  auto party = parties_.begin();
  for (KnownTrack& each : tracks) {
    if (party->has_met) {
      each.samples = party->samples;
    }
    ++party;
  }
}

}  // namespace vantage::estimator
