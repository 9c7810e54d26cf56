#include "estimator/filter/distributed_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"
#include "estimator/posterior/confinement.hpp"
#include "estimator/posterior/missed_detection.hpp"

namespace vantage::estimator {

namespace {

constexpr std::size_t kTeammatesReserved = 64;
constexpr int kOwnObservationsReserved = 4;

/// Returns the grid of the world or, with a neighbourhood, of the robot's surroundings. The grid is
/// the same for all positions in a square with sides of half the neighbourhood. It therefore
/// changes seldom and depends only on the robot's position.
models::GridGeometry grid_around(const FilterSpec& spec, const Eigen::Vector2d& position_m) {
  const auto whole =
      models::GridGeometry::covering(spec.world.bounds, spec.estimator.grid_resolution_m);
  if (spec.neighbourhood_m <= 0.0) {
    return whole;
  }
  const double square_m = 0.5 * spec.neighbourhood_m;
  const Eigen::Vector2d centre_m = square_m * (position_m / square_m).array().round();
  return whole.window(centre_m, spec.neighbourhood_m + 0.5 * square_m);
}

MultiTargetSpec multi_target_spec(const FilterSpec& spec) {
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

bool is_same(const models::Gaussian& a, const models::Gaussian& b) {
  return a.mean == b.mean && a.covariance == b.covariance;
}

/// Sets the track's information from `belief`. If the covariance is singular, counts it, changes
/// nothing and returns false.
bool set_information(KnownTrack& known, const models::Gaussian& belief, FilterCounters& count) {
  const auto information = models::to_information(belief);
  if (information) {
    known.track.information = *information;
  } else {
    ++count.singular;
  }
  return information.has_value();
}

/// Sets the track's information from the moments of its samples; otherwise like set_information().
bool set_information_from_samples(KnownTrack& known, FilterCounters& count) {
  return set_information(known, known.samples.moments(), count);
}

/// Marks the track as updated by a detection made at `time`.
void mark_detected(Track& track, Time time) {
  track.last_seen = std::max(track.last_seen, time);
  track.doubted = {};
}

/// Returns the key that determines which sample receives which noise. It is the same for all robots
/// and differs between instants.
std::uint64_t noise_key(int target_id, Time at) {
  return (static_cast<std::uint64_t>(to_utime(at)) << 10U) + static_cast<std::uint64_t>(target_id);
}

}  // namespace

DistributedFilter::DistributedFilter(FilterSpec spec)
    : spec_(std::move(spec)),
      free_space_(inset(spec_.world, spec_.target_radius_m)),
      viewpoint_(spec_.start),
      tracks_(spec_.target_count),
      collisions_(can_collide() ? spec_.target_count : 0, 2.0 * spec_.target_radius_m),
      grid_(spec_.world, grid_around(spec_, spec_.start.world_from_body.position_m()),
            spec_.estimator.grid_memory_s) {
  require(spec_.target_count >= 0, "target_count must not be negative");
  require(spec_.step_s > 0.0, "step_s must be positive");
  require(spec_.history_steps >= 1, "history_steps must be at least 1");
  require(spec_.estimator.prior_position_sigma_m > 0.0 &&
              spec_.estimator.prior_velocity_sigma_mps > 0.0,
          "prior sigmas must be positive");
  const int observations_max =
      kOwnObservationsReserved + static_cast<int>(std::min(spec_.team.size(), kTeammatesReserved));
  for (std::size_t i = 0; i < spec_.team.size(); ++i) {
    source_indices_.emplace(spec_.team[i].robot, static_cast<int>(i));
  }
  records_.resize(static_cast<std::size_t>(spec_.history_steps));
  const bool has_ids = spec_.detection.detects_ids;
  for (StepRecord& r : records_) {  // a copied vector has no reserved capacity
    r = StepRecord(has_ids ? spec_.target_count : kLabelledDetections, observations_max);
  }
  if (!has_ids) {
    require(spec_.team.size() <= index(kLabelledRobots),
            "teams without target ids may have at most 32 robots");
    require(spec_.neighbourhood_m <= 0.0, "neighbourhood_m must be 0 without target ids");
    multi_target_.emplace(multi_target_spec(spec_));
    labelled_ = multi_target_->no_tracks();
    const std::size_t received_max = spec_.team.size() * labelled_.size();
    received_labels_.reserve(received_max);
    for (StepRecord& r : records_) {
      r.labelled_before = multi_target_->no_tracks();
      r.received_labels.reserve(received_max);
    }
  }
  in_range_.reserve(kTeammatesReserved);
}

models::RobotBelief DistributedFilter::step(const StepInput& input) {
  advance(input);
  return belief();
}

StepRecord& DistributedFilter::record(int age) {
  const int size = static_cast<int>(records_.size());
  return records_[static_cast<std::size_t>((newest_ + size - age) % size)];
}

void DistributedFilter::advance(const StepInput& input) {
  if (time_ && input.time <= *time_) {
    ++counters_.steps_out_of_order;
    return;
  }
  Time from = time_.value_or(input.time);
  if (!time_) {
    for (const models::RobotMeasurement* look : input.measurements) {
      from = std::min(from, look->stamp.time);
    }
  }
  if (input.viewpoint) {
    viewpoint_ = *input.viewpoint;
    move_grid();
  }
  newest_ = (newest_ + 1) % static_cast<int>(records_.size());
  recorded_ = std::min(recorded_ + 1, static_cast<int>(records_.size()));
  StepRecord& current = record(0);
  current.start(from, input.time, tracks_);
  current.labelled_before = labelled_;
  current.position_m = viewpoint_.world_from_body.position_m();
  collect_beliefs(input, current);

  int oldest_changed = 0;
  for (const models::RobotMeasurement* look : input.measurements) {
    oldest_changed = std::max(oldest_changed, file(*look, input.time));
  }
  if (oldest_changed > 0) {
    tracks_ = record(oldest_changed).before;
    labelled_ = record(oldest_changed).labelled_before;
  }
  for (int age = oldest_changed; age >= 0; --age) {
    StepRecord& again = record(age);
    again.before = tracks_;
    again.labelled_before = labelled_;
    run(again);
  }
  time_ = input.time;
}

int DistributedFilter::source_of(const models::RobotMeasurement& look) const {
  auto found = source_indices_.find(look.robot);
  if (found == source_indices_.end()) {
    found = source_indices_.find(spec_.robot);
  }
  return found == source_indices_.end() ? -1 : found->second;
}

bool DistributedFilter::is_self(int source) const {
  return source < 0 || spec_.team[index(source)].robot == spec_.robot;
}

const models::SensorModel& DistributedFilter::sensor_of(int source) const {
  return is_self(source) ? spec_.sensor : spec_.team[index(source)].sensor;
}

const models::DetectionModel& DistributedFilter::detection_of(int source) const {
  return is_self(source) ? spec_.detection : spec_.team[index(source)].detection;
}

int DistributedFilter::file(const models::RobotMeasurement& look, Time now) {
  const int source = source_of(look);
  const bool is_own = is_self(source);
  if (!is_own && (spec_.communication_range_m <= 0.0 ||
                  distance_m(look.viewpoint, viewpoint_) > spec_.communication_range_m)) {
    ++counters_.out_of_range_looks;
    return -1;
  }
  if (look.jammed) {
    ++counters_.jammed_looks;
    return -1;
  }
  const Time at = look.stamp.time;
  if (at > now) {
    ++counters_.future_measurements;
    return -1;
  }
  int age = 0;
  while (age < recorded_ && at <= record(age).from && !(age == 0 && !time_)) {
    ++age;
  }
  if (age == recorded_) {
    ++counters_.too_late_measurements;
    return -1;
  }
  if ((!is_own || multi_target_) && record(age).holds(at, source)) {
    ++counters_.repeated_looks;
    return -1;
  }
  if (age > 0) {
    ++counters_.late_measurements;
  }
  const models::SensorModel& sensor = sensor_of(source);
  if (is_own) {  // the grids of teammates contain the cells that they scanned
    grid_.see(sensor, look.viewpoint, spec_.world, at);
  }
  Observation& filed = record(age).insert(at, source);
  filed.from = look.viewpoint;
  const int rows = sensor.measurement_dim(spec_.estimator.target_model.position_dim);
  for (const models::Detection& detection : look.detections) {
    const bool is_room = !multi_target_ || filed.detections.size() < index(kLabelledDetections);
    const bool twice =
        !multi_target_ && std::any_of(filed.detections.begin(), filed.detections.end(),
                                      [&](auto& d) { return d.target_id == detection.target_id; });
    const models::Measurement& z = detection.measurement;
    if (!multi_target_ && (detection.target_id < 0 || detection.target_id >= spec_.target_count)) {
      ++counters_.unknown_ids;
    } else if (!is_room) {
      ++counters_.surplus_detections;
    } else if (twice || z.z.size() != rows || z.V.rows() != rows || z.V.cols() != rows) {
      ++counters_.malformed_detections;
    } else {
      filed.detections.push_back(detection);
    }
  }
  return age;
}

void DistributedFilter::run(StepRecord& record) {
  Time at = record.from;
  int next = 0;
  const auto look = [&](int i) -> Observation& {
    return record.observations[static_cast<std::size_t>(i)];
  };
  if (record.from < record.to) {
    reconcile_labels(record, record.from);
  }
  fuse(record.received_at_start);  // first, so that the prediction acts on them too
  for (; next < record.observation_count && look(next).time < record.to; ++next) {
    propagate_all(at, look(next).time);
    at = look(next).time;
    apply(look(next));
  }
  propagate_all(at, record.to);
  if (!record.has_belief_of_end) {
    fuse(record.received_at_end);
  }
  confine_all();
  for (; next < record.observation_count; ++next) {
    apply(look(next));
  }
  if (record.has_belief_of_end) {  // such a belief contains the observations of `to`
    fuse(record.received_at_end);
  }
  reconcile_labels(record, record.to);
  forget_far(record.position_m);
}

void DistributedFilter::forget_far(const Eigen::Vector2d& position_m) {
  if (spec_.neighbourhood_m <= 0.0) {
    return;
  }
  tracks_.erase_if([&](const KnownTrack& each) {
    const auto belief = models::to_gaussian(each.track.information);
    return !belief || (belief->mean.head<2>() - position_m).norm() > spec_.neighbourhood_m;
  });
}

void DistributedFilter::drop_unknown() {
  tracks_.erase_if([](const KnownTrack& each) { return !each.track.known; });
}

void DistributedFilter::move_grid() {
  if (spec_.neighbourhood_m <= 0.0) {
    return;
  }
  const models::GridGeometry geometry = grid_around(spec_, viewpoint_.world_from_body.position_m());
  if (!(geometry == grid_.geometry())) {
    models::VisibilityGrid moved(spec_.world, geometry, spec_.estimator.grid_memory_s);
    moved.merge(grid_.geometry(), grid_.last_seen_utime(),
                std::numeric_limits<std::int64_t>::max());
    grid_ = std::move(moved);
  }
}

bool DistributedFilter::uses_samples() const {
  return spec_.estimator.samples && spec_.estimator.target_model.has_velocity();
}

bool DistributedFilter::can_collide() const {
  return uses_samples() && spec_.detection.detects_ids && spec_.target_radius_m > 0.0;
}

void DistributedFilter::propagate_all(Time from, Time to) {
  if (multi_target_) {
    multi_target_->propagate(labelled_, from, to);
  }
  if (can_collide() && from < to) {
    collisions_.apply(tracks_, to_seconds(to - from), noise_key(0, to));
  }
  for (KnownTrack& each : tracks_) {
    Track& track = each.track;
    if (!each.samples.empty() && from < to) {
      each.samples.predict(spec_.estimator.target_model, to_seconds(to - from),
                           noise_key(each.target_id, to));
      set_information_from_samples(each, counters_);
      continue;
    }
    const auto later = propagate(spec_.estimator.target_model, spec_.step_s, track.information,
                                 track.last_seen, from, to);
    if (later) {
      track.information = *later;
    } else {  // drop the track; the next detection discovers it again
      ++counters_.singular;
      track.known = false;
    }
  }
  drop_unknown();
}

void DistributedFilter::confine_all() {
  if (!spec_.estimator.targets_stay_inside) {
    return;
  }
  for (LabelledTrack& track : labelled_) {
    for (Component& component : track.mixture) {
      component.belief = confine(component.belief, free_space_);
    }
  }
  for (KnownTrack& each : tracks_) {
    if (each.samples.empty()) {
      const auto belief = models::to_gaussian(each.track.information);
      if (!belief) {
        continue;
      }
      const models::Gaussian inside = confine(*belief, free_space_);
      if (is_same(inside, *belief)) {
        continue;
      }
      if (!uses_samples()) {
        set_information(each, inside, counters_);
        continue;
      }
      each.samples.spread(*belief);
    }
    if (!each.samples.empty()) {
      each.samples.turn_back(free_space_.bounds);
      each.samples.keep_out_of(free_space_.obstacles);
      set_information_from_samples(each, counters_);
    }
  }
}

void DistributedFilter::apply(Observation& look) {
  FilterCounters unused;
  FilterCounters& count = look.counted ? unused : counters_;
  look.counted = true;
  const scenario::EstimatorSpec& spec = spec_.estimator;
  const models::SensorModel& sensor = sensor_of(look.source);
  if (multi_target_) {
    const int robot = look.source < 0 ? kLabelledRobots - 1 : look.source;
    const ObservationContext context{sensor, detection_of(look.source), look.from, look.time,
                                     first_label(look.time, robot)};
    multi_target_->update(labelled_, context, look.detections);
    return;
  }
  const double gate_sigma = can_discover(sensor) ? spec.gate_sigma : 0.0;
  for (const models::Detection& detection : look.detections) {
    KnownTrack* const known = tracks_.find(detection.target_id);
    if (known == nullptr) {
      const auto found = discover(spec, sensor, look.from, detection.measurement);
      if (found) {
        tracks_.put({detection.target_id, {true, *found, look.time}});
      } else {
        ++count.undiscoverable;
      }
      continue;
    }
    Track& track = known->track;
    if (!known->samples.empty() &&
        known->samples.measure(sensor, look.from, detection.measurement, gate_sigma)) {
      set_information_from_samples(*known, count);
      known->samples.clear();
      mark_detected(track, look.time);
      continue;
    }
    switch (measure(track.information, sensor, look.from, detection.measurement, gate_sigma)) {
      case Use::kUsed:
        known->samples.clear();
        mark_detected(track, look.time);
        break;
      case Use::kGated:
        ++count.gated;
        if (doubt(track, spec, sensor, look.from, detection.measurement, look.time)) {
          known->samples.clear();
        }
        break;
      case Use::kSingular:
        ++count.singular;
        break;
    }
  }
  apply_missed_detections(look, count);
}

void DistributedFilter::apply_missed_detections(const Observation& look, FilterCounters& count) {
  const double detection_probability = std::min(spec_.estimator.detection_probability,
                                                detection_of(look.source).detection_probability);
  if (detection_probability <= 0.0) {
    return;
  }
  for (KnownTrack& each : tracks_) {
    const bool reported = std::any_of(look.detections.begin(), look.detections.end(),
                                      [&](const auto& d) { return d.target_id == each.target_id; });
    if (reported) {
      continue;
    }
    if (each.samples.empty()) {
      const auto belief = models::to_gaussian(each.track.information);
      if (!belief) {
        continue;
      }
      const models::Gaussian missed = missed_detection(*belief, sensor_of(look.source), look.from,
                                                       spec_.world, detection_probability);
      if (is_same(missed, *belief)) {
        continue;
      }
      if (!uses_samples()) {
        count.missed_detections += set_information(each, missed, count) ? 1 : 0;
        continue;
      }
      each.samples.spread(*belief);
    }
    if (!each.samples.empty() &&
        each.samples.miss(sensor_of(look.source), look.from, spec_.world, detection_probability)) {
      count.missed_detections += set_information_from_samples(each, count) ? 1 : 0;
    }
  }
}

}  // namespace vantage::estimator
