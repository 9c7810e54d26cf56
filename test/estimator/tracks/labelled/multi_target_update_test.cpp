#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/check.hpp"
#include "estimator/posterior/missed_detection.hpp"
#include "estimator/tracks/gaussian/track.hpp"
#include "estimator/tracks/labelled/multi_target.hpp"
#include "estimator/tracks/labelled/track_labels.hpp"
#include "models/sensor/clutter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/tracks/labelled/lab_tracks.hpp"
#include "test/support/near.hpp"

// Tests of the update of tracks without ids by one scan, and of tracks that are confirmed and
// deleted by counts.

namespace vantage::estimator {
namespace {

using test::at;
using test::instant;
using test::lab_sensor;
using vantage::test::is_near;

MultiTargetSpec spec_of(int targets, models::DetectionModel detection,
                        Tracker tracker = Tracker::kLabelled) {
  MultiTargetSpec spec = test::spec_of(targets, detection, tracker);
  spec.world.bounds.max_m.y() = 3.0;  // area 56 m²
  spec.tracks_max = targets + 2;
  return spec;
}

Component part(double weight, double x_m, double y_m, double sigma_m) {
  return {weight,
          {Eigen::Vector2d(x_m, y_m), sigma_m * sigma_m * models::StateMatrix::Identity(2, 2)}};
}

LabelledTrack track_of(double existence, Mixture mixture) {
  LabelledTrack track;
  track.existence = existence;
  track.last_seen = instant(0);
  track.mixture = std::move(mixture);
  return track;
}

/// Returns the noise-free detection of a target at (x_m, y_m).
models::Detection seen(const models::Viewpoint& from, double x_m, double y_m) {
  const models::PositionVector there_m = Eigen::Vector2d(x_m, y_m);
  return {models::kNoTargetId,
          {models::observe(lab_sensor(), from, there_m),
           models::noise_covariance(lab_sensor(), from, there_m)}};
}

double density(const Eigen::Vector2d& off_m, const Eigen::Matrix2d& S_m2) {
  return std::exp(-0.5 * off_m.dot(S_m2.inverse() * off_m)) /
         (2.0 * kPi * std::sqrt(S_m2.determinant()));
}

// One track has two components at the edge of view, and one detection is between them. The expected
// values are computed by Bayes' rule over all hypotheses.
TEST(MultiTargetUpdate, AgreesWithBayesRuleForOneTrackAndOneDetection) {
  const models::SensorModel sensor = lab_sensor();
  const models::DetectionModel detection{0.8, 0.7};
  const MultiTargetSpec spec = spec_of(3, detection);
  const models::Viewpoint from = at(0.2, -0.3, 0.4);
  const Mixture parts = {part(0.7, 2.6, 0.1, 0.3), part(0.3, 1.9, 1.3, 0.25)};
  const models::Detection z = seen(from, 2.3, 0.5);
  constexpr double r = 0.6;

  MultiTargetFilter filter(spec);
  auto tracks = filter.no_tracks();
  tracks[1] = track_of(r, parts);
  tracks[1].label = 77;
  filter.update(tracks, {instant(4), 0, from, {z}}, sensor);

  // The posterior of the detection alone, without a track.
  scenario::EstimatorSpec vague = spec.estimator;
  const models::Gaussian found =
      models::to_gaussian(*discover(vague, sensor, from, z.measurement)).value();
  const double untracked_per_m2 = (3.0 - r) * 0.8 / 56.0;
  const double clutter_per_m2 = 0.7 / models::view_area_m2(sensor, from);
  double missed = 0.0;
  double fit = 0.0;
  std::vector<std::pair<double, models::Gaussian>>
      all;  // every posterior component with its weight
  std::vector<double> fits;
  for (const Component& one : parts) {
    double probability = 0.0;
    const models::Gaussian unseen =
        missed_detection(one.belief, sensor, from, spec.world, 0.8, &probability);
    all.emplace_back(r * one.weight * probability, unseen);
    missed += one.weight * probability;
    fits.push_back(one.weight * density(found.mean - one.belief.mean,
                                        Eigen::Matrix2d(found.covariance + one.belief.covariance)));
    fit += fits.back();
  }
  for (std::size_t k = 0; k < 2; ++k) {
    models::Information information = models::to_information(parts[k].belief).value();
    ASSERT_EQ(measure(information, sensor, from, z.measurement, 0.0), Use::kUsed);
    all.emplace_back(r * 0.8 * fits[k] / (clutter_per_m2 + untracked_per_m2),
                     models::to_gaussian(information).value());
  }
  const double reported = all[2].first + all[3].first;
  const double not_there = 1.0 - r;
  const double total = not_there + r * missed + reported;
  EXPECT_NEAR(tracks[1].existence, 1.0 - not_there / total, 1e-6);
  EXPECT_EQ(tracks[1].label, 77);
  EXPECT_EQ(tracks[1].last_seen, instant(reported / total > 0.5 ? 4 : 0));
  Mixture mixture;
  for (const auto& [weight, belief] : all) {
    mixture.push_back({weight, belief});
  }
  const models::Gaussian whole = moments(mixture);
  EXPECT_TRUE(is_near(moments(tracks[1].mixture).mean, whole.mean, 1e-4));
  EXPECT_TRUE(is_near(moments(tracks[1].mixture).covariance, whole.covariance, 1e-4));
  double weights = 0.0;
  for (const Component& component : tracks[1].mixture) {
    weights += component.weight;
  }
  EXPECT_NEAR(weights, 1.0, 1e-12);
  // A detection that belongs to no track comes from an untracked target or is a false alarm.
  const double nobodys = 1.0 - reported / total;
  const double birth = nobodys * untracked_per_m2 / (untracked_per_m2 + clutter_per_m2);
  ASSERT_GT(birth, 0.01);
  EXPECT_NEAR(tracks[0].existence, birth, 1e-6);
  EXPECT_EQ(tracks[0].label, first_label(instant(4), 0));
  EXPECT_EQ(tracks[0].last_seen, instant(4));
  EXPECT_TRUE(is_near(moments(tracks[0].mixture).mean, found.mean, 1e-9));
  EXPECT_EQ(filter.counters().births, 1);
  EXPECT_EQ(filter.counters().deaths, 0);
}

// A detection more than 4σ from every component of a track is not assigned to it.
TEST(MultiTargetUpdate, GatesDetectionsBeyondFourSigma) {
  const models::Viewpoint from = at(0.0, 0.0);
  const models::Detection z = seen(from, 2.0, 0.0);
  for (const auto& [sigmas, is_within] : {std::pair(3.98, true), std::pair(4.02, false)}) {
    for (const double side : {-1.0, 1.0}) {
      MultiTargetFilter filter(spec_of(1, {0.8, 0.0}));
      auto tracks = filter.no_tracks();
      const models::Gaussian found =
          models::to_gaussian(*discover(filter.spec().estimator, lab_sensor(), from, z.measurement))
              .value();
      const double sigma_m = std::sqrt(found.covariance(0, 0) + 0.04);
      tracks[0] =
          track_of(1.0, {part(1.0, found.mean(0) + side * sigmas * sigma_m, found.mean(1), 0.2)});
      filter.update(tracks, {instant(1), 0, from, {z}}, lab_sensor());
      const double moved_m = std::abs(moments(tracks[0].mixture).mean(0) - found.mean(0));
      EXPECT_EQ(moved_m < (sigmas - 0.5) * sigma_m, is_within) << side;
    }
  }
}

// The existence probability r becomes r (1 − p) / (1 − r p). Here p is the smaller of the filter's
// and the sensor's detection probability, at most 0.99. If the filter's probability is 0, the
// position does not change.
TEST(MultiTargetUpdate, EmptyScanUsesSmallerDetectionProbability) {
  const auto after = [](double believed, double true_probability) {
    MultiTargetSpec spec = spec_of(2, {true_probability, 0.5});
    spec.estimator.detection_probability = believed;
    MultiTargetFilter filter(spec);
    auto tracks = filter.no_tracks();
    tracks[0] = track_of(0.7, {part(1.0, 1.0, 0.5, 0.02)});
    tracks[1] = track_of(0.7, {part(1.0, 2.9, 0.0, 0.3)});
    filter.update(tracks, {instant(1), 0, at(0, 0), {}}, lab_sensor());
    EXPECT_EQ(tracks[1].mixture.at(0).belief.mean(0) == 2.9, believed == 0.0);
    EXPECT_EQ(tracks[0].last_seen, instant(0));
    return tracks[0].existence;
  };
  const auto right = [](double p) { return 0.7 * (1.0 - p) / (1.0 - 0.7 * p); };
  EXPECT_NEAR(after(0.9, 0.6), right(0.6), 0.01);
  EXPECT_NEAR(after(0.6, 0.9), right(0.6), 0.01);
  EXPECT_NEAR(after(0.0, 0.6), right(0.6), 0.01);
  EXPECT_NEAR(after(1.0, 1.0), right(0.99), 0.004);
}

// The number of existing targets among n tracks of equal existence probability is binomial,
// truncated at N.
TEST(MultiTargetUpdate, LimitsTheNumberOfTargets) {
  constexpr double r = 0.4;
  for (const int targets : {1, 2, 3, 4}) {
    MultiTargetSpec spec = spec_of(targets, {0.8, 0.5});
    spec.tracks_max = 5;
    MultiTargetFilter filter(spec);
    auto tracks = filter.no_tracks();
    constexpr int kTracks = 5;
    for (int i = 0; i < kTracks; ++i) {
      tracks[static_cast<std::size_t>(i)] = track_of(r, {part(1.0, 3.8, -3.0 + i, 0.01)});
    }
    filter.update(tracks, {instant(1), 0, at(-1.0, 0.0), {}}, lab_sensor());
    const auto at_most = [](int n, int most) {
      double sum = 0.0;
      for (int k = 0; k <= std::min(n, most); ++k) {
        sum += std::tgamma(n + 1.0) / std::tgamma(k + 1.0) / std::tgamma(n - k + 1.0) *
               std::pow(r, k) * std::pow(1.0 - r, n - k);
      }
      return sum;
    };
    for (const LabelledTrack& track : tracks) {
      EXPECT_NEAR(track.existence,
                  r * at_most(kTracks - 1, targets - 1) / at_most(kTracks, targets), 1e-9);
    }
  }
}

// At least 0.05 targets are assumed to be untracked, and at least 0.001 false alarms per scan are
// assumed.
TEST(MultiTargetUpdate, AlwaysAllowsABirthAndAFalseAlarm) {
  const models::Viewpoint from = at(0, 0);
  const models::Detection z = seen(from, 1.0, 1.0);
  for (const auto& [of_tracked, clutter] : {std::pair(1.0, 0.5), std::pair(0.3, 0.0)}) {
    MultiTargetFilter filter(spec_of(1, {0.9, clutter}));
    auto tracks = filter.no_tracks();
    tracks[0] = track_of(of_tracked, {part(1.0, 3.8, -3.8, 0.01)});  // out of view
    filter.update(tracks, {instant(1), 0, from, {z}}, lab_sensor());
    const double untracked = std::max(0.05, 1.0 - of_tracked) * 0.9 / 56.0;
    const double alarms = std::max(1e-3, clutter) / models::view_area_m2(lab_sensor(), from);
    EXPECT_NEAR(tracks[1].existence, untracked / (untracked + alarms), 1e-9);
  }
}

// When the table is full, a birth replaces the least likely track if the birth is likelier.
TEST(MultiTargetUpdate, BirthReplacesLeastLikelyTrackWhenFull) {
  const models::Viewpoint from = at(0, 0);
  const models::Detection z = seen(from, 1.0, 1.0);
  for (const double least : {0.02, 0.6}) {
    MultiTargetSpec spec = spec_of(3, {0.9, 1.0});
    spec.tracks_max = 3;
    MultiTargetFilter filter(spec);
    auto tracks = filter.no_tracks();
    const double existences[] = {0.9, least, 0.7};
    for (std::size_t i = 0; i < 3; ++i) {
      tracks[i] = track_of(existences[i], {part(1.0, 3.8, -3.8 + static_cast<double>(i), 0.01)});
      tracks[i].label = 40 + static_cast<int>(i);
      tracks[i].misses = 1;
    }
    filter.update(tracks, {instant(1), 0, from, {z}}, lab_sensor());
    const bool is_born = least < 0.5;
    EXPECT_EQ(tracks[1].label, is_born ? first_label(instant(1), 0) : 41);
    EXPECT_EQ(tracks[1].misses, is_born ? 0 : 1);
    EXPECT_EQ(tracks[0].label, 40);
    EXPECT_EQ(tracks[2].label, 42);
    EXPECT_EQ(filter.counters().births, is_born ? 1 : 0);
    EXPECT_EQ(filter.counters().deaths, is_born ? 1 : 0);
    EXPECT_EQ(filter.counters().beyond_capacity, is_born ? 0 : 1);
  }
}

TEST(MultiTargetUpdate, DeletesTracksBelowMinimumExistence) {
  for (const auto& [existence, is_kept] : {std::pair(0.0101, true), std::pair(0.0099, false)}) {
    MultiTargetFilter filter(spec_of(5, {0.9, 0.1}));
    auto tracks = filter.no_tracks();
    tracks[0] = track_of(existence, {part(1.0, 3.8, -3.8, 0.01)});
    filter.update(tracks, {instant(1), 0, at(0, 0), {}}, lab_sensor());
    EXPECT_EQ(tracks[0].existence > 0.0, is_kept);
    EXPECT_EQ(tracks[0].mixture.empty(), !is_kept);
    EXPECT_EQ(filter.counters().deaths, is_kept ? 0 : 1);
  }
}

// A track is confirmed at its third hit. It is deleted after two consecutive misses, or after five
// once it is confirmed. A scan that does not cover the track is not a miss.
TEST(TracksByCounts, AreConfirmedAndDeletedByHitsAndMisses) {
  const models::Viewpoint from = at(0, 0);
  const models::Detection z = seen(from, 1.0, 1.0);
  for (const Tracker tracker : {Tracker::kJpda, Tracker::kNearest}) {
    for (int hits = 1; hits <= 4; ++hits) {
      MultiTargetFilter filter(spec_of(2, {0.9, 0.1}, tracker));
      auto tracks = filter.no_tracks();
      int k = 1;
      for (; k <= hits; ++k) {
        filter.update(tracks, {instant(k), 0, from, {z}}, lab_sensor());
        EXPECT_EQ(tracks[0].hits, k);
        EXPECT_EQ(filter.is_confirmed(tracks[0]), k >= 3);
        EXPECT_EQ(tracks[0].last_seen, instant(k));
        EXPECT_EQ(tracks[0].mixture.size(), 1U);
      }
      const int most = hits >= 3 ? 5 : 2;
      for (int miss = 1; miss < most; ++miss) {
        filter.update(tracks, {instant(k++), 0, from, {}}, lab_sensor());
        EXPECT_EQ(tracks[0].misses, miss);
        filter.update(tracks, {instant(k++), 0, at(-3.9, -3.9), {}}, lab_sensor());
        EXPECT_EQ(tracks[0].misses, miss) << "out of view";
      }
      MultiTargetFilter other = filter;
      auto seen_again = tracks;
      other.update(seen_again, {instant(k), 0, from, {z}}, lab_sensor());
      EXPECT_EQ(seen_again[0].misses, 0);
      EXPECT_EQ(seen_again[0].hits, hits + 1);
      EXPECT_EQ(filter.counters().deaths, 0);
      filter.update(tracks, {instant(k), 0, from, {}}, lab_sensor());
      EXPECT_EQ(tracks[0].existence, 0.0);
      EXPECT_EQ(filter.counters().deaths, 1);
      EXPECT_FALSE(filter.is_confirmed(tracks[0])) << "for any number of hits";
    }
  }
}

// The likelier of two possible tracks gets the detection, and the other track counts as missed.
// Joint association (JPDA) distributes the detection over both tracks.
TEST(MultiTargetUpdate, AssignsADetectionToOneTrackByDefault) {
  const models::Viewpoint from = at(0, 0);
  const models::Detection z = seen(from, 1.5, 0.0);
  for (const Tracker tracker : {Tracker::kLabelled, Tracker::kNearest, Tracker::kJpda}) {
    for (const bool is_nearer_first : {false, true}) {
      MultiTargetFilter filter(spec_of(3, {0.8, 0.2}, tracker));
      auto tracks = filter.no_tracks();
      const std::size_t nearer = is_nearer_first ? 0 : 2;
      const std::size_t other = 2 - nearer;
      tracks[nearer] = track_of(0.9, {part(1.0, 1.5, 0.1, 0.2)});
      tracks[other] = track_of(0.9, {part(1.0, 1.5, -0.2, 0.2)});
      filter.update(tracks, {instant(1), 0, from, {z}}, lab_sensor());
      const double moved_m = moments(tracks[other].mixture).mean(1) + 0.2;
      EXPECT_EQ(std::abs(moved_m) > 0.01, tracker == Tracker::kJpda) << moved_m;
      EXPECT_LT(moments(tracks[nearer].mixture).mean(1), 0.08);
      EXPECT_EQ(tracks[nearer].last_seen, instant(1));
      EXPECT_EQ(tracks[other].last_seen, instant(0));
      if (tracker == Tracker::kLabelled) {
        // The track is certainly in view: r (1 - p) / (1 - r p).
        EXPECT_NEAR(tracks[other].existence, 0.9 * 0.2 / (1.0 - 0.9 * 0.8), 1e-6);
      }
      if (tracker == Tracker::kNearest) {  // equals the update with a known id
        auto known = models::to_information(part(1.0, 1.5, 0.1, 0.2).belief).value();
        ASSERT_EQ(measure(known, lab_sensor(), from, z.measurement, 0.0), Use::kUsed);
        EXPECT_TRUE(
            is_near(moments(tracks[nearer].mixture).mean, models::to_gaussian(known)->mean, 1e-6));
      }
    }
  }
}

// Unassigned detections start tracks. Their labels are numbered by distance, not by the order of
// the detections.
TEST(MultiTargetUpdate, LabelsBirthsByDistance) {
  const models::Viewpoint from = at(0, 0);
  std::vector<models::Detection> look = {seen(from, 2.0, 0.0), seen(from, 0.0, 1.0),
                                         seen(from, -2.5, 0.0)};
  for (const Tracker tracker : {Tracker::kLabelled, Tracker::kNearest, Tracker::kJpda}) {
    for (int turn = 0; turn < 3; ++turn) {
      std::rotate(look.begin(), look.begin() + 1, look.end());
      MultiTargetFilter filter(spec_of(5, {0.9, 0.1}, tracker));
      auto tracks = filter.no_tracks();
      filter.update(tracks, {instant(1), 0, from, look}, lab_sensor());
      EXPECT_EQ(filter.counters().births, 3);
      for (std::size_t i = 0; i < 3; ++i) {
        const double range_m = moments(tracks[i].mixture).mean.norm();
        const double nearest_first[] = {1.0, 2.0, 2.5};
        EXPECT_EQ(tracks[i].label, first_label(instant(1), 0) + static_cast<int>(i));
        EXPECT_NEAR(range_m, nearest_first[i], 0.1) << "the nearest detection is first";
        EXPECT_EQ(tracks[i].hits, 1);
        EXPECT_EQ(tracks[i].mixture.at(0).weight, 1.0);
        EXPECT_EQ(tracks[i].existence == 1.0, tracker != Tracker::kLabelled);
      }
    }
  }
}

TEST(MultiTargetUpdate, CountsMalformedDetections) {
  const models::Viewpoint from = at(0, 0);
  const auto malformed = [&](auto change) {
    MultiTargetFilter filter(spec_of(5, {0.9, 0.1}));
    auto tracks = filter.no_tracks();
    std::vector<models::Detection> look = {seen(from, 1.0, 0.0), seen(from, 2.0, 0.0)};
    change(look[0].measurement);
    filter.update(tracks, {instant(1), 0, from, look}, lab_sensor());
    EXPECT_EQ(filter.counters().births + filter.counters().malformed, 2);
    return filter.counters().malformed;
  };
  EXPECT_EQ(malformed([](models::Measurement&) {}), 0);
  EXPECT_EQ(malformed([](models::Measurement& z) { z.z = z.z.head(1).eval(); }), 1);
  EXPECT_EQ(malformed([](models::Measurement& z) { z.V = z.V.topRows(1).eval(); }), 1);
  EXPECT_EQ(malformed([](models::Measurement& z) { z.V = z.V.leftCols(1).eval(); }), 1);
  EXPECT_EQ(malformed([](models::Measurement& z) { z.V.setZero(); }), 1)
      << "the measurement cannot be explained";
}

// Components within 1σ of a heavier one are merged; those with a weight below 0.001 are removed.
TEST(MultiTargetUpdate, KeepsSeparateComponentsOfSufficientWeight) {
  const auto parts_after = [](Mixture parts, Tracker tracker) {
    MultiTargetFilter filter(spec_of(1, {0.9, 0.1}, tracker));
    auto tracks = filter.no_tracks();
    tracks[0] = track_of(1.0, std::move(parts));
    filter.update(tracks, {instant(1), 0, at(3.0, 2.5), {}}, lab_sensor());  // out of view
    return tracks[0].mixture.size();
  };
  const auto two = [](double away_m) {
    return Mixture{part(0.6, -3.0, -3.0, 0.2), part(0.4, -3.0 + away_m, -3.0, 0.2)};
  };
  EXPECT_EQ(parts_after(two(0.199), Tracker::kLabelled), 1U);
  EXPECT_EQ(parts_after(two(0.201), Tracker::kLabelled), 2U);
  const auto light = [](double weight) {
    return Mixture{part(1.0 - weight, -3.0, -3.0, 0.1), part(weight, -1.0, -3.0, 0.1)};
  };
  EXPECT_EQ(parts_after(light(0.00099), Tracker::kLabelled), 1U);
  EXPECT_EQ(parts_after(light(0.00101), Tracker::kLabelled), 2U);
  EXPECT_EQ(MultiTargetFilter(spec_of(1, {}, Tracker::kJpda)).spec().components_max, 1);
  EXPECT_EQ(MultiTargetFilter(spec_of(1, {}, Tracker::kNearest)).spec().components_max, 1);
  EXPECT_EQ(MultiTargetFilter(spec_of(1, {})).spec().components_max, 6);
}

// A track counts as missed only if more than half of its probability mass is in view.
TEST(TracksByCounts, AreMissedWhenMostlyInView) {
  for (const auto& [x_m, is_missed] : {std::pair(2.9, true), std::pair(3.1, false)}) {
    MultiTargetFilter filter(spec_of(1, {0.9, 0.1}, Tracker::kNearest));
    auto tracks = filter.no_tracks();
    tracks[0] = track_of(1.0, {part(1.0, x_m, 0.0, 0.2)});
    tracks[0].hits = 3;
    filter.update(tracks, {instant(1), 0, at(0, 0), {}}, lab_sensor());
    EXPECT_EQ(tracks[0].misses, is_missed ? 1 : 0);
  }
}

// The uncertainty grows from the last observation on, once per step that has passed.
TEST(MultiTargetFilter, PropagatesByTheTimeSinceTheLastObservation) {
  MultiTargetSpec spec = spec_of(1, {});
  spec.estimator.target_model = {models::TargetKind::kGrowingUncertainty, 2, 0.01};
  MultiTargetFilter filter(spec);
  auto tracks = filter.no_tracks();
  tracks[0] = track_of(1.0, {part(0.6, 1.0, 2.0, 0.1), part(0.4, -1.0, 2.0, 0.2)});
  filter.propagate(tracks, instant(2),
                   instant(5));  // 2, 3 and 4 steps since the last observation
  EXPECT_NEAR(tracks[0].mixture[0].belief.covariance(0, 0), 0.01 + 0.01 * (2 + 3 + 4), 1e-12);
  EXPECT_NEAR(tracks[0].mixture[1].belief.covariance(1, 1), 0.04 + 0.01 * (2 + 3 + 4), 1e-12);
  EXPECT_EQ(tracks[0].mixture[1].belief.mean, part(1.0, -1.0, 2.0, 1.0).belief.mean);
}

TEST(MultiTargetFilter, RefusesEachInvalidSpec) {
  const auto is_refused = [](auto change) {
    MultiTargetSpec spec = spec_of(3, {});
    change(spec);
    try {
      MultiTargetFilter filter(spec);
    } catch (const UsageError&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused([](MultiTargetSpec& spec) { spec.tracks_max = 3; }));
  EXPECT_TRUE(is_refused([](MultiTargetSpec& spec) { spec.tracks_max = 2; }));
  EXPECT_FALSE(is_refused([](MultiTargetSpec& spec) { spec.targets = 1; }));
  EXPECT_TRUE(is_refused([](MultiTargetSpec& spec) { spec.targets = 0; }));
  EXPECT_FALSE(is_refused([](MultiTargetSpec& spec) { spec.detections_max = 1; }));
  EXPECT_TRUE(is_refused([](MultiTargetSpec& spec) { spec.detections_max = 0; }));
  EXPECT_FALSE(is_refused([](MultiTargetSpec& spec) { spec.components_max = 1; }));
  EXPECT_TRUE(is_refused([](MultiTargetSpec& spec) { spec.components_max = 0; }));
}

// Components with a posterior weight of at least 0.02 are updated by quadrature. Components with
// less weight get a linear update.
TEST(MultiTargetUpdate, IsExactForComponentsAboveTwoPercent) {
  const models::Viewpoint from = at(0, 0);
  const models::Gaussian before = part(1.0, 2.0, 0.0, 0.3).belief;
  double nearest_below = 0.0;
  double nearest_above = 1.0;
  for (double aside_m = 0.85; aside_m < 1.15; aside_m += 0.002) {
    MultiTargetFilter filter(spec_of(1, {0.9, 0.5}));
    auto tracks = filter.no_tracks();
    tracks[0] = track_of(1.0, {{1.0, before}});
    const std::vector<models::Detection> look = {seen(from, 2.0, 0.0), seen(from, 2.0, aside_m)};
    filter.update(tracks, {instant(1), 0, from, look}, lab_sensor());
    const Component* there = nullptr;
    for (const Component& component : tracks[0].mixture) {
      there = component.belief.mean(1) > 0.5 * aside_m ? &component : there;
    }
    ASSERT_NE(there, nullptr);
    auto exact = *models::to_information(before);
    ASSERT_EQ(measure(exact, lab_sensor(), from, look[1].measurement, 0.0), Use::kUsed);
    const models::Gaussian found = *models::to_gaussian(
        *discover(filter.spec().estimator, lab_sensor(), from, look[1].measurement));
    const models::Gaussian linear = models::update(before, Eigen::Matrix2d::Identity(),
                                                   found.covariance, found.mean - before.mean);
    ASSERT_GT((linear.mean - models::to_gaussian(exact)->mean).norm(), 1e-4);
    const bool is_exact = is_near(there->belief.mean, models::to_gaussian(exact)->mean, 1e-9);
    EXPECT_NE(is_exact, is_near(there->belief.mean, linear.mean, 1e-6));
    if (is_exact) {
      nearest_above = std::min(nearest_above, there->weight);
    } else {
      nearest_below = std::max(nearest_below, there->weight);
    }
  }
  EXPECT_NEAR(nearest_above, 0.02, 0.001);
  EXPECT_NEAR(nearest_below, 0.02, 0.001);
}

}  // namespace
}  // namespace vantage::estimator
