#include "estimator/tracks/labelled/track_labels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/estimator/filter_support.hpp"

namespace vantage::estimator {
namespace {

using test::instant;

models::Gaussian at_m(double x_m, double y_m, double sigma_m) {
  return {Eigen::Vector2d(x_m, y_m), sigma_m * sigma_m * models::StateMatrix::Identity(2, 2)};
}

LabelledTrack own(int label, const models::Gaussian& belief, double existence = 0.95) {
  LabelledTrack track;
  track.existence = existence;
  track.label = label;
  track.last_seen = instant(0);
  track.mixture.push_back({1.0, belief});
  return track;
}

ReceivedLabel theirs(int label, const models::Gaussian& belief) {
  return {0, instant(1), label, belief, instant(1)};
}

std::vector<int> labels_of(const std::vector<LabelledTrack>& tracks) {
  std::vector<int> labels;
  for (const LabelledTrack& track : tracks) {
    if (track.existence > 0.0) {
      labels.push_back(track.label);
    }
  }
  return labels;
}

const int kOld = first_label(instant(1), 2);
const int kYoung = first_label(instant(2), 0);

TEST(TrackLabels, AreUniqueAndDifferFromTargetIds) {
  std::set<int> labels;
  for (int k = 0; k < 50; ++k) {
    for (int robot = 0; robot < kLabelledRobots; ++robot) {
      for (int j = 0; j < kLabelledDetections; ++j) {
        const int label = first_label(instant(0) + k * kLabelTick, robot) + j;
        EXPECT_GE(label, models::kTrackLabelMin);
        EXPECT_TRUE(labels.insert(label).second);
      }
    }
  }
  EXPECT_THROW(first_label(instant(0), kLabelledRobots), UsageError);
  EXPECT_THROW(first_label(instant(0), -1), UsageError);
}

TEST(TrackLabels, CompareAgesAcrossTheWrap) {
  EXPECT_TRUE(is_older(kOld, kYoung));
  EXPECT_FALSE(is_older(kYoung, kOld));
  EXPECT_FALSE(is_older(kOld, kOld));
  EXPECT_TRUE(is_older(first_label(instant(2), 0), first_label(instant(2), 1)));
  const Time last = from_utime(((1 << 20) - 1) * kLabelTick.count());
  EXPECT_TRUE(is_older(first_label(last, 31) + 31, first_label(last + kLabelTick, 0)));
}

TEST(Reconcile, ChangesNothingForEqualMeasurements) {
  std::vector<LabelledTrack> tracks = {own(kOld, at_m(1, 1, 0.2)), own(kYoung, at_m(1.1, 1, 0.2)),
                                       own(kYoung + 1, at_m(1.05, 1, 0.2), 0.3)};
  std::vector<ReceivedLabel> received = {theirs(kOld, at_m(1, 1, 0.2)),
                                         theirs(kYoung, at_m(1.1, 1, 0.2))};
  const Reconciled done = reconcile(tracks, received);
  EXPECT_EQ(done.relabelled + done.adopted + done.taken_over, 0);
  EXPECT_EQ(labels_of(tracks), (std::vector{kOld, kYoung, kYoung + 1}));
  EXPECT_EQ(tracks[2].existence, 0.3);
}

TEST(Reconcile, KeepsTheOlderLabelOnBothSides) {
  std::vector<LabelledTrack> one = {own(kYoung, at_m(1, 1, 0.2), 0.4)};
  std::vector<ReceivedLabel> received = {theirs(kOld, at_m(1.2, 1, 0.2))};
  EXPECT_EQ(reconcile(one, received).relabelled, 1);
  EXPECT_EQ(labels_of(one), std::vector{kOld});
  EXPECT_GE(one[0].existence, 0.5) << "a track that a teammate has confirmed is published";

  std::vector<LabelledTrack> other = {own(kOld, at_m(1.2, 1, 0.2))};
  received = {theirs(kYoung, at_m(1, 1, 0.2))};
  const Reconciled done = reconcile(other, received);
  EXPECT_EQ(done.relabelled + done.adopted, 0);
  EXPECT_EQ(labels_of(other), std::vector{kOld});
}

// If two pairs are within 3σ, the pair with the smaller Mahalanobis distance is joined first.
TEST(Reconcile, MergesTheNearestTracksFirst) {
  std::vector<LabelledTrack> tracks = {own(kYoung, at_m(0, 0, 0.5)),
                                       own(kYoung + 1, at_m(1, 0, 0.5))};
  std::vector<ReceivedLabel> received = {theirs(kOld, at_m(0.9, 0, 0.5)),
                                         theirs(kOld + 1, at_m(-0.5, 0, 0.5))};
  EXPECT_EQ(reconcile(tracks, received).relabelled, 2);
  EXPECT_EQ(labels_of(tracks), (std::vector{kOld + 1, kOld}));
}

TEST(Reconcile, AddsADistantTrack) {
  std::vector<LabelledTrack> tracks = {own(kYoung, at_m(0, 0, 0.1)), LabelledTrack{}};
  std::vector<ReceivedLabel> received = {theirs(kOld, at_m(2, 0, 0.1))};
  const Reconciled done = reconcile(tracks, received);
  EXPECT_EQ(done.adopted, 1);
  EXPECT_EQ(labels_of(tracks), (std::vector{kYoung, kOld}));
  EXPECT_EQ(tracks[1].last_seen, instant(1));
  // A table that is full of likely tracks accepts no further track.
  std::vector<LabelledTrack> full = {own(kYoung, at_m(0, 0, 0.1))};
  received = {theirs(kOld, at_m(2, 0, 0.1))};
  EXPECT_EQ(reconcile(full, received).adopted, 0);
  EXPECT_EQ(labels_of(full), std::vector{kYoung});
}

// The more certain belief is adopted. A product of the two beliefs would count their common
// information twice.
TEST(Reconcile, AdoptsAClearlyMoreCertainBelief) {
  const models::Gaussian vague = at_m(1, 1, 1.0);
  const models::Gaussian sure = at_m(1.3, 1, 0.2);
  std::vector<LabelledTrack> tracks = {own(kOld, vague)};
  std::vector<ReceivedLabel> received = {theirs(kOld, sure)};
  EXPECT_EQ(reconcile(tracks, received).taken_over, 1);
  EXPECT_EQ(moments(tracks[0].mixture).mean, sure.mean);
  EXPECT_EQ(moments(tracks[0].mixture).covariance, sure.covariance);
  received = {theirs(kOld, sure)};
  EXPECT_EQ(reconcile(tracks, received).taken_over, 0) << "a repeated belief changes nothing";
  received = {theirs(kOld, vague)};
  EXPECT_EQ(reconcile(tracks, received).taken_over, 0);
  EXPECT_EQ(moments(tracks[0].mixture).covariance, sure.covariance);
}

TEST(TrackLabels, AreAtLeastTwoToThePower30) {
  const Time last = from_utime(((1 << 20) - 1) * kLabelTick.count());
  EXPECT_EQ(first_label(from_utime(0), 0), models::kTrackLabelMin);
  EXPECT_EQ(first_label(last, kLabelledRobots - 1) + kLabelledDetections - 1,
            std::numeric_limits<int>::max());
  EXPECT_EQ(first_label(last + kLabelTick, 0), models::kTrackLabelMin)
      << "labels restart at the minimum";
  const Time tick = from_utime(1000 * kLabelTick.count());
  EXPECT_EQ(first_label(tick + kLabelTick - Duration{1}, 3), first_label(tick, 3));
  EXPECT_NE(first_label(tick - Duration{1}, 3), first_label(tick, 3));
}

TEST(TrackLabels, OrderHoldsForHalfTheirRange) {
  const Time begin = instant(0);
  const int label = first_label(begin, 5);
  const auto after = [&](int ticks) { return first_label(begin + ticks * kLabelTick, 5); };
  constexpr int kHalf = 1 << 19;
  EXPECT_TRUE(is_older(label, after(kHalf - 1)));
  EXPECT_FALSE(is_older(after(kHalf - 1), label));
  EXPECT_FALSE(is_older(label, after(kHalf + 1)));
  EXPECT_TRUE(is_older(after(kHalf + 1), label));
  EXPECT_FALSE(is_older(label, after(kHalf)));
  EXPECT_FALSE(is_older(after(kHalf), label));
}

// The limit is 3σ of the sum of the two covariances.
TEST(Reconcile, MergesTracksWithinThreeSigma) {
  for (const bool is_along_x : {false, true}) {
    for (const auto& [away_m, is_one] : {std::pair(1.499, true), std::pair(1.501, false)}) {
      std::vector<LabelledTrack> tracks = {own(kYoung, at_m(1.0, 2.0, 0.3)), LabelledTrack{}};
      std::vector<ReceivedLabel> received = {theirs(
          kOld, at_m(is_along_x ? 1.0 - away_m : 1.0, is_along_x ? 2.0 : 2.0 - away_m, 0.4))};
      const Reconciled done = reconcile(tracks, received);
      EXPECT_EQ(done.relabelled, is_one ? 1 : 0);
      EXPECT_EQ(done.adopted, is_one ? 0 : 1);
      EXPECT_EQ(tracks[0].existence, 0.95);
    }
  }
}

TEST(Reconcile, ComparesTracksAboveTenPercentExistence) {
  for (const auto& [existence, is_compared] : {std::pair(0.0999, false), std::pair(0.1, true)}) {
    std::vector<LabelledTrack> tracks = {own(kYoung, at_m(1, 1, 0.2), existence),
                                         own(kYoung + 1, at_m(9, 9, 0.2))};
    std::vector<ReceivedLabel> received = {theirs(kOld, at_m(1.1, 1, 0.2))};
    const Reconciled done = reconcile(tracks, received);
    EXPECT_EQ(done.relabelled, is_compared ? 1 : 0);
    EXPECT_EQ(tracks[0].label, kOld) << "merged, or adopted instead";
    EXPECT_EQ(tracks[0].existence, is_compared ? 0.5 : 0.9);
  }
}

TEST(Reconcile, IgnoresLabelsOfDeletedTracks) {
  std::vector<LabelledTrack> tracks = {own(kYoung, at_m(1, 1, 0.2)), own(kOld, at_m(5, 5, 0.2), 0)};
  std::vector<ReceivedLabel> received = {theirs(kOld, at_m(1.1, 1, 0.2))};
  EXPECT_EQ(reconcile(tracks, received).relabelled, 1);
  EXPECT_EQ(labels_of(tracks), std::vector{kOld});
}

// The merged track has the more certain of the two beliefs already in the step of the merge.
TEST(Reconcile, KeepsTheMoreCertainBeliefAfterAMerge) {
  for (const bool is_own_older : {false, true}) {
    std::vector<LabelledTrack> tracks = {own(is_own_older ? kOld : kYoung, at_m(1, 1, 1.0))};
    std::vector<ReceivedLabel> received = {theirs(is_own_older ? kYoung : kOld, at_m(1.1, 1, 0.2))};
    const Reconciled done = reconcile(tracks, received);
    EXPECT_EQ(done.relabelled, is_own_older ? 0 : 1);
    EXPECT_EQ(done.taken_over, 1);
    EXPECT_EQ(done.adopted, 0);
    EXPECT_EQ(labels_of(tracks), std::vector{kOld});
    EXPECT_EQ(moments(tracks[0].mixture).mean(0), 1.1);
  }
}

// In the plane, half a nat corresponds to a σ that is smaller by a factor of e^¼.
TEST(Reconcile, AdoptsABeliefWithHalfANatMoreInformation) {
  for (const auto& [nats, is_taken] : {std::pair(0.499, false), std::pair(0.501, true)}) {
    for (const int own_seen : {0, 2}) {
      std::vector<LabelledTrack> tracks = {own(kOld, at_m(1, 1, 1.0))};
      tracks[0].last_seen = instant(own_seen);
      std::vector<ReceivedLabel> received = {theirs(kOld, at_m(1.1, 1, std::exp(-0.5 * nats)))};
      EXPECT_EQ(reconcile(tracks, received).taken_over, is_taken ? 1 : 0);
      EXPECT_EQ(moments(tracks[0].mixture).mean(0), is_taken ? 1.1 : 1.0);
      EXPECT_EQ(tracks[0].last_seen, instant(is_taken ? std::max(own_seen, 1) : own_seen));
    }
  }
}

TEST(Reconcile, ReplacesTheLeastLikelyUnconfirmedTrack) {
  for (const auto& [least, is_adopted] : {std::pair(0.499, true), std::pair(0.5, false)}) {
    std::vector<LabelledTrack> tracks = {own(kYoung, at_m(0, 0, 0.1), 0.95),
                                         own(kYoung + 1, at_m(3, 0, 0.1), least),
                                         own(kYoung + 2, at_m(6, 0, 0.1), 0.6)};
    for (LabelledTrack& track : tracks) {
      track.hits = 7;
      track.misses = 1;
    }
    std::vector<ReceivedLabel> received = {theirs(kOld, at_m(9, 0, 0.1))};
    EXPECT_EQ(reconcile(tracks, received).adopted, is_adopted ? 1 : 0);
    EXPECT_EQ(labels_of(tracks), (std::vector{kYoung, is_adopted ? kOld : kYoung + 1, kYoung + 2}));
    EXPECT_EQ(tracks[1].existence, is_adopted ? 0.9 : 0.5);
    EXPECT_EQ(tracks[1].hits, is_adopted ? 0 : 7);
    EXPECT_EQ(tracks[1].misses, is_adopted ? 0 : 1);
    EXPECT_EQ(tracks[1].last_seen, instant(is_adopted ? 1 : 0));
    ASSERT_EQ(tracks[1].mixture.size(), 1U);
    EXPECT_EQ(tracks[1].mixture[0].weight, 1.0);
    EXPECT_EQ(tracks[1].mixture[0].belief.mean(0), is_adopted ? 9.0 : 3.0);
  }
}

// A track with the same label on both robots is not compared with other tracks of the teammate.
TEST(Reconcile, DoesNotMergeWithASharedTrack) {
  std::vector<LabelledTrack> tracks = {own(kOld, at_m(0, 0, 0.2)), LabelledTrack{}};
  std::vector<ReceivedLabel> received = {theirs(kOld, at_m(0.2, 0, 0.2)),
                                         theirs(kYoung, at_m(0.1, 0, 0.2))};
  const Reconciled done = reconcile(tracks, received);
  EXPECT_EQ(done.relabelled, 0);
  EXPECT_EQ(done.adopted, 1);
  EXPECT_EQ(labels_of(tracks), (std::vector{kOld, kYoung}));
}

TEST(Reconcile, AdoptsAFormerTrackIfCapacityAllows) {
  std::vector<LabelledTrack> tracks = {own(kOld, at_m(1, 1, 9.0), 0.0)};
  std::vector<ReceivedLabel> received = {theirs(kOld, at_m(1, 1, 0.2))};
  const Reconciled done = reconcile(tracks, received);
  EXPECT_EQ(done.adopted, 1);
  EXPECT_EQ(done.taken_over, 0);
  EXPECT_EQ(tracks[0].existence, 0.9);
  std::vector<LabelledTrack> nobody;
  EXPECT_EQ(reconcile(nobody, received).adopted, 0);
}

MultiTargetFilter planar_filter() {
  MultiTargetSpec spec;
  spec.estimator.target_model = {models::TargetKind::kRandomWalk, 2, 0.02};
  spec.world.bounds = {{-20.0, -20.0}, {20.0, 20.0}};
  return MultiTargetFilter(spec);
}

TEST(SentTracks, AreConfirmedAndOrderedByLabel) {
  const MultiTargetFilter filter = planar_filter();
  std::vector<LabelledTrack> tracks = {
      own(kYoung, at_m(3, 0, 0.2)), own(kOld, at_m(1, 0, 0.1), 0.5),
      own(kOld + 1, at_m(2, 0, 0.1), 0.499), own(kYoung, at_m(4, 0, 0.2), 0.9),
      own(kYoung + 1, at_m(5, 0, 0.0))};
  tracks[0].last_seen = instant(3);
  tracks[1].existence = 1.0 + 1e-15;
  tracks[1].mixture = {{1.0 + 1e-15, at_m(1, 0, 0.1)}};
  tracks[0].mixture = {{0.75, at_m(3, 0, 0.2)}, {0.25, at_m(3.4, 0, 0.2)}};
  const std::vector<models::TargetBelief> beliefs = confirmed_beliefs(filter, tracks);
  ASSERT_EQ(beliefs.size(), 2U) << "each label once, and only Gaussian tracks";
  EXPECT_EQ(beliefs[0].target_id, kOld);
  EXPECT_EQ(beliefs[1].target_id, kYoung);
  EXPECT_EQ(beliefs[1].last_seen, instant(3)) << "the first of two";
  EXPECT_NEAR(models::to_gaussian(beliefs[0].information)->mean(0), 1.0, 1e-9);
  EXPECT_NEAR(models::to_gaussian(beliefs[1].information)->mean(0), 3.1, 1e-9);

  const std::vector<models::TargetMixture> mixtures = confirmed_mixtures(filter, tracks);
  ASSERT_EQ(mixtures.size(), 2U);
  EXPECT_EQ(mixtures[0].target_id, kOld);
  EXPECT_EQ(mixtures[0].existence, 1.0) << "at most 1";
  EXPECT_EQ(mixtures[0].components[0].weight, 1.0);
  EXPECT_EQ(mixtures[1].target_id, kYoung);
  EXPECT_EQ(mixtures[1].existence, 0.95);
  ASSERT_EQ(mixtures[1].components.size(), 2U);
  EXPECT_EQ(mixtures[1].components[0].weight, 0.75);
  EXPECT_EQ(mixtures[1].components[1].belief.mean(0), 3.4);
}

TEST(SetTracks, ReplacesAllTracksAndSkipsInvalidOnes) {
  const auto belief = [](int label, const models::Gaussian& of, int seen) {
    return models::TargetBelief{label, models::to_information(of).value(), instant(seen)};
  };
  std::vector<LabelledTrack> tracks = {own(kYoung + 5, at_m(7, 7, 0.1)),
                                       own(kYoung + 6, at_m(8, 8, 0.1)),
                                       own(kYoung + 7, at_m(9, 9, 0.1))};
  models::TargetBelief none = belief(kOld + 3, at_m(3, 0, 1.0), 3);
  none.information.matrix.setZero();
  const models::Gaussian in_space{Eigen::Vector3d(2, 0, 0), Eigen::Matrix3d::Identity()};
  const std::vector<models::TargetBelief> received_beliefs = {belief(kOld, at_m(1, 0, 0.1), 1),
                                                              none, belief(kOld + 1, in_space, 2),
                                                              belief(kOld + 2, at_m(2, 0, 0.2), 4)};
  set_tracks(tracks, received_beliefs, 2);
  EXPECT_EQ(labels_of(tracks), (std::vector{kOld, kOld + 2}));
  EXPECT_EQ(tracks[0].existence, 0.9);
  EXPECT_EQ(tracks[1].last_seen, instant(4));
  EXPECT_NEAR(tracks[1].mixture.at(0).belief.covariance(1, 1), 0.04, 1e-12);
  EXPECT_TRUE(tracks[2].mixture.empty());
  EXPECT_EQ(tracks[2].existence, 0.0);
  set_tracks(tracks, {}, 2);
  EXPECT_TRUE(labels_of(tracks).empty());
}

}  // namespace
}  // namespace vantage::estimator
