#include "estimator/distributed_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "core/check.hpp"
#include "estimator/confinement.hpp"
#include "estimator/missed_detection.hpp"

namespace vantage::estimator {

namespace {

constexpr std::size_t kTeammatesReserved = 64;
constexpr int kOwnLooksReserved = 4;

/// √det Ω, a belief's share in a fusion; 0 when Ω is not positive definite.
double weight_of(const models::StateMatrix& Omega) {
  const Eigen::LLT<models::StateMatrix> root(Omega);
  return root.info() == Eigen::Success ? root.matrixLLT().diagonal().prod() : 0.0;
}

/// The κ in [0, 1] for which det((1 − κ) A + κ B) is largest. log det is concave in κ, so its slope
/// tr((B − A) Ω⁻¹) falls; halving finds where it is 0, to 1/4096.
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

/// The world's cells or, in a neighbourhood, those around where the robot is: the same while it
/// stays in a square of half the neighbourhood, so that they seldom change and depend on nothing
/// but its place.
models::GridGeometry grid_around(const FilterSpec& spec, const Eigen::Vector2d& place_m) {
  const auto whole =
      models::GridGeometry::covering(spec.world.bounds, spec.estimator.grid_resolution_m);
  if (spec.neighbourhood_m <= 0.0) {
    return whole;
  }
  const double square_m = 0.5 * spec.neighbourhood_m;
  const Eigen::Vector2d centre_m = square_m * (place_m / square_m).array().round();
  return whole.window(centre_m, spec.neighbourhood_m + 0.5 * square_m);
}

}  // namespace

DistributedFilter::DistributedFilter(FilterSpec spec)
    : spec_(std::move(spec)),
      viewpoint_(spec_.start),
      tracks_(spec_.target_count),
      grid_(spec_.world, grid_around(spec_, spec_.start.world_from_body.position_m()),
            spec_.estimator.grid_memory_s) {
  require(spec_.target_count >= 0, "target_count must not be negative");
  require(spec_.step_s > 0.0, "step_s must be positive");
  require(spec_.history_steps >= 1, "history_steps must be at least 1");
  require(spec_.estimator.prior_position_sigma_m > 0.0 &&
              spec_.estimator.prior_velocity_sigma_mps > 0.0,
          "prior sigmas must be positive");
  const int looks =
      kOwnLooksReserved + static_cast<int>(std::min(spec_.team.size(), kTeammatesReserved));
  for (std::size_t i = 0; i < spec_.team.size(); ++i) {
    lookers_.emplace(spec_.team[i].robot, static_cast<int>(i));
  }
  records_.resize(static_cast<std::size_t>(spec_.history_steps));
  for (StepRecord& r : records_) {  // copying a vector does not copy what it has reserved
    r = StepRecord(spec_.target_count, looks);
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
    for (const models::DetectionSet* look : input.looks) {
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
  current.place_m = viewpoint_.world_from_body.position_m();
  listen(input, current);

  int oldest_changed = 0;
  for (const models::DetectionSet* look : input.looks) {
    oldest_changed = std::max(oldest_changed, file(*look, input.time));
  }
  if (oldest_changed > 0) {
    tracks_ = record(oldest_changed).before;
  }
  for (int age = oldest_changed; age >= 0; --age) {
    StepRecord& again = record(age);
    again.before = tracks_;
    run(again);
  }
  time_ = input.time;
}

void DistributedFilter::listen(const StepInput& input, StepRecord& record) {
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
    record.is_heard_of_end = record.is_heard_of_end || belief->stamp.time == input.time;
    hear(*belief, input.time, record);
    merge_grid(*belief);
  }
}

void DistributedFilter::hear(const models::RobotBelief& belief, Time now, StepRecord& record) {
  for (const models::TargetBelief& target : belief.targets) {
    if (target.target_id < 0 || target.target_id >= spec_.target_count) {
      ++counters_.unknown_ids;
      continue;
    }
    const int dim = spec_.estimator.target_model.dim();
    if (target.information.vector.size() != dim || target.information.matrix.rows() != dim ||
        target.information.matrix.cols() != dim) {
      ++counters_.malformed_beliefs;
      continue;
    }
    const auto now_known = propagate(spec_.estimator.target_model, spec_.step_s, target.information,
                                     target.last_seen, belief.stamp.time, now);
    if (!now_known) {
      ++counters_.singular;
      continue;
    }
    const double weight = weight_of(now_known->matrix);
    if (!(weight > 0.0) || !std::isfinite(weight)) {
      ++counters_.singular;
      continue;
    }
    HeardTrack* const heard = record.heard.find(target.target_id);
    if (heard == nullptr) {
      record.heard.put(
          {target.target_id,
           {true, {weight * now_known->vector, weight * now_known->matrix}, target.last_seen},
           weight});
    } else {
      heard->track.information.vector += weight * now_known->vector;
      heard->track.information.matrix += weight * now_known->matrix;
      heard->track.last_seen = std::max(heard->track.last_seen, target.last_seen);
      heard->weight += weight;
    }
  }
}

void DistributedFilter::merge_grid(const models::RobotBelief& belief) {
  if (belief.last_seen_utime.empty()) {
    return;
  }
  // Nobody has seen anything after the instant of their own message.
  const bool is_one_grid = spec_.neighbourhood_m > 0.0 || belief.grid == grid_.geometry();
  if (!is_one_grid ||
      !grid_.merge(belief.grid, belief.last_seen_utime, to_utime(belief.stamp.time))) {
    ++counters_.grid_mismatches;
  }
}

int DistributedFilter::looker_of(const models::DetectionSet& look) const {
  auto found = lookers_.find(look.robot);
  if (found == lookers_.end()) {
    found = lookers_.find(spec_.robot);
  }
  return found == lookers_.end() ? -1 : found->second;
}

const models::SensorModel& DistributedFilter::sensor_of(int looker) const {
  const auto index = static_cast<std::size_t>(looker);
  return looker < 0 || spec_.team[index].robot == spec_.robot ? spec_.sensor
                                                              : spec_.team[index].sensor;
}

int DistributedFilter::file(const models::DetectionSet& look, Time now) {
  const int looker = looker_of(look);
  const bool is_own =
      looker < 0 || spec_.team[static_cast<std::size_t>(looker)].robot == spec_.robot;
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
  if (!is_own && record(age).holds(at, looker)) {
    ++counters_.repeated_looks;
    return -1;
  }
  if (age > 0) {
    ++counters_.late_measurements;
  }
  const models::SensorModel& sensor = sensor_of(looker);
  if (is_own) {  // what teammates have looked at comes with their grids
    grid_.see(sensor, look.viewpoint, spec_.world, at);
  }
  Look& filed = record(age).insert(at, looker);
  filed.from = look.viewpoint;
  const int rows = sensor.measurement_dim(spec_.estimator.target_model.position_dim);
  for (const models::Detection& detection : look.detections) {
    const bool twice = std::any_of(filed.detections.begin(), filed.detections.end(),
                                   [&](auto& d) { return d.target_id == detection.target_id; });
    const models::Measurement& z = detection.measurement;
    if (detection.target_id < 0 || detection.target_id >= spec_.target_count) {
      ++counters_.unknown_ids;
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
  const auto look = [&](int i) -> Look& { return record.looks[static_cast<std::size_t>(i)]; };
  for (; next < record.look_count && look(next).time < record.to; ++next) {
    propagate_all(at, look(next).time);
    at = look(next).time;
    apply(look(next));
  }
  propagate_all(at, record.to);
  if (!record.is_heard_of_end) {
    fuse(record);
  }
  confine_all();
  for (; next < record.look_count; ++next) {
    apply(look(next));
  }
  if (record.is_heard_of_end) {  // a belief of `to` holds looks of `to`: they are in before it is
    fuse(record);
  }
  forget_far(record.place_m);
}

void DistributedFilter::forget_far(const Eigen::Vector2d& place_m) {
  if (spec_.neighbourhood_m <= 0.0) {
    return;
  }
  tracks_.erase_if([&](const KnownTrack& each) {
    const auto belief = models::to_gaussian(each.track.information);
    return !belief || (belief->mean.head<2>() - place_m).norm() > spec_.neighbourhood_m;
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

void DistributedFilter::propagate_all(Time from, Time to) {
  for (auto& [target_id, track] : tracks_) {
    const auto later = propagate(spec_.estimator.target_model, spec_.step_s, track.information,
                                 track.last_seen, from, to);
    if (later) {
      track.information = *later;
    } else {  // nothing trustworthy is left: discover it again
      ++counters_.singular;
      track.known = false;
    }
  }
  drop_unknown();
}

void DistributedFilter::fuse(const StepRecord& record) {
  for (const auto& [target_id, heard, heard_weight] : record.heard) {
    const models::Information theirs{heard.information.vector / heard_weight,
                                     heard.information.matrix / heard_weight};
    KnownTrack* const known = tracks_.find(target_id);
    if (known == nullptr) {
      tracks_.put({target_id, {true, theirs, heard.last_seen}});
      continue;
    }
    Track& own = known->track;
    const double kappa = intersection_weight(own.information.matrix, theirs.matrix);
    if (kappa > 0.0) {
      own.information.vector += kappa * (theirs.vector - own.information.vector);
      own.information.matrix += kappa * (theirs.matrix - own.information.matrix);
      own.last_seen = std::max(own.last_seen, heard.last_seen);
    }
  }
}

void DistributedFilter::confine_all() {
  if (!spec_.estimator.targets_stay_inside) {
    return;
  }
  for (auto& [target_id, track] : tracks_) {
    const auto belief = models::to_gaussian(track.information);
    if (!belief) {
      continue;
    }
    const models::Gaussian inside = confine(*belief, spec_.world);
    if (inside.mean == belief->mean && inside.covariance == belief->covariance) {
      continue;
    }
    if (const auto information = models::to_information(inside)) {
      track.information = *information;
    } else {
      ++counters_.singular;
    }
  }
}

void DistributedFilter::apply(Look& look) {
  FilterCounters unused;
  FilterCounters& count = look.counted ? unused : counters_;
  look.counted = true;
  const scenario::EstimatorSpec& spec = spec_.estimator;
  const models::SensorModel& sensor = sensor_of(look.looker);
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
    switch (measure(track.information, sensor, look.from, detection.measurement, spec.gate_sigma)) {
      case Use::kUsed:
        track.last_seen = std::max(track.last_seen, look.time);
        track.gated_in_a_row = 0;
        break;
      case Use::kGated:
        ++count.gated;
        doubt(track, spec, sensor, look.from, detection.measurement, look.time);
        break;
      case Use::kSingular:
        ++count.singular;
        break;
    }
  }
  if (spec.detection_probability <= 0.0) {
    return;
  }
  for (KnownTrack& each : tracks_) {
    const bool reported = std::any_of(look.detections.begin(), look.detections.end(),
                                      [&](const auto& d) { return d.target_id == each.target_id; });
    if (reported) {
      continue;
    }
    const auto belief = models::to_gaussian(each.track.information);
    if (!belief) {
      continue;
    }
    const models::Gaussian missed =
        missed_detection(*belief, sensor, look.from, spec_.world, spec.detection_probability);
    if (missed.mean == belief->mean && missed.covariance == belief->covariance) {
      continue;
    }
    if (const auto information = models::to_information(missed)) {
      each.track.information = *information;
      ++count.missed_detections;
    } else {
      ++count.singular;
    }
  }
}

models::RobotBelief DistributedFilter::belief() const {
  models::RobotBelief belief;
  belief.stamp.time = time_.value_or(Time{});
  belief.robot = spec_.robot;
  belief.viewpoint = viewpoint_;
  belief.degree = degree_;
  for (const auto& [target_id, track] : tracks_) {
    belief.targets.push_back({target_id, track.information, track.last_seen});
  }
  belief.grid = grid_.geometry();
  belief.last_seen_utime = grid_.last_seen_utime();
  return belief;
}

void DistributedFilter::rebase(const models::RobotBelief& belief) {
  recorded_ = 0;
  time_ = belief.stamp.time;
  viewpoint_ = belief.viewpoint;
  degree_ = belief.degree;
  tracks_.clear();
  const int dim = spec_.estimator.target_model.dim();
  for (const models::TargetBelief& target : belief.targets) {
    if (target.target_id < 0 || target.target_id >= spec_.target_count) {
      ++counters_.unknown_ids;
    } else if (target.information.vector.size() != dim) {
      ++counters_.malformed_beliefs;
    } else {
      tracks_.put({target.target_id, {true, target.information, target.last_seen}});
    }
  }
  move_grid();
  if (belief.grid == grid_.geometry() &&
      belief.last_seen_utime.size() == grid_.last_seen_utime().size()) {
    grid_.set_last_seen(belief.last_seen_utime);
  } else if (!belief.last_seen_utime.empty()) {
    ++counters_.grid_mismatches;
  }
}

}  // namespace vantage::estimator
