#include "estimator/tracks/samples/sample_tracks.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/index.hpp"
#include "estimator/posterior/confinement.hpp"
#include "estimator/posterior/missed_detection.hpp"

namespace vantage::estimator {
namespace {

/// Largest σ of a part of an unseen target's belief, as a share of the sensor's range. It is so
/// small that one observation decides whether the target is in the part. Determined by experiment
/// (docs/decisions/0025).
constexpr double kPartShare = 0.2;

/// Returns the key that determines which sample receives which noise. It is the same for all robots
/// and differs between instants.
std::uint64_t noise_key(int target_id, Time at) {
  return (static_cast<std::uint64_t>(to_utime(at)) << 10U) + static_cast<std::uint64_t>(target_id);
}

}  // namespace

SampleTracks::SampleTracks(const FilterSpec& spec)
    : GaussianTracks(spec),
      samples_(spec.target_count),
      history_(index(spec.history_steps)),
      collisions_(spec.target_radius_m > 0.0 ? spec.target_count : 0, 2.0 * spec.target_radius_m) {
  for (SampleTable& each : history_) {  // a copied table has no reserved capacity
    each = SampleTable(spec.target_count);
  }
}

std::unique_ptr<TrackStore> SampleTracks::clone() const {
  return std::make_unique<SampleTracks>(*this);
}

void SampleTracks::save(int slot) {
  GaussianTracks::save(slot);
  history_[index(slot)] = samples_;
}

void SampleTracks::restore(int slot) {
  GaussianTracks::restore(slot);
  samples_ = history_[index(slot)];
}

void SampleTracks::propagate(Time from, Time to, FilterCounters& count) {
  if (spec().target_radius_m > 0.0 && from < to) {
    collisions_.apply(tracks(), samples_, to_seconds(to - from), noise_key(0, to));
  }
  GaussianTracks::propagate(from, to, count);
}

void SampleTracks::predict_track(KnownTrack& known, Time from, Time to, FilterCounters& count) {
  SampledTarget* const sampled = from < to ? samples_.find(known.target_id) : nullptr;
  if (sampled == nullptr) {
    GaussianTracks::predict_track(known, from, to, count);
    return;
  }
  sampled->samples.predict(spec().estimator.target_model, to_seconds(to - from),
                           noise_key(known.target_id, to));
  set_belief(known, sampled->samples.moments(), count);
}

template <class Change>
Samples* SampleTracks::samples_changed_by(const KnownTrack& known, const Change& change) {
  if (SampledTarget* const sampled = samples_.find(known.target_id)) {
    return &sampled->samples;
  }
  const auto belief = models::to_gaussian(known.track.information);
  if (!belief || is_same(change(*belief), *belief)) {
    return nullptr;
  }
  Samples samples;
  samples.spread(*belief);
  return samples.empty() ? nullptr : &samples_.put({known.target_id, samples}).samples;
}

void SampleTracks::confine_track(KnownTrack& known, FilterCounters& count) {
  Samples* const samples = samples_changed_by(known, [&](const models::Gaussian& belief) {
    return estimator::confine(belief, free_space());
  });
  if (samples != nullptr) {
    samples->turn_back(free_space().bounds);
    samples->keep_out_of(free_space().obstacles);
    set_belief(known, samples->moments(), count);
  }
}

bool SampleTracks::measure_track(KnownTrack& known, const Observation& observation,
                                 const models::SensorModel& sensor,
                                 const models::Measurement& measurement, FilterCounters& count) {
  SampledTarget* const sampled = samples_.find(known.target_id);
  const double gate_sigma = can_discover(sensor) ? spec().estimator.gate_sigma : 0.0;
  if (sampled != nullptr &&
      sampled->samples.measure(sensor, observation.from, measurement, gate_sigma)) {
    set_belief(known, sampled->samples.moments(), count);
    mark_detected(known.track, observation.time);
  } else if (!GaussianTracks::measure_track(known, observation, sensor, measurement, count)) {
    return false;
  }
  drop_samples(known.target_id);
  return true;
}

void SampleTracks::miss_track(KnownTrack& known, const Observation& observation,
                              const models::SensorModel& sensor, double detection_probability,
                              FilterCounters& count) {
  const models::World& world = spec().world;
  Samples* const samples = samples_changed_by(known, [&](const models::Gaussian& belief) {
    return missed_detection(belief, sensor, observation.from, world, detection_probability);
  });
  if (samples != nullptr && samples->miss(sensor, observation.from, world, detection_probability)) {
    count.missed_detections += set_belief(known, samples->moments(), count) ? 1 : 0;
  }
}

bool SampleTracks::fuse_track(KnownTrack& known, const Track& received) {
  // Without a newer detection, the teammates' beliefs differ only in missed detections. Beliefs
  // contain only moments; if moments differ, the more confident ones are more likely to be wrong.
  const bool has_samples = samples_.find(known.target_id) != nullptr;
  if (has_samples && received.last_seen <= known.track.last_seen) {
    return false;
  }
  const bool is_changed = GaussianTracks::fuse_track(known, received);
  if (is_changed) {
    drop_samples(known.target_id);
  }
  return is_changed;
}

void SampleTracks::drop_samples(int target_id) {
  samples_.erase_if([&](const SampledTarget& each) { return each.target_id == target_id; });
}

void SampleTracks::forget_far(const Eigen::Vector2d& position_m) {
  GaussianTracks::forget_far(position_m);
  samples_.erase_if(
      [&](const SampledTarget& each) { return tracks().find(each.target_id) == nullptr; });
}

std::vector<models::TargetMixture> SampleTracks::mixtures() const {
  std::vector<models::TargetMixture> all;
  for (const auto& [target_id, samples] : samples_) {
    models::Mixture parts = samples.parts(kPartShare * spec().sensor.range_max_m);
    if (parts.size() > 1) {
      all.push_back({target_id, 1.0, std::move(parts)});
    }
  }
  return all;
}

void SampleTracks::rebase(std::span<const models::TargetBelief> targets, FilterCounters& count) {
  GaussianTracks::rebase(targets, count);
  samples_.clear();
}

}  // namespace vantage::estimator
