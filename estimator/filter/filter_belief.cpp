#include <utility>

#include "estimator/filter/distributed_filter.hpp"

// Conversion of a filter's estimate to and from messages.

namespace vantage::estimator {
namespace {

/// Largest σ of a part of an unseen target's belief, as a share of the sensor's range. It is so
/// small that one observation decides whether the target is in the part. Determined by experiment
/// (docs/decisions/0025).
constexpr double kPartShare = 0.2;

}  // namespace

models::RobotBelief DistributedFilter::belief() const {
  models::RobotBelief belief;
  belief.stamp.time = time_.value_or(Time{});
  belief.robot = spec_.robot;
  belief.viewpoint = viewpoint_;
  belief.degree = degree_;
  for (const KnownTrack& known : tracks_) {
    belief.targets.push_back({known.target_id, known.track.information, known.track.last_seen});
  }
  if (multi_target_) {
    belief.targets = confirmed_beliefs(*multi_target_, labelled_);
  }
  belief.grid = grid_.geometry();
  belief.last_seen_utime = grid_.last_seen_utime();
  return belief;
}

models::BeliefMixture DistributedFilter::mixture() const {
  models::BeliefMixture mixture;
  mixture.stamp.time = time_.value_or(Time{});
  mixture.robot = spec_.robot;
  const double part_sigma_m = kPartShare * spec_.sensor.range_max_m;
  for (const KnownTrack& known : tracks_) {
    models::Mixture parts =
        known.samples.empty() ? models::Mixture{} : known.samples.parts(part_sigma_m);
    if (parts.size() > 1) {
      mixture.targets.push_back({known.target_id, 1.0, std::move(parts)});
    }
  }
  if (multi_target_) {
    mixture.targets = confirmed_mixtures(*multi_target_, labelled_);
  }
  return mixture;
}

void DistributedFilter::rebase(const models::RobotBelief& belief) {
  recorded_ = 0;
  time_ = belief.stamp.time;
  viewpoint_ = belief.viewpoint;
  degree_ = belief.degree;
  rebase_tracks(belief);
  move_grid();
  if (belief.grid == grid_.geometry() &&
      belief.last_seen_utime.size() == grid_.last_seen_utime().size()) {
    grid_.set_last_seen(belief.last_seen_utime);
  } else if (!belief.last_seen_utime.empty()) {
    ++counters_.grid_mismatches;
  }
}

void DistributedFilter::rebase_tracks(const models::RobotBelief& belief) {
  const int dim = spec_.estimator.target_model.dim();
  tracks_.clear();
  if (multi_target_) {
    set_tracks(labelled_, belief.targets, dim);
    return;
  }
  for (const models::TargetBelief& target : belief.targets) {
    if (target.target_id < 0 || target.target_id >= spec_.target_count) {
      ++counters_.unknown_ids;
    } else if (target.information.vector.size() != dim) {
      ++counters_.malformed_beliefs;
    } else {
      tracks_.put({target.target_id, {true, target.information, target.last_seen}});
    }
  }
}

}  // namespace vantage::estimator
