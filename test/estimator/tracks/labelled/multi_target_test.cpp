#include "estimator/tracks/labelled/multi_target.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "estimator/tracks/gaussian/track.hpp"
#include "models/sensor/clutter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/tracks/labelled/lab_tracks.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

namespace vantage::estimator {
namespace {

using test::at;
using test::instant;
using test::lab_sensor;
using test::spec_of;
using vantage::test::is_near;

LabelledTrack track_at(double x_m, double y_m, double sigma_m, double existence) {
  LabelledTrack track;
  track.existence = existence;
  track.last_seen = instant(0);
  track.mixture.push_back(
      {1.0, {Eigen::Vector2d(x_m, y_m), sigma_m * sigma_m * models::StateMatrix::Identity(2, 2)}});
  return track;
}

std::vector<models::Detection> detections_of(const models::DetectionModel& detection,
                                             const models::Viewpoint& from,
                                             const std::vector<Eigen::Vector2d>& targets_m,
                                             std::mt19937_64& rng) {
  const models::SensorModel sensor = lab_sensor();
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<models::Detection> out;
  for (const Eigen::Vector2d& y_m : targets_m) {
    if (models::in_view(sensor, from, y_m) && share(rng) < detection.detection_probability) {
      out.push_back({-1, models::sample(sensor, from, y_m, rng)});
    }
  }
  for (const models::Measurement& z :
       models::sample_clutter(sensor, from, detection.clutter_per_look, rng)) {
    out.push_back({-1, z});
  }
  return out;
}

TEST(MultiTargetFilter, EqualsTheKnownIdFilterForOneCertainTarget) {
  const models::SensorModel sensor = lab_sensor();
  MultiTargetFilter filter(spec_of(1, {1.0, 0.0}));
  auto tracks = filter.no_tracks();
  tracks[0] = track_at(1.0, 0.5, 0.2, 1.0);
  auto known = models::to_information(tracks[0].mixture[0].belief).value();
  std::mt19937_64 rng(1);
  const models::Viewpoint from = at(0.0, 0.0);
  const models::Measurement z = models::sample(sensor, from, Eigen::Vector2d(1.1, 0.4), rng);
  ASSERT_EQ(measure(known, sensor, from, z, 0.0), Use::kUsed);
  const std::vector<models::Detection> look = {{-1, z}};
  filter.update(tracks, {instant(1), 0, from, look}, sensor);
  const models::Gaussian seen = moments(tracks[0].mixture);
  EXPECT_TRUE(is_near(seen.mean, models::to_gaussian(known)->mean, 1e-3));
  EXPECT_TRUE(is_near(seen.covariance, models::to_gaussian(known)->covariance, 1e-3));
  EXPECT_GT(tracks[0].existence, 0.999);
  EXPECT_EQ(tracks[0].last_seen, instant(1));
}

// If a target in view is missed, its existence probability r becomes r (1 − p_D) / (1 − r p_D).
TEST(MultiTargetFilter, LowersTheExistenceOfMissedTargets) {
  MultiTargetFilter filter(spec_of(3, {0.8, 0.5}));
  auto tracks = filter.no_tracks();
  tracks[0] = track_at(1.0, 0.5, 0.05, 0.7);
  tracks[1] = track_at(3.9, 3.9, 0.01, 0.6);  // beyond the sensor's range
  filter.update(tracks, {instant(1), 0, at(0.0, 0.0), {}}, lab_sensor());
  EXPECT_NEAR(tracks[0].existence, 0.7 * 0.2 / (1.0 - 0.7 * 0.8), 1e-9);
  EXPECT_NEAR(tracks[1].existence, 0.6, 1e-9);
}

// There are two tracks of existence r and at most one target: each track has r (1 − r) / (1 − r²).
TEST(MultiTargetFilter, EstimatesTheNumberOfTargets) {
  MultiTargetFilter filter(spec_of(1, {0.8, 0.5}));
  auto tracks = filter.no_tracks();
  tracks[0] = track_at(3.9, 3.9, 0.01, 0.6);
  tracks[1] = track_at(-3.9, 3.9, 0.01, 0.6);
  filter.update(tracks, {instant(1), 0, at(0.0, 0.0), {}}, lab_sensor());
  EXPECT_NEAR(tracks[0].existence, 0.6 * 0.4 / (1.0 - 0.36), 1e-9);
  EXPECT_NEAR(tracks[1].existence, tracks[0].existence, 1e-12);
}

// The existence of a new track is the intensity of untracked targets divided by that of all
// detections without a track.
TEST(MultiTargetFilter, WeightsABirthAgainstFalseAlarms) {
  const models::SensorModel sensor = lab_sensor();
  MultiTargetFilter filter(spec_of(3, {0.9, 2.0}));
  auto tracks = filter.no_tracks();
  std::mt19937_64 rng(1);
  const models::Viewpoint from = at(0.0, 0.0);
  const std::vector<models::Detection> look = {
      {-1, models::sample(sensor, from, Eigen::Vector2d(1.0, 1.0), rng)}};
  filter.update(tracks, {instant(1), 0, from, look}, sensor);
  const double untracked = 3.0 * 0.9 / 64.0;
  const double clutter = 2.0 / models::view_area_m2(sensor, from);
  EXPECT_NEAR(tracks[0].existence, untracked / (untracked + clutter), 1e-9);
  EXPECT_EQ(filter.counters().births, 1);
  EXPECT_FALSE(filter.is_confirmed(tracks[0]));
}

// Returns the tracks after scans of stationary targets from positions on a circle.
std::vector<LabelledTrack> tracked(const MultiTargetSpec& spec, double turned_rad, bool is_reversed,
                                   int steps) {
  MultiTargetFilter filter(spec);
  auto tracks = filter.no_tracks();
  std::mt19937_64 rng(7);
  const Eigen::Rotation2D<double> turn(turned_rad);
  std::vector<Eigen::Vector2d> targets_m = {{1.0, 0.5}, {-1.2, 0.3}, {0.4, -1.5}};
  for (Eigen::Vector2d& y_m : targets_m) {
    y_m = turn * y_m;
  }
  for (int k = 1; k <= steps; ++k) {
    const Eigen::Vector2d eye_m = turn * Eigen::Vector2d(std::cos(0.3 * k), std::sin(0.3 * k));
    const models::Viewpoint from = at(eye_m.x(), eye_m.y(), 0.2 * k + turned_rad);
    auto look = detections_of(spec.detection, from, targets_m, rng);
    if (is_reversed) {
      std::reverse(look.begin(), look.end());
    }
    filter.propagate(tracks, instant(k - 1), instant(k));
    filter.update(tracks, {instant(k), 0, from, look}, lab_sensor());
  }
  return tracks;
}

TEST(MultiTargetFilter, IsIndependentOfDetectionOrder) {
  for (const Tracker tracker : {Tracker::kLabelled, Tracker::kJpda, Tracker::kNearest}) {
    const auto one = tracked(spec_of(3, {0.8, 2.0}, tracker), 0.0, false, 30);
    const auto other = tracked(spec_of(3, {0.8, 2.0}, tracker), 0.0, true, 30);
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].existence, other[i].existence);
      ASSERT_EQ(one[i].mixture.size(), other[i].mixture.size());
      for (std::size_t c = 0; c < one[i].mixture.size(); ++c) {
        EXPECT_EQ(one[i].mixture[c].belief.mean, other[i].mixture[c].belief.mean);
        EXPECT_EQ(one[i].mixture[c].belief.covariance, other[i].mixture[c].belief.covariance);
      }
    }
  }
}

// The invariance is exact up to the quadrature error of empty scans, as the quadrature points are
// aligned with the world's axes.
TEST(MultiTargetFilter, IsInvariantToRotation) {
  const double turn_rad = 0.5 * kPi;  // maps the square world onto itself
  const auto plain = tracked(spec_of(3, {0.9, 1.0}), 0.0, false, 12);
  const auto turned = tracked(spec_of(3, {0.9, 1.0}), turn_rad, false, 12);
  const Eigen::Rotation2D<double> turn(turn_rad);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_NEAR(plain[i].existence, turned[i].existence, 1e-3);
    if (plain[i].existence > 0.5) {
      const Eigen::Vector2d mean_m = turn * Eigen::Vector2d(moments(plain[i].mixture).mean);
      EXPECT_TRUE(is_near(moments(turned[i].mixture).mean, mean_m, 1e-3));
    }
  }
}

TEST(MultiTargetFilter, FindsExactlyTheTargetsAmongFalseAlarms) {
  const MultiTargetSpec spec = spec_of(3, {0.8, 2.0});
  const MultiTargetFilter filter(spec);
  const auto tracks = tracked(spec, 0.0, false, 60);
  int confirmed = 0;
  for (const Eigen::Vector2d& y_m :
       {Eigen::Vector2d(1.0, 0.5), Eigen::Vector2d(-1.2, 0.3), Eigen::Vector2d(0.4, -1.5)}) {
    double nearest_m = 1e9;
    for (const LabelledTrack& track : tracks) {
      if (filter.is_confirmed(track)) {
        nearest_m = std::min(nearest_m, (moments(track.mixture).mean.head<2>() - y_m).norm());
      }
    }
    EXPECT_LT(nearest_m, 0.3);
  }
  for (const LabelledTrack& track : tracks) {
    confirmed += filter.is_confirmed(track) ? 1 : 0;
  }
  EXPECT_EQ(confirmed, 3);
}

// The mean NEES of one target among false alarms is 2 if the covariance is correct. The standard
// deviation of the mean over 100 runs is below 0.2.
TEST(MultiTargetFilter, IsConsistentAmongFalseAlarms) {
  const models::SensorModel sensor = lab_sensor();
  const MultiTargetSpec spec = spec_of(1, {0.89, 2.0});
  double sum = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    MultiTargetFilter filter(spec);
    std::mt19937_64 rng(seed);
    auto tracks = filter.no_tracks();
    Eigen::Vector2d y_m(1.0, 0.5);
    tracks[0] = track_at(1.0, 0.5, 0.3, 1.0);
    y_m += 0.3 * test::normal_vector(2, rng);
    for (int k = 1; k <= 20; ++k) {
      y_m += std::sqrt(0.02 * 0.5) * test::normal_vector(2, rng);
      filter.propagate(tracks, instant(k - 1), instant(k));
      filter.update(tracks,
                    {instant(k), 0, at(0.0, 0.0, 0.1 * k),
                     detections_of(spec.detection, at(0.0, 0.0, 0.1 * k), {y_m}, rng)},
                    sensor);
      const models::Gaussian belief = moments(tracks[0].mixture);
      const Eigen::Vector2d error_m = belief.mean - y_m;
      sum += error_m.dot(belief.covariance.llt().solve(models::StateVector(error_m)));
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 2.0, 0.4);
}

TEST(MultiTargetFilter, AllocatesNothing) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "a sanitizer replaces the allocator";
  }
  const models::SensorModel sensor = lab_sensor();
  MultiTargetFilter filter(spec_of(3, {0.8, 5.0}));
  auto tracks = filter.no_tracks();
  std::mt19937_64 rng(1);
  std::vector<Observation> looks;
  for (int k = 1; k <= 40; ++k) {
    looks.push_back(
        {instant(k), 0, at(0.0, 0.0),
         detections_of(filter.spec().detection, at(0.0, 0.0), {{1.0, 0.5}, {-1.0, 0.2}}, rng)});
  }
  filter.update(tracks, {instant(0), 0, at(0.0, 0.0), {}}, sensor);
  const vantage::test::AllocationCounter allocations;
  for (const Observation& look : looks) {
    filter.propagate(tracks, look.time - from_seconds(0.5), look.time);
    filter.update(tracks, look, sensor);
  }
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(MultiTargetFilter, CountsUnusableInputs) {
  MultiTargetSpec spec = spec_of(1, {0.9, 1.0});
  spec.detections_max = 1;
  MultiTargetFilter filter(spec);
  auto tracks = filter.no_tracks();
  const models::SensorModel sensor = lab_sensor();
  std::mt19937_64 rng(1);
  const models::Measurement z = models::sample(sensor, at(0, 0), Eigen::Vector2d(1.0, 0.0), rng);
  models::Measurement bearing;
  bearing.z = z.z.tail(1);
  bearing.V = z.V.bottomRightCorner(1, 1);
  const std::vector<models::Detection> look = {{-1, bearing}, {-1, z}, {-1, z}};
  filter.update(tracks, {instant(1), 0, at(0, 0), look}, sensor);
  EXPECT_EQ(filter.counters().malformed, 1);
  EXPECT_EQ(filter.counters().beyond_capacity, 1);
}

// A range alone cannot start a track.
TEST(MultiTargetFilter, CountsDetectionsWithoutViewpoint) {
  MultiTargetFilter filter(spec_of(1, {0.9, 1.0}));
  auto tracks = filter.no_tracks();
  models::SensorModel sensor = lab_sensor();
  sensor.kind = models::SensorKind::kRange;
  std::mt19937_64 rng(1);
  const models::Measurement z = models::sample(sensor, at(0, 0), Eigen::Vector2d(1.0, 0.0), rng);
  const std::vector<models::Detection> look = {{-1, z}, {-1, z}};
  filter.update(tracks, {instant(1), 0, at(0, 0), look}, sensor);
  EXPECT_EQ(filter.counters().malformed, 2);
  EXPECT_EQ(filter.counters().births, 0);
}

TEST(MultiTargetFilter, RefusesInvalidSpecs) {
  MultiTargetSpec spec = spec_of(3, {});
  spec.tracks_max = 2;
  EXPECT_THROW(MultiTargetFilter{spec}, UsageError);
  spec = spec_of(3, {});
  spec.estimator.target_model = {models::TargetKind::kRandomWalk, 3, 0.02};
  EXPECT_THROW(MultiTargetFilter{spec}, UsageError);
}

}  // namespace
}  // namespace vantage::estimator
