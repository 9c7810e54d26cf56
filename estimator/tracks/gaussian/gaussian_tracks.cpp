#include "estimator/tracks/gaussian/gaussian_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

#include "estimator/posterior/confinement.hpp"
#include "estimator/posterior/missed_detection.hpp"

namespace vantage::estimator {
namespace {

/// Returns √det Ω, the weight of a belief in a fusion; 0 when Ω is not positive definite.
double weight_of(const models::StateMatrix& Omega) {
  const Eigen::LLT<models::StateMatrix> root(Omega);
  return root.info() == Eigen::Success ? root.matrixLLT().diagonal().prod() : 0.0;
}

/// Returns the κ in [0, 1] that maximises det((1 − κ) A + κ B). log det is concave in κ, so its
/// slope tr((B − A) Ω⁻¹) decreases. Bisection finds the zero of the slope to 1/4096.
double intersection_weight(const models::StateMatrix& A, const models::StateMatrix& B) {
  const models::StateMatrix D = B - A;
  const auto is_rising = [&](double kappa) {
    const Eigen::LLT<models::StateMatrix> root(A + kappa * D);
    return root.info() == Eigen::Success && root.solve(D).trace() > 0.0;
  };
  if (!is_rising(0.0)) {
    return 0.0;
  }
  if (is_rising(1.0)) {
    return 1.0;
  }
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (low + high);
    (is_rising(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Largest position σ with which a target becomes a track, as a share of the sensor's range.
constexpr double kLocatedShare = 0.5;

/// Returns the maximum number of pending targets: 0 if one detection by any robot determines the
/// position of a target.
int pending_max(const FilterSpec& spec) {
  const bool all_locate =
      can_discover(spec.sensor) &&
      std::all_of(spec.team.begin(), spec.team.end(),
                  [](const ObservationSource& source) { return can_discover(source.sensor); });
  return all_locate ? 0 : spec.target_count;
}

bool is_reported(const Observation& observation, int target_id) {
  return std::any_of(observation.detections.begin(), observation.detections.end(),
                     [&](const auto& detection) { return detection.target_id == target_id; });
}

/// Adds a belief to the weighted sum of the beliefs received about its target.
void add_weighted(ReceivedTable& all_received, const models::TargetBelief& target,
                  const models::Information& now, double weight) {
  ReceivedTrack* const received = all_received.find(target.target_id);
  if (received == nullptr) {
    all_received.put({target.target_id,
                      {true, {weight * now.vector, weight * now.matrix}, target.last_seen},
                      weight});
  } else {
    received->track.information.vector += weight * now.vector;
    received->track.information.matrix += weight * now.matrix;
    received->track.last_seen = std::max(received->track.last_seen, target.last_seen);
    received->weight += weight;
  }
}

}  // namespace

GaussianTracks::GaussianTracks(const FilterSpec& spec)
    : spec_(spec),
      free_space_(inset(spec.world, spec.target_radius_m)),
      tracks_(spec.target_count),
      pending_(pending_max(spec)),
      history_(static_cast<std::size_t>(spec.history_steps)) {
  for (Record& each : history_) {  // a copied table has no reserved capacity
    each.before = TrackTable(spec.target_count);
    each.pending = PendingTable(pending_max(spec));
    each.received_at_start = ReceivedTable(spec.target_count);
    each.received_at_end = ReceivedTable(spec.target_count);
  }
}

std::unique_ptr<TrackStore> GaussianTracks::clone() const {
  return std::make_unique<GaussianTracks>(*this);
}

void GaussianTracks::file(const models::Detection& detection, bool has_right_dimension,
                          Observation& observation, FilterCounters& count) const {
  const bool twice =
      std::any_of(observation.detections.begin(), observation.detections.end(),
                  [&](const auto& other) { return other.target_id == detection.target_id; });
  if (detection.target_id < 0 || detection.target_id >= spec_.target_count) {
    ++count.unknown_ids;
  } else if (twice || !has_right_dimension) {
    ++count.malformed_detections;
  } else {
    observation.detections.push_back(detection);
  }
}

void GaussianTracks::start(const Step& step) {
  record(step.slot).received_at_start.clear();
  record(step.slot).received_at_end.clear();
  record(step.slot).has_belief_of_end = false;
}

void GaussianTracks::save(int slot) {
  record(slot).before = tracks_;
  record(slot).pending = pending_;
}

void GaussianTracks::restore(int slot) {
  tracks_ = record(slot).before;
  pending_ = record(slot).pending;
}

void GaussianTracks::add_track(int target_id, const Track& track) {
  tracks_.put({target_id, track});
  pending_.erase_if([&](const PendingTarget& each) { return each.target_id == target_id; });
}

std::optional<models::Information> GaussianTracks::kept_inside(
    const models::Information& information) const {
  const auto belief = models::to_gaussian(information);
  if (!spec_.estimator.targets_stay_inside || !belief) {
    return information;
  }
  const models::Gaussian inside = estimator::confine(*belief, free_space_);
  return is_same(inside, *belief) ? information : models::to_information(inside);
}

std::optional<models::Information> GaussianTracks::predicted(const models::TargetBelief& target,
                                                             Time at, Time now) const {
  const auto later = estimator::propagate(spec_.estimator.target_model, spec_.step_s,
                                          target.information, target.last_seen, at, now);
  // Without kept_inside(), a belief predicted into a wall would be too confident.
  return later && at < now ? kept_inside(*later) : later;
}

void GaussianTracks::receive(const models::RobotBelief& belief, const Step& step,
                             FilterCounters& count) {
  Record& record = this->record(step.slot);
  record.has_belief_of_end = record.has_belief_of_end || belief.stamp.time == step.to;
  // In the first step, beliefs are fused at the end of the step: there are no tracks at its start,
  // and the belief may contain observations made since then.
  const bool is_of_start = !step.is_first && belief.stamp.time <= step.from;
  const int dim = spec_.estimator.target_model.dim();
  for (const models::TargetBelief& target : belief.targets) {
    if (target.target_id < 0 || target.target_id >= spec_.target_count) {
      ++count.unknown_ids;
      continue;
    }
    if (target.information.vector.size() != dim || target.information.matrix.rows() != dim ||
        target.information.matrix.cols() != dim) {
      ++count.malformed_beliefs;
      continue;
    }
    const auto now = predicted(target, belief.stamp.time, is_of_start ? step.from : step.to);
    const double weight = now ? weight_of(now->matrix) : 0.0;
    if (!(weight > 0.0) || !std::isfinite(weight)) {
      ++count.singular;
      continue;
    }
    add_weighted(is_of_start ? record.received_at_start : record.received_at_end, target, *now,
                 weight);
  }
}

void GaussianTracks::fuse(const Step& step, FusionPoint point, FilterCounters& /*count*/) {
  const Record& record = this->record(step.slot);
  // A belief that belongs to instant `to` contains the observations made at `to`.
  const FusionPoint end = record.has_belief_of_end ? FusionPoint::kFinish : FusionPoint::kEnd;
  if (point == FusionPoint::kStart) {
    fuse_all(record.received_at_start);
  } else if (point == end) {
    fuse_all(record.received_at_end);
  }
}

void GaussianTracks::fuse_all(const ReceivedTable& all_received) {
  for (const auto& [target_id, received, weight] : all_received) {
    const Track theirs{true,
                       {received.information.vector / weight, received.information.matrix / weight},
                       received.last_seen};
    if (KnownTrack* const known = tracks_.find(target_id)) {
      fuse_track(*known, theirs);
    } else {
      add_track(target_id, theirs);
    }
  }
}

bool GaussianTracks::fuse_track(KnownTrack& known, const Track& received) {
  Track& own = known.track;
  if (received.last_seen < own.doubted) {
    return false;  // the belief is older than the doubted detection; it would undo doubt()
  }
  const models::Information& theirs = received.information;
  const double kappa = intersection_weight(own.information.matrix, theirs.matrix);
  if (!(kappa > 0.0)) {
    return false;
  }
  own.information = models::Information{
      own.information.vector + kappa * (theirs.vector - own.information.vector),
      own.information.matrix + kappa * (theirs.matrix - own.information.matrix)};
  own.last_seen = std::max(own.last_seen, received.last_seen);
  return true;
}

bool GaussianTracks::set_belief(KnownTrack& known, const models::Gaussian& belief,
                                FilterCounters& count) {
  const auto information = models::to_information(belief);
  if (information) {
    known.track.information = *information;
  } else {
    ++count.singular;
  }
  return information.has_value();
}

void GaussianTracks::mark_detected(Track& track, Time time) {
  track.last_seen = std::max(track.last_seen, time);
  track.doubted = {};
}

void GaussianTracks::propagate(Time from, Time to, FilterCounters& count) {
  for (KnownTrack& each : tracks_) {
    predict_track(each, from, to, count);
  }
  tracks_.erase_if([](const KnownTrack& each) { return !each.track.known; });
  for (PendingTarget& each : pending_) {
    if (from < to) {
      each.hypotheses.predict(spec_.estimator.target_model, to_seconds(to - from));
    }
  }
}

void GaussianTracks::predict_track(KnownTrack& known, Time from, Time to, FilterCounters& count) {
  Track& track = known.track;
  const auto later = estimator::propagate(spec_.estimator.target_model, spec_.step_s,
                                          track.information, track.last_seen, from, to);
  if (later) {
    track.information = *later;
  } else {  // drop the track; the next detection discovers it again
    ++count.singular;
    track.known = false;
  }
}

void GaussianTracks::confine(FilterCounters& count) {
  for (KnownTrack& each : tracks_) {
    confine_track(each, count);
  }
  for (PendingTarget& each : pending_) {
    each.hypotheses.confine(free_space_);
  }
}

std::optional<models::Information> GaussianTracks::locate(int target_id,
                                                          const Observation& observation,
                                                          const models::SensorModel& sensor,
                                                          const models::Measurement& measurement) {
  PendingTarget* pending = pending_.find(target_id);
  const bool is_used =
      pending != nullptr && pending->hypotheses.measure(sensor, observation.from, measurement);
  if (!is_used) {  // the first detection, or one that contradicts the earlier ones
    PendingTarget begun{target_id, {}};
    if (!begun.hypotheses.start(spec_.estimator, free_space_, sensor, observation.from,
                                measurement)) {
      return std::nullopt;
    }
    pending = &pending_.put(begun);
  }
  const auto located = pending->hypotheses.located(kLocatedShare * sensor.range_max_m);
  return located ? models::to_information(*located) : std::nullopt;
}

void GaussianTracks::miss_pending(const Observation& observation, const models::SensorModel& sensor,
                                  double detection_probability) {
  for (PendingTarget& each : pending_) {
    if (!is_reported(observation, each.target_id)) {
      each.hypotheses.miss(spec_.world, sensor, observation.from, detection_probability);
    }
  }
}

void GaussianTracks::confine_track(KnownTrack& known, FilterCounters& count) {
  const auto belief = models::to_gaussian(known.track.information);
  if (!belief) {
    return;
  }
  const models::Gaussian inside = estimator::confine(*belief, free_space_);
  if (!is_same(inside, *belief)) {
    set_belief(known, inside, count);
  }
}

void GaussianTracks::use(const Observation& observation, const ObservationSource& source,
                         FilterCounters& count) {
  const scenario::EstimatorSpec& spec = spec_.estimator;
  const std::vector<models::Detection>& detections = observation.detections;
  for (const auto& [target_id, measurement] : detections) {
    if (KnownTrack* const known = tracks_.find(target_id)) {
      measure_track(*known, observation, source.sensor, measurement, count);
    } else if (const auto found = discover(spec, source.sensor, observation.from, measurement)) {
      add_track(target_id, {true, *found, observation.time});
    } else if (const auto located = locate(target_id, observation, source.sensor, measurement)) {
      add_track(target_id, {true, *located, observation.time});
    } else if (pending_.find(target_id) == nullptr) {
      ++count.undiscoverable;
    }
  }
  const double detection_probability =
      std::min(spec.detection_probability, source.detection.detection_probability);
  if (detection_probability <= 0.0) {
    return;
  }
  for (KnownTrack& each : tracks_) {
    if (!is_reported(observation, each.target_id)) {
      miss_track(each, observation, source.sensor, detection_probability, count);
    }
  }
  miss_pending(observation, source.sensor, detection_probability);
}

bool GaussianTracks::measure_track(KnownTrack& known, const Observation& observation,
                                   const models::SensorModel& sensor,
                                   const models::Measurement& measurement, FilterCounters& count) {
  Track& track = known.track;
  const double gate_sigma = can_discover(sensor) ? spec_.estimator.gate_sigma : 0.0;
  switch (measure(track.information, sensor, observation.from, measurement, gate_sigma)) {
    case Use::kUsed:
      mark_detected(track, observation.time);
      return true;
    case Use::kGated:
      ++count.gated;
      return doubt(track, spec_.estimator, sensor, observation.from, measurement, observation.time);
    case Use::kSingular:
      ++count.singular;
      return false;
  }
  return false;
}

void GaussianTracks::miss_track(KnownTrack& known, const Observation& observation,
                                const models::SensorModel& sensor, double detection_probability,
                                FilterCounters& count) {
  const auto belief = models::to_gaussian(known.track.information);
  if (!belief) {
    return;
  }
  const models::Gaussian missed =
      missed_detection(*belief, sensor, observation.from, spec_.world, detection_probability);
  if (!is_same(missed, *belief)) {
    count.missed_detections += set_belief(known, missed, count) ? 1 : 0;
  }
}

void GaussianTracks::forget_far(const Eigen::Vector2d& position_m) {
  tracks_.erase_if([&](const KnownTrack& each) {
    const auto belief = models::to_gaussian(each.track.information);
    return !belief || (belief->mean.head<2>() - position_m).norm() > spec_.neighbourhood_m;
  });
}

std::vector<models::TargetBelief> GaussianTracks::beliefs() const {
  std::vector<models::TargetBelief> all;
  for (const auto& [target_id, track] : tracks_) {
    all.push_back({target_id, track.information, track.last_seen});
  }
  return all;
}

void GaussianTracks::rebase(std::span<const models::TargetBelief> targets, FilterCounters& count) {
  tracks_.clear();
  pending_.clear();
  for (const models::TargetBelief& target : targets) {
    if (target.target_id < 0 || target.target_id >= spec_.target_count) {
      ++count.unknown_ids;
    } else if (target.information.vector.size() != spec_.estimator.target_model.dim()) {
      ++count.malformed_beliefs;
    } else {
      tracks_.put({target.target_id, {true, target.information, target.last_seen}});
    }
  }
}

const Track* GaussianTracks::find(int target_id) const {
  const KnownTrack* const known = tracks_.find(target_id);
  return known == nullptr ? nullptr : &known->track;
}

}  // namespace vantage::estimator
