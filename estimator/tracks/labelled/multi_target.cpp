#include "estimator/tracks/labelled/multi_target.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "core/check.hpp"
#include "core/index.hpp"
#include "estimator/posterior/missed_detection.hpp"
#include "estimator/tracks/gaussian/track.hpp"
#include "estimator/tracks/labelled/track_labels.hpp"
#include "models/sensor/law.hpp"

namespace vantage::estimator {
namespace {

/// Existence probability below which a track is deleted or not started.
constexpr double kExistenceMin = 0.01;
/// Least assumed number of targets without a track. With the value 0, a target with a wrong track
/// would never be found again.
constexpr double kUntrackedMin = 0.05;
/// Least assumed number of false alarms per observation. With the value 0, a single outlier would
/// start a confirmed track.
constexpr double kClutterMin = 1e-3;
constexpr double kDetectionMax = 0.99;
constexpr double kMerge_sigma = 1.0;   // distance within which components are merged
constexpr double kWeightMin = 1e-3;    // components of smaller weight are dropped
constexpr double kExactFrom = 0.02;    // smallest weight of a posterior computed by quadrature
constexpr int kHitsToConfirm = 3;      // number of hits that confirm a track
constexpr int kMissesOfTentative = 2;  // consecutive misses that delete a tentative track
constexpr int kMissesOfConfirmed = 5;  // consecutive misses that delete a confirmed track

PositionPrior nothing_known(const models::Viewpoint& from) {
  PositionPrior prior{models::PositionVector::Zero(2), models::PositionMatrix::Zero(2, 2)};
  prior.mean_m = from.world_from_body.position_m();
  return prior;
}

bool is_before(const models::Measurement& a, const models::Measurement& b) {
  return std::lexicographical_compare(a.z.begin(), a.z.end(), b.z.begin(), b.z.end());
}

}  // namespace

struct MultiTargetFilter::Input {
  const Observation& observation;
  const models::SensorModel& sensor;
  double detection_probability;
  double clutter_per_m2;    ///< expected false alarms per m² in view
  double untracked_per_m2;  ///< expected detections of targets without a track, per m²
};

MultiTargetFilter::MultiTargetFilter(MultiTargetSpec spec)
    : spec_(std::move(spec)),
      world_area_m2_((spec_.world.bounds.max_m - spec_.world.bounds.min_m).prod()),
      association_(spec_.tracks_max, spec_.detections_max) {
  require(spec_.targets >= 1 && spec_.tracks_max >= spec_.targets && spec_.detections_max >= 1,
          "tracks_max must be ≥ targets ≥ 1 and detections_max ≥ 1");
  require(spec_.components_max >= 1, "components_max must be at least 1");
  require(spec_.estimator.target_model.position_dim == 2,
          "targets without ids must have position_dim 2");
  if (spec_.tracker != Tracker::kLabelled) {
    spec_.components_max = 1;
  }
  const std::size_t tracks = index(spec_.tracks_max);
  const std::size_t detections = index(spec_.detections_max);
  const std::size_t components = index(spec_.components_max);
  seen_.reserve(detections);
  found_.reserve(detections);
  missed_.resize(tracks * components);
  missed_probability_.resize(tracks);
  fit_per_m2_.resize(tracks * components * detections);
  mixture_.reserve(components * (detections + 1));
  before_.reserve((tracks + 1) * (index(spec_.targets) + 1));
  after_.reserve(before_.capacity());
}

std::size_t MultiTargetFilter::at(std::size_t i, std::size_t k) const {
  return i * index(spec_.components_max) + k;
}

std::vector<LabelledTrack> MultiTargetFilter::no_tracks() const {
  std::vector<LabelledTrack> tracks(index(spec_.tracks_max));
  for (LabelledTrack& track : tracks) {
    track.mixture.reserve(index(spec_.components_max));
  }
  return tracks;
}

bool MultiTargetFilter::is_confirmed(const LabelledTrack& track) const {
  return track.existence > 0.0 &&
         (spec_.tracker == Tracker::kLabelled ? track.existence >= kConfirmed
                                              : track.hits >= kHitsToConfirm);
}

double MultiTargetFilter::existence_of(const LabelledTrack& track) const {
  return spec_.tracker == Tracker::kLabelled || track.existence == 0.0 ? track.existence : 1.0;
}

void MultiTargetFilter::propagate(std::vector<LabelledTrack>& tracks, Time from, Time to) {
  for (LabelledTrack& track : tracks) {
    for (Component& component : track.mixture) {
      component.belief = models::predict_unseen(component.belief, spec_.estimator.target_model,
                                                to_seconds(to - from),
                                                to_seconds(from - track.last_seen), spec_.step_s);
    }
  }
}

void MultiTargetFilter::update(std::vector<LabelledTrack>& tracks, const Observation& observation,
                               const models::SensorModel& sensor,
                               const models::DetectionModel& detection) {
  const double believed = spec_.estimator.detection_probability;
  const double true_p_D = detection.detection_probability;
  const double p_D = std::min({believed > 0.0 ? believed : true_p_D, true_p_D, kDetectionMax});
  double untracked = spec_.targets;
  for (const LabelledTrack& track : tracks) {
    untracked -= track.existence;
  }
  const double clutter = std::max(kClutterMin, detection.clutter_per_look);
  const Input input{observation, sensor, p_D,
                    clutter / models::view_area_m2(sensor, observation.from),
                    std::max(kUntrackedMin, untracked) * p_D / world_area_m2_};
  sort_detections(input);
  expect_misses(tracks, input);
  weigh(tracks, input);
  if (spec_.tracker != Tracker::kJpda) {
    share_out(spec_.tracker == Tracker::kNearest);
  }
  association_.solve();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].existence > 0.0) {
      mix(i, tracks[i], input);
    }
  }
  if (spec_.tracker == Tracker::kLabelled) {
    keep_to_number(tracks);
  } else {
    count_hits(tracks, input);
  }
  delete_tracks(tracks);
  start_tracks(tracks, input);
}

void MultiTargetFilter::sort_detections(const Input& input) {
  seen_.clear();
  found_.clear();
  const int rows = input.sensor.measurement_dim(2);
  for (const models::Detection& detection : input.observation.detections) {
    const models::Measurement& z = detection.measurement;
    if (z.z.size() != rows || z.V.rows() != rows || z.V.cols() != rows) {
      ++counters_.malformed;
    } else if (seen_.size() == index(spec_.detections_max)) {
      ++counters_.beyond_capacity;
    } else {
      seen_.push_back(z);
    }
  }
  std::sort(seen_.begin(), seen_.end(), is_before);
  const auto is_unexplained = [&](const models::Measurement& z) {
    const auto found = posterior_moments(nothing_known(input.observation.from), input.sensor,
                                         input.observation.from, z);
    if (found) {
      found_.push_back(*found);
    }
    return !found;
  };
  counters_.malformed += static_cast<std::int64_t>(std::erase_if(seen_, is_unexplained));
}

void MultiTargetFilter::expect_misses(const std::vector<LabelledTrack>& tracks,
                                      const Input& input) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    missed_probability_[i] = 0.0;
    for (std::size_t k = 0; k < tracks[i].mixture.size(); ++k) {
      const Component& component = tracks[i].mixture[k];
      Component& missed = missed_[at(i, k)];
      double probability = 1.0;
      missed.belief = missed_detection(component.belief, input.sensor, input.observation.from,
                                       spec_.world, input.detection_probability, &probability);
      if (spec_.estimator.detection_probability <= 0.0) {
        missed.belief = component.belief;
      }
      missed.weight = component.weight * probability;
      missed_probability_[i] += missed.weight;
    }
  }
}

void MultiTargetFilter::weigh(const std::vector<LabelledTrack>& tracks, const Input& input) {
  association_.start(static_cast<int>(tracks.size()), static_cast<int>(seen_.size()));
  const double gate2 = spec_.gate_sigma * spec_.gate_sigma;
  const double intensity_per_m2 =
      input.clutter_per_m2 + (spec_.tracker == Tracker::kLabelled ? input.untracked_per_m2 : 0.0);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const double r = existence_of(tracks[i]);
    for (std::size_t j = 0; j < seen_.size(); ++j) {
      double fit_per_m2 = 0.0;
      for (std::size_t k = 0; k < tracks[i].mixture.size(); ++k) {
        const Component& component = tracks[i].mixture[k];
        double& fit = fit_per_m2_[at(i, k) * index(spec_.detections_max) + j];
        const models::PositionVector off_m = found_[j].mean_m - component.belief.mean.head<2>();
        const models::PositionMatrix S =
            found_[j].covariance_m2 + component.belief.covariance.topLeftCorner<2, 2>();
        const Eigen::LLT<models::PositionMatrix> root(S);
        const double d2 = off_m.dot(root.solve(off_m));
        const double scale_m2 = 2.0 * kPi * root.matrixLLT().diagonal().prod();
        fit = d2 > gate2 ? 0.0 : std::exp(-0.5 * d2) / scale_m2;
        fit_per_m2 += component.weight * fit;
      }
      const double reported = r * input.detection_probability * fit_per_m2 / intensity_per_m2;
      const double not_reported = 1.0 - r + r * missed_probability_[i];
      association_.set(static_cast<int>(i), static_cast<int>(j), reported / not_reported);
    }
  }
}

void MultiTargetFilter::share_out(bool is_exclusive) {
  const std::span<const int> best = association_.best();
  for (std::size_t i = 0; i < best.size(); ++i) {
    for (std::size_t j = 0; j < seen_.size(); ++j) {
      const int detection = static_cast<int>(j);
      const bool is_own = best[i] == detection;
      const bool is_anothers =
          !is_own && std::find(best.begin(), best.end(), detection) != best.end();
      if (is_anothers || (is_exclusive && !is_own)) {
        association_.set(static_cast<int>(i), detection, 0.0);
      } else if (is_exclusive) {  // certain association
        association_.set(static_cast<int>(i), detection, 1e12);
      }
    }
  }
}

models::Gaussian MultiTargetFilter::posterior_given(const models::Gaussian& belief, std::size_t j,
                                                    double weight, const Input& input) const {
  if (weight >= kExactFrom) {
    auto information = models::to_information(belief);
    if (information &&
        measure(*information, input.sensor, input.observation.from, seen_[j], 0.0) == Use::kUsed) {
      if (const auto exact = models::to_gaussian(*information)) {
        return *exact;
      }
    }
  }
  models::MeasurementJacobian H = models::MeasurementJacobian::Zero(2, belief.mean.size());
  H.leftCols(2).setIdentity();
  return models::update(belief, H, found_[j].covariance_m2,
                        found_[j].mean_m - belief.mean.head<2>());
}

void MultiTargetFilter::mix(std::size_t i, LabelledTrack& track, const Input& input) {
  const int row = static_cast<int>(i);
  const double r = existence_of(track);
  const double not_reported = 1.0 - r + r * missed_probability_[i];
  const double missed = association_.miss_probability(row) * r / not_reported;
  mixture_.clear();
  for (std::size_t k = 0; k < track.mixture.size(); ++k) {
    mixture_.push_back({missed * missed_[at(i, k)].weight, missed_[at(i, k)].belief});
  }
  double seen = 0.0;
  for (std::size_t j = 0; j < seen_.size(); ++j) {
    const double probability = association_.probability(row, static_cast<int>(j));
    if (!(probability > 0.0)) {
      continue;
    }
    const auto fit = [&](std::size_t k) {
      return track.mixture[k].weight * fit_per_m2_[at(i, k) * index(spec_.detections_max) + j];
    };
    double total = 0.0;
    for (std::size_t k = 0; k < track.mixture.size(); ++k) {
      total += fit(k);
    }
    seen += probability;
    for (std::size_t k = 0; k < track.mixture.size(); ++k) {
      const double weight = probability * fit(k) / total;
      if (weight > kWeightMin * kWeightMin) {
        mixture_.push_back({weight, posterior_given(track.mixture[k].belief, j, weight, input)});
      }
    }
  }
  track.existence = std::min(1.0, missed * missed_probability_[i] + seen);
  if (seen > 0.5) {
    track.last_seen = std::max(track.last_seen, input.observation.time);
  }
  const bool is_mixture = spec_.tracker == Tracker::kLabelled;
  reduce(mixture_, spec_.components_max,
         is_mixture ? kMerge_sigma : std::numeric_limits<double>::infinity(),
         is_mixture ? kWeightMin : 0.0);
  track.mixture.assign(mixture_.begin(), mixture_.end());
  double sum = 0.0;
  for (const Component& component : track.mixture) {
    sum += component.weight;
  }
  for (Component& component : track.mixture) {
    component.weight /= sum;
  }
}

void MultiTargetFilter::count_hits(std::vector<LabelledTrack>& tracks, const Input& input) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const double seen = 1.0 - association_.miss_probability(static_cast<int>(i));
    const bool is_expected = 1.0 - missed_probability_[i] > 0.5 * input.detection_probability;
    if (seen > 0.5) {
      ++tracks[i].hits;
      tracks[i].misses = 0;
    } else if (is_expected) {
      ++tracks[i].misses;
    }
  }
}

// P(track i exists | at most N exist) = r_i P(at most N − 1 of the other tracks exist) / P(at most
// N exist).
void MultiTargetFilter::keep_to_number(std::vector<LabelledTrack>& tracks) {
  const std::size_t counts = index(spec_.targets) + 1;
  const std::size_t n = tracks.size();
  const auto r = [&](std::size_t i) { return tracks[i].existence; };
  before_.assign((n + 1) * counts, 0.0);
  after_.assign((n + 1) * counts, 1.0);
  before_[0] = 1.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < counts; ++c) {
      const double one_less = c > 0 ? before_[i * counts + c - 1] : 0.0;
      before_[(i + 1) * counts + c] = (1.0 - r(i)) * before_[i * counts + c] + r(i) * one_less;
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t c = 0; c < counts; ++c) {
      const double one_less = c > 0 ? after_[(i + 1) * counts + c - 1] : 0.0;
      after_[i * counts + c] = (1.0 - r(i)) * after_[(i + 1) * counts + c] + r(i) * one_less;
    }
  }
  const double at_most = after_[counts - 1];
  for (std::size_t i = 0; i < n && at_most > 0.0; ++i) {
    double others = 0.0;
    for (std::size_t c = 0; c + 1 < counts; ++c) {
      others += before_[i * counts + c] * after_[(i + 1) * counts + counts - 2 - c];
    }
    tracks[i].existence = std::min(1.0, r(i) * others / at_most);
  }
}

void MultiTargetFilter::delete_tracks(std::vector<LabelledTrack>& tracks) {
  for (LabelledTrack& track : tracks) {
    const int most = track.hits >= kHitsToConfirm ? kMissesOfConfirmed : kMissesOfTentative;
    const bool is_over = spec_.tracker == Tracker::kLabelled ? track.existence < kExistenceMin
                                                             : track.misses >= most;
    if (track.existence > 0.0 && is_over) {
      track.existence = 0.0;
      track.mixture.clear();
      ++counters_.deaths;
    }
  }
}

void MultiTargetFilter::start_tracks(std::vector<LabelledTrack>& tracks, const Input& input) {
  const double share = input.untracked_per_m2 / (input.untracked_per_m2 + input.clutter_per_m2);
  const bool is_labelled = spec_.tracker == Tracker::kLabelled;
  const int source = input.observation.source;
  const int label = first_label(input.observation.time, source < 0 ? kLabelledRobots - 1 : source);
  for (std::size_t j = 0; j < seen_.size(); ++j) {
    const double unassigned = association_.unassigned_probability(static_cast<int>(j));
    const double existence = is_labelled ? unassigned * share : 1.0;
    if (is_labelled ? existence < kExistenceMin : unassigned < 0.5) {
      continue;
    }
    const auto least = std::min_element(tracks.begin(), tracks.end(),
                                        [](auto& a, auto& b) { return a.existence < b.existence; });
    const auto found = discover(spec_.estimator, input.sensor, input.observation.from, seen_[j]);
    const auto belief = found ? models::to_gaussian(*found) : std::nullopt;
    if (!belief || !(least->existence < existence)) {
      counters_.beyond_capacity += belief ? 1 : 0;
      counters_.malformed += belief ? 0 : 1;
      continue;
    }
    counters_.deaths += least->existence > 0.0 ? 1 : 0;
    ++counters_.births;
    least->existence = existence;
    least->mixture.assign(1, Component{1.0, *belief});
    least->last_seen = input.observation.time;
    least->label = label + static_cast<int>(j);
    least->hits = 1;
    least->misses = 0;
  }
}

}  // namespace vantage::estimator
