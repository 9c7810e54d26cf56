#include "estimator/filter/distributed_filter.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"
#include "estimator/tracks/gaussian/gaussian_tracks.hpp"
#include "estimator/tracks/labelled/labelled_tracks.hpp"
#include "estimator/tracks/samples/sample_tracks.hpp"

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

/// Returns the spec if it is valid.
FilterSpec checked(FilterSpec spec) {
  require(spec.target_count >= 0, "target_count must not be negative");
  require(spec.step_s > 0.0, "step_s must be positive");
  require(spec.history_steps >= 1, "history_steps must be at least 1");
  require(
      spec.estimator.prior_position_sigma_m > 0.0 && spec.estimator.prior_velocity_sigma_mps > 0.0,
      "prior sigmas must be positive");
  return spec;
}

/// Returns the store that represents the beliefs of the spec's targets.
std::unique_ptr<TrackStore> no_tracks(const FilterSpec& spec) {
  if (!spec.detection.detects_ids) {
    return std::make_unique<LabelledTracks>(spec);
  }
  if (spec.estimator.samples && spec.estimator.target_model.has_velocity()) {
    return std::make_unique<SampleTracks>(spec);
  }
  return std::make_unique<GaussianTracks>(spec);
}

}  // namespace

DistributedFilter::DistributedFilter(FilterSpec spec)
    : spec_(checked(std::move(spec))),
      self_{spec_.robot, spec_.sensor, spec_.detection},
      viewpoint_(spec_.start),
      tracks_(no_tracks(spec_)),
      grid_(spec_.world, grid_around(spec_, spec_.start.world_from_body.position_m()),
            spec_.estimator.grid_memory_s),
      records_(index(spec_.history_steps)) {
  const int observations_max =
      kOwnObservationsReserved + static_cast<int>(std::min(spec_.team.size(), kTeammatesReserved));
  for (std::size_t i = 0; i < spec_.team.size(); ++i) {
    source_indices_.emplace(spec_.team[i].robot, static_cast<int>(i));
  }
  for (StepRecord& r : records_) {  // a copied vector has no reserved capacity
    r = StepRecord(tracks_->detections_reserved(), observations_max);
  }
  in_range_.reserve(kTeammatesReserved);
}

models::RobotBelief DistributedFilter::step(const StepInput& input) {
  advance(input);
  return belief();
}

int DistributedFilter::slot(int age) const {
  const int size = static_cast<int>(records_.size());
  return (newest_ + size - age) % size;
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
  current.start({newest_, from, input.time, !time_});
  current.position_m = viewpoint_.world_from_body.position_m();
  tracks_->start(current.step);
  collect_beliefs(input, current.step);

  int oldest_changed = 0;
  for (const models::RobotMeasurement* look : input.measurements) {
    oldest_changed = std::max(oldest_changed, file(*look, input.time));
  }
  if (oldest_changed > 0) {
    tracks_->restore(slot(oldest_changed));
  }
  for (int age = oldest_changed; age >= 0; --age) {
    tracks_->save(slot(age));
    run(record(age));
  }
  time_ = input.time;
}

void DistributedFilter::collect_beliefs(const StepInput& input, const Step& step) {
  in_range_.clear();
  const Duration age_max = from_seconds(spec_.belief_age_max_s);
  for (const models::RobotBelief* belief : input.beliefs) {
    if (belief->stamp.time > input.time) {
      ++counters_.future_beliefs;
    } else if (input.time - belief->stamp.time > age_max) {
      ++counters_.stale_beliefs;
    } else if (spec_.communication_range_m <= 0.0 ||
               distance_m(belief->viewpoint, viewpoint_) > spec_.communication_range_m) {
      ++counters_.out_of_range_beliefs;
    } else {
      in_range_.push_back(belief);
    }
  }
  degree_ = static_cast<int>(in_range_.size());
  for (const models::RobotBelief* belief : in_range_) {
    tracks_->receive(*belief, step, counters_);
    merge_grid(*belief);
  }
}

void DistributedFilter::merge_grid(const models::RobotBelief& belief) {
  if (belief.last_seen_utime.empty()) {
    return;
  }
  // No cell can have been seen after the instant of the message.
  const bool is_one_grid = spec_.neighbourhood_m > 0.0 || belief.grid == grid_.geometry();
  if (!is_one_grid ||
      !grid_.merge(belief.grid, belief.last_seen_utime, to_utime(belief.stamp.time))) {
    ++counters_.grid_mismatches;
  }
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

const ObservationSource& DistributedFilter::source_at(int source) const {
  return is_self(source) ? self_ : spec_.team[index(source)];
}

int DistributedFilter::age_of(const models::RobotMeasurement& look, int source, Time now) {
  if (!is_self(source) && (spec_.communication_range_m <= 0.0 ||
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
  while (age < recorded_ && at <= record(age).step.from && !(age == 0 && !time_)) {
    ++age;
  }
  if (age == recorded_) {
    ++counters_.too_late_measurements;
    return -1;
  }
  if ((!is_self(source) || tracks_->has_one_observation_per_instant()) &&
      record(age).holds(at, source)) {
    ++counters_.repeated_looks;
    return -1;
  }
  counters_.late_measurements += age > 0 ? 1 : 0;
  return age;
}

int DistributedFilter::file(const models::RobotMeasurement& look, Time now) {
  const int source = source_of(look);
  const int age = age_of(look, source, now);
  if (age < 0) {
    return age;
  }
  const models::SensorModel& sensor = source_at(source).sensor;
  if (is_self(source)) {  // a teammate's belief contains a grid with the cells that it scanned
    grid_.see(sensor, look.viewpoint, spec_.world, look.stamp.time);
  }
  Observation& filed = record(age).insert(look.stamp.time, source);
  filed.from = look.viewpoint;
  const int rows = sensor.measurement_dim(spec_.estimator.target_model.position_dim);
  for (const models::Detection& detection : look.detections) {
    const models::Measurement& z = detection.measurement;
    const bool has_right_dimension = z.z.size() == rows && z.V.rows() == rows && z.V.cols() == rows;
    tracks_->file(detection, has_right_dimension, filed, counters_);
  }
  return age;
}

void DistributedFilter::run(StepRecord& record) {
  const Step& step = record.step;
  Time at = step.from;
  int next = 0;
  const auto look = [&](int i) -> Observation& { return record.observations[index(i)]; };
  // The fusion precedes the prediction, so that the prediction also applies to the received
  // beliefs.
  tracks_->fuse(step, FusionPoint::kStart, counters_);
  for (; next < record.observation_count && look(next).time < step.to; ++next) {
    tracks_->propagate(at, look(next).time, counters_);
    at = look(next).time;
    apply(look(next));
  }
  tracks_->propagate(at, step.to, counters_);
  tracks_->fuse(step, FusionPoint::kEnd, counters_);
  if (spec_.estimator.targets_stay_inside) {
    tracks_->confine(counters_);
  }
  for (; next < record.observation_count; ++next) {
    apply(look(next));
  }
  tracks_->fuse(step, FusionPoint::kFinish, counters_);
  if (spec_.neighbourhood_m > 0.0) {
    tracks_->forget_far(record.position_m);
  }
}

void DistributedFilter::apply(Observation& look) {
  FilterCounters unused;
  tracks_->use(look, source_at(look.source), look.counted ? unused : counters_);
  look.counted = true;
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

models::RobotBelief DistributedFilter::belief() const {
  models::RobotBelief belief;
  belief.stamp.time = time_.value_or(Time{});
  belief.robot = spec_.robot;
  belief.viewpoint = viewpoint_;
  belief.degree = degree_;
  belief.targets = tracks_->beliefs();
  belief.grid = grid_.geometry();
  belief.last_seen_utime = grid_.last_seen_utime();
  return belief;
}

models::BeliefMixture DistributedFilter::mixture() const {
  models::BeliefMixture mixture;
  mixture.stamp.time = time_.value_or(Time{});
  mixture.robot = spec_.robot;
  mixture.targets = tracks_->mixtures();
  return mixture;
}

void DistributedFilter::rebase(const models::RobotBelief& belief) {
  recorded_ = 0;
  time_ = belief.stamp.time;
  viewpoint_ = belief.viewpoint;
  degree_ = belief.degree;
  tracks_->rebase(belief.targets, counters_);
  move_grid();
  if (belief.grid == grid_.geometry() &&
      belief.last_seen_utime.size() == grid_.last_seen_utime().size()) {
    grid_.set_last_seen(belief.last_seen_utime);
  } else if (!belief.last_seen_utime.empty()) {
    ++counters_.grid_mismatches;
  }
}

}  // namespace vantage::estimator
