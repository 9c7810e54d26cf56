#include "estimator/tracks/labelled/track_labels.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include <Eigen/Cholesky>

#include "core/check.hpp"

namespace vantage::estimator {
namespace {

constexpr int kTicks = 1 << 20;
constexpr int kLabels = kTicks * kLabelledRobots * kLabelledDetections;
static_assert(kLabels == models::kTrackLabelMin,
              "labels must be the upper half of the positive integers");

constexpr double kSameWithin_sigma = 3.0;
constexpr double kTellsMore_nats = 0.5;
/// Least existence probability at which one of the robot's tracks is matched with a track that a
/// teammate confirmed.
constexpr double kPlausible = 0.1;
/// Existence probability of a track that a teammate confirmed; beliefs do not contain the exact
/// value.
constexpr double kHeardExistence = 0.9;

/// Sorts the entries by target_id and removes all but the first entry of each target.
template <class List>
void order(List& list) {
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.target_id < b.target_id; });
  const auto is_one = [](const auto& a, const auto& b) { return a.target_id == b.target_id; };
  list.erase(std::unique(list.begin(), list.end(), is_one), list.end());
}

template <class List>
bool has_label(const List& list, int label) {
  return std::any_of(list.begin(), list.end(),
                     [&](const auto& each) { return each.label == label; });
}

void set_belief(LabelledTrack& track, const models::Gaussian& belief, Time last_seen) {
  track.mixture.assign(1, Component{1.0, belief});
  track.last_seen = last_seen;
}

/// Replaces the track with the lowest existence probability. Returns false if all tracks are
/// confirmed.
bool add(std::vector<LabelledTrack>& tracks, int label, const models::Gaussian& belief,
         Time last_seen) {
  const auto least = std::min_element(tracks.begin(), tracks.end(),
                                      [](auto& a, auto& b) { return a.existence < b.existence; });
  if (least == tracks.end() || least->existence >= kConfirmed) {
    return false;
  }
  set_belief(*least, belief, last_seen);
  least->existence = kHeardExistence;
  least->label = label;
  least->hits = 0;
  least->misses = 0;
  return true;
}

double mahalanobis2(const models::Gaussian& a, const models::Gaussian& b) {
  const Eigen::Vector2d off_m = a.mean.head<2>() - b.mean.head<2>();
  const Eigen::Matrix2d S_m2 =
      a.covariance.topLeftCorner<2, 2>() + b.covariance.topLeftCorner<2, 2>();
  return off_m.dot(S_m2.llt().solve(off_m));
}

/// Finds the nearest pair of a track of this robot and a received track. The label of each track
/// must be unknown to the other side. Gives both tracks the older label. Returns false if no such
/// pair exists.
bool join_nearest(std::vector<LabelledTrack>& tracks, std::span<ReceivedLabel> received,
                  Reconciled& done) {
  LabelledTrack* own = nullptr;
  ReceivedLabel* theirs = nullptr;
  double least = kSameWithin_sigma * kSameWithin_sigma;
  for (LabelledTrack& track : tracks) {
    if (track.existence < kPlausible || has_label(received, track.label)) {
      continue;
    }
    const models::Gaussian belief = moments(track.mixture);
    for (ReceivedLabel& each : received) {
      const bool is_known = std::any_of(tracks.begin(), tracks.end(), [&](const auto& mine) {
        return mine.existence > 0.0 && mine.label == each.label;
      });
      const double d2 = is_known ? least : mahalanobis2(belief, each.belief);
      if (d2 < least) {
        least = d2;
        own = &track;
        theirs = &each;
      }
    }
  }
  if (own == nullptr) {
    return false;
  }
  own->existence = std::max(own->existence, kConfirmed);
  if (is_older(theirs->label, own->label)) {
    own->label = theirs->label;
    ++done.relabelled;
  } else {
    theirs->label = own->label;
  }
  return true;
}

}  // namespace

int first_label(Time of_look, int robot) {
  demand(robot >= 0 && robot < kLabelledRobots, "a label requires a robot index in [0, 32)");
  const std::int64_t tick = to_utime(of_look) / kLabelTick.count() % kTicks;
  return models::kTrackLabelMin +
         (static_cast<int>(tick) * kLabelledRobots + robot) * kLabelledDetections;
}

bool is_older(int label, int than) {
  const int ahead = (than - label + kLabels) % kLabels;
  return ahead > 0 && ahead < kLabels / 2;
}

Reconciled reconcile(std::vector<LabelledTrack>& tracks, std::span<ReceivedLabel> received) {
  Reconciled done;
  while (join_nearest(tracks, received, done)) {
  }
  for (const ReceivedLabel& each : received) {
    const auto own = std::find_if(tracks.begin(), tracks.end(), [&](const LabelledTrack& track) {
      return track.existence > 0.0 && track.label == each.label;
    });
    if (own == tracks.end()) {
      done.adopted += add(tracks, each.label, each.belief, each.last_seen) ? 1 : 0;
    } else if (models::entropy_nats(moments(own->mixture)) - models::entropy_nats(each.belief) >
               kTellsMore_nats) {
      set_belief(*own, each.belief, std::max(own->last_seen, each.last_seen));
      ++done.taken_over;
    }
  }
  return done;
}

std::vector<models::TargetBelief> confirmed_beliefs(const MultiTargetFilter& filter,
                                                    const std::vector<LabelledTrack>& tracks) {
  std::vector<models::TargetBelief> beliefs;
  for (const LabelledTrack& track : tracks) {
    const auto information =
        filter.is_confirmed(track) ? models::to_information(moments(track.mixture)) : std::nullopt;
    if (information) {
      beliefs.push_back({track.label, *information, track.last_seen});
    }
  }
  order(beliefs);
  return beliefs;
}

std::vector<models::TargetMixture> confirmed_mixtures(const MultiTargetFilter& filter,
                                                      const std::vector<LabelledTrack>& tracks) {
  std::vector<models::TargetMixture> mixtures;
  for (const LabelledTrack& track : tracks) {
    if (filter.is_confirmed(track) && models::to_information(moments(track.mixture))) {
      mixtures.push_back({track.label, std::min(track.existence, 1.0), track.mixture});
      // Rounding may raise a weight slightly above 1.
      for (Component& component : mixtures.back().components) {
        component.weight = std::min(component.weight, 1.0);
      }
    }
  }
  order(mixtures);
  return mixtures;
}

void set_tracks(std::vector<LabelledTrack>& tracks, std::span<const models::TargetBelief> beliefs,
                int dim) {
  for (LabelledTrack& track : tracks) {
    track.existence = 0.0;
    track.mixture.clear();
  }
  for (const models::TargetBelief& target : beliefs) {
    const auto belief = target.information.vector.size() == dim
                            ? models::to_gaussian(target.information)
                            : std::nullopt;
    if (belief) {
      static_cast<void>(add(tracks, target.target_id, *belief, target.last_seen));
    }
  }
}

}  // namespace vantage::estimator
