#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "estimator/multi_target.hpp"
#include "models/exchange/messages.hpp"

// What robots that track without ids call their tracks, and how a team comes to call them the same.
// No robot is asked: a label is the name of the detection that the track was born of, so whoever
// has heard that look calls it the same. Who has not found the target by a later look, and is told
// by a teammate's belief: of two labels of one target the older one stays.

namespace vantage::estimator {

/// Looks of one robot that are this far apart make different labels.
inline constexpr Duration kLabelTick{20'000};
/// As many robots and detections of a look have labels of their own.
inline constexpr int kLabelledRobots = 32;
inline constexpr int kLabelledDetections = 32;

/// Label of a track that the first detection of a look founds, in the detections' own order; the
/// next has the next label. It holds the instant, in ticks, modulo 2^20 (5.8 hours: the labels of a
/// track are taken to be no more than half of that apart), the robot and the detection.
/// @throws UsageError unless 0 ≤ robot < kLabelledRobots.
int first_label(Time of_look, int robot);
/// Of the look of an earlier instant; of the same, of the robot that comes first.
bool is_older(int label, int than);

/// A track that a teammate tells of.
struct HeardLabel {
  int teller = 0;  ///< who: what one teammate says goes together
  Time at{};       ///< instant of `belief`
  int label = 0;
  models::Gaussian belief;
  Time last_seen{};
};

/// What hearing of teammates' tracks came to.
struct Reconciled {
  std::int64_t relabelled = 0;  ///< own tracks that took an older label
  std::int64_t adopted = 0;     ///< theirs that are none of the own
  std::int64_t taken_over = 0;  ///< beliefs of own tracks of which the teammate knows more
};

/// Makes `tracks` agree with those that one teammate tells of, of the same instant, the instant
/// before anything is used that is not in `heard`. `heard` is scratch.
///
/// An own track and one of theirs whose labels the other side has not are one target where they are
/// nearest to each other by Mahalanobis distance of positions, and within 3: both are called by the
/// older label (the other side does the same when it hears of this). What then has no label here is
/// adopted if there is room. Of a track that both have, the belief that tells more by half a nat or
/// more is taken, whole: a choice between two beliefs never counts a look twice, whatever they have
/// in common. Robots that have used the same looks have nothing to reconcile. Allocates nothing.
Reconciled reconcile(std::vector<LabelledTrack>& tracks, std::span<HeardLabel> heard);

/// What `tracks` tell of: those that are confirmed, as Gaussians, by ascending label.
std::vector<models::TargetBelief> told(const MultiTargetFilter& filter,
                                       const std::vector<LabelledTrack>& tracks);
/// The same tracks' mixtures and probabilities of existence.
std::vector<models::TargetMixture> told_mixtures(const MultiTargetFilter& filter,
                                                 const std::vector<LabelledTrack>& tracks);
/// Tracks of which only what was told is known: an existence of 0.9, one Gaussian each. What has
/// not `dim` components is left out.
void set_told(std::vector<LabelledTrack>& tracks, std::span<const models::TargetBelief> told,
              int dim);

}  // namespace vantage::estimator
