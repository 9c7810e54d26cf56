#include "estimator/track_labels.hpp"

#include <set>
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

HeardLabel theirs(int label, const models::Gaussian& belief) {
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

TEST(TrackLabels, OfDifferentLooksAreDifferentAndNoIdsOfTargets) {
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

TEST(TrackLabels, KnowWhichIsOlderAcrossTheirEnd) {
  EXPECT_TRUE(is_older(kOld, kYoung));
  EXPECT_FALSE(is_older(kYoung, kOld));
  EXPECT_FALSE(is_older(kOld, kOld));
  EXPECT_TRUE(is_older(first_label(instant(2), 0), first_label(instant(2), 1)));
  const Time last = from_utime(((1 << 20) - 1) * kLabelTick.count());
  EXPECT_TRUE(is_older(first_label(last, 31) + 31, first_label(last + kLabelTick, 0)));
}

TEST(Reconcile, ChangesNothingOfWhoHasUsedTheSameLooks) {
  std::vector<LabelledTrack> tracks = {own(kOld, at_m(1, 1, 0.2)), own(kYoung, at_m(1.1, 1, 0.2)),
                                       own(kYoung + 1, at_m(1.05, 1, 0.2), 0.3)};
  std::vector<HeardLabel> heard = {theirs(kOld, at_m(1, 1, 0.2)),
                                   theirs(kYoung, at_m(1.1, 1, 0.2))};
  const Reconciled done = reconcile(tracks, heard);
  EXPECT_EQ(done.relabelled + done.adopted + done.taken_over, 0);
  EXPECT_EQ(labels_of(tracks), (std::vector{kOld, kYoung, kYoung + 1}));
  EXPECT_EQ(tracks[2].existence, 0.3);
}

TEST(Reconcile, GivesBothTheOlderLabelWhoeverHears) {
  std::vector<LabelledTrack> one = {own(kYoung, at_m(1, 1, 0.2), 0.4)};
  std::vector<HeardLabel> heard = {theirs(kOld, at_m(1.2, 1, 0.2))};
  EXPECT_EQ(reconcile(one, heard).relabelled, 1);
  EXPECT_EQ(labels_of(one), std::vector{kOld});
  EXPECT_GE(one[0].existence, 0.5) << "what a teammate has confirmed and is here is told of";

  std::vector<LabelledTrack> other = {own(kOld, at_m(1.2, 1, 0.2))};
  heard = {theirs(kYoung, at_m(1, 1, 0.2))};
  const Reconciled done = reconcile(other, heard);
  EXPECT_EQ(done.relabelled + done.adopted, 0);
  EXPECT_EQ(labels_of(other), std::vector{kOld});
}

// Of two that are both within 3 sigma the nearer pair first, by Mahalanobis distance.
TEST(Reconcile, JoinsTheNearestFirst) {
  std::vector<LabelledTrack> tracks = {own(kYoung, at_m(0, 0, 0.5)),
                                       own(kYoung + 1, at_m(1, 0, 0.5))};
  std::vector<HeardLabel> heard = {theirs(kOld, at_m(0.9, 0, 0.5)),
                                   theirs(kOld + 1, at_m(-0.5, 0, 0.5))};
  EXPECT_EQ(reconcile(tracks, heard).relabelled, 2);
  EXPECT_EQ(labels_of(tracks), (std::vector{kOld + 1, kOld}));
}

TEST(Reconcile, TakesWhatIsFarFromAllForAnother) {
  std::vector<LabelledTrack> tracks = {own(kYoung, at_m(0, 0, 0.1)), LabelledTrack{}};
  std::vector<HeardLabel> heard = {theirs(kOld, at_m(2, 0, 0.1))};
  const Reconciled done = reconcile(tracks, heard);
  EXPECT_EQ(done.adopted, 1);
  EXPECT_EQ(labels_of(tracks), (std::vector{kYoung, kOld}));
  EXPECT_EQ(tracks[1].last_seen, instant(1));
  // Where all places are taken by likely ones there is no room.
  std::vector<LabelledTrack> full = {own(kYoung, at_m(0, 0, 0.1))};
  heard = {theirs(kOld, at_m(2, 0, 0.1))};
  EXPECT_EQ(reconcile(full, heard).adopted, 0);
  EXPECT_EQ(labels_of(full), std::vector{kYoung});
}

// Never a product of both, which would count twice what they have in common.
TEST(Reconcile, TakesTheBeliefThatTellsClearlyMoreAsItIs) {
  const models::Gaussian vague = at_m(1, 1, 1.0);
  const models::Gaussian sure = at_m(1.3, 1, 0.2);
  std::vector<LabelledTrack> tracks = {own(kOld, vague)};
  std::vector<HeardLabel> heard = {theirs(kOld, sure)};
  EXPECT_EQ(reconcile(tracks, heard).taken_over, 1);
  EXPECT_EQ(moments(tracks[0].mixture).mean, sure.mean);
  EXPECT_EQ(moments(tracks[0].mixture).covariance, sure.covariance);
  heard = {theirs(kOld, sure)};
  EXPECT_EQ(reconcile(tracks, heard).taken_over, 0) << "the same again tells nothing";
  heard = {theirs(kOld, vague)};
  EXPECT_EQ(reconcile(tracks, heard).taken_over, 0);
  EXPECT_EQ(moments(tracks[0].mixture).covariance, sure.covariance);
}

}  // namespace
}  // namespace vantage::estimator
