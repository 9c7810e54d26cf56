#include "estimator/tracks/labelled/labelled_tracks.hpp"

#include <optional>

#include "core/check.hpp"
#include "core/index.hpp"
#include "estimator/posterior/confinement.hpp"

namespace vantage::estimator {
namespace {

MultiTargetSpec multi_target_spec(const FilterSpec& spec) {
  require(spec.team.size() <= index(kLabelledRobots),
          "teams without target ids may have at most 32 robots");
  require(spec.neighbourhood_m <= 0.0, "neighbourhood_m must be 0 without target ids");
  MultiTargetSpec out;
  out.estimator = spec.estimator;
  out.world = spec.world;
  out.detection = spec.detection;
  out.step_s = spec.step_s;
  out.targets = spec.target_count;
  out.tracks_max = 2 * spec.target_count;
  out.detections_max = kLabelledDetections;
  return out;
}

}  // namespace

LabelledTracks::LabelledTracks(const FilterSpec& spec)
    : filter_(multi_target_spec(spec)),
      free_space_(inset(spec.world, spec.target_radius_m)),
      received_max_(spec.team.size() * index(filter_.spec().tracks_max)),
      tracks_(filter_.no_tracks()),
      history_(index(spec.history_steps)) {
  received_.reserve(received_max_);
  for (Record& each : history_) {  // a copied vector has no reserved capacity
    each.before = filter_.no_tracks();
    each.received.reserve(received_max_);
  }
}

std::unique_ptr<TrackStore> LabelledTracks::clone() const {
  return std::make_unique<LabelledTracks>(*this);
}

void LabelledTracks::file(const models::Detection& detection, bool has_right_dimension,
                          Observation& observation, FilterCounters& count) const {
  if (observation.detections.size() >= index(kLabelledDetections)) {
    ++count.surplus_detections;
  } else if (!has_right_dimension) {
    ++count.malformed_detections;
  } else {
    observation.detections.push_back(detection);
  }
}

void LabelledTracks::start(const Step& step) { record(step.slot).received.clear(); }

void LabelledTracks::save(int slot) { record(slot).before = tracks_; }

void LabelledTracks::restore(int slot) { tracks_ = record(slot).before; }

void LabelledTracks::receive(const models::RobotBelief& belief, const Step& step,
                             FilterCounters& count) {
  const Time belief_at = belief.stamp.time;
  if (belief_at < step.from) {
    return;  // belief of a step that was reconciled already, or too old
  }
  // A belief of instant `from` contains no observation of this step and is used before all
  // observations. A later belief is used after them.
  const Time at = belief_at == step.from && step.from < step.to ? step.from : step.to;
  const models::TargetModel& model = filter_.spec().estimator.target_model;
  std::vector<ReceivedLabel>& received = record(step.slot).received;
  const int sender = received.empty() ? 0 : received.back().sender + 1;
  for (const models::TargetBelief& target : belief.targets) {
    const auto believed = target.information.vector.size() == model.dim()
                              ? models::to_gaussian(target.information)
                              : std::nullopt;
    if (target.target_id < models::kTrackLabelMin) {
      ++count.unknown_ids;
    } else if (!believed || received.size() >= received_max_) {
      ++count.malformed_beliefs;  // more tracks than any teammate in this scenario sends
    } else {
      received.push_back(
          {sender, at, target.target_id,
           models::predict_unseen(*believed, model, to_seconds(at - belief_at),
                                  to_seconds(belief_at - target.last_seen), filter_.spec().step_s),
           target.last_seen});
    }
  }
}

void LabelledTracks::fuse(const Step& step, FusionPoint point, FilterCounters& count) {
  if (point == FusionPoint::kEnd || (point == FusionPoint::kStart && step.from == step.to)) {
    return;
  }
  const Time at = point == FusionPoint::kStart ? step.from : step.to;
  const std::vector<ReceivedLabel>& received = record(step.slot).received;
  received_.assign(received.begin(), received.end());
  const std::span<ReceivedLabel> all(received_);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].sender == all[begin].sender) {
      ++end;
    }
    if (all[begin].at == at) {
      const Reconciled done = reconcile(tracks_, all.subspan(begin, end - begin));
      count.reconciled.relabelled += done.relabelled;
      count.reconciled.adopted += done.adopted;
      count.reconciled.taken_over += done.taken_over;
    }
  }
}

void LabelledTracks::propagate(Time from, Time to, FilterCounters& /*count*/) {
  filter_.propagate(tracks_, from, to);
}

void LabelledTracks::confine(FilterCounters& /*count*/) {
  for (LabelledTrack& track : tracks_) {
    for (Component& component : track.mixture) {
      component.belief = estimator::confine(component.belief, free_space_);
    }
  }
}

void LabelledTracks::use(const Observation& observation, const ObservationSource& source,
                         FilterCounters& /*count*/) {
  filter_.update(tracks_, observation, source.sensor, source.detection);
}

std::vector<models::TargetBelief> LabelledTracks::beliefs() const {
  return confirmed_beliefs(filter_, tracks_);
}

std::vector<models::TargetMixture> LabelledTracks::mixtures() const {
  return confirmed_mixtures(filter_, tracks_);
}

void LabelledTracks::rebase(std::span<const models::TargetBelief> targets,
                            FilterCounters& /*count*/) {
  set_tracks(tracks_, targets, filter_.spec().estimator.target_model.dim());
}

}  // namespace vantage::estimator
