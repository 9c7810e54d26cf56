#pragma once

#include <span>
#include <vector>

#include "core/time.hpp"
#include "estimator/tracks/filter_spec.hpp"
#include "estimator/tracks/labelled/multi_target.hpp"
#include "models/exchange/messages.hpp"

// Labels of tracks without target ids, on which a team agrees without negotiation. The label names
// the detection that started the track, so all robots that received that observation use the same
// label. A robot that found the target by a later observation receives the label in a teammate's
// belief. Of two labels of one target, the older one is used.

namespace vantage::estimator {

/// Observations of one robot at least this time apart have different labels.
inline constexpr Duration kLabelTick{20'000};
/// Maximum number of robots, and of detections per observation, for which labels are distinct.
inline constexpr int kLabelledRobots = 32;
inline constexpr int kLabelledDetections = 32;

/// Returns the label of a track started by the first detection of an observation. Each further
/// detection has the next label. A label encodes the instant in ticks modulo 2^20 (5.8 hours), the
/// robot and the detection. The comparison of labels assumes that their instants differ by at most
/// half of that period.
/// @throws UsageError unless 0 ≤ robot < kLabelledRobots.
int first_label(Time of_look, int robot);
/// True if `label` names an earlier detection than `than`: of an earlier instant or, at the same
/// instant, of a robot with a smaller index.
bool is_older(int label, int than);

/// A track in a teammate's belief.
struct ReceivedLabel {
  int sender = 0;  ///< index of the teammate that sent the belief
  Time at{};       ///< instant of `belief`
  int label = 0;
  models::Gaussian belief;
  Time last_seen{};
};

/// Reconciles `tracks` with the tracks of one teammate at the same instant; modifies both. Must be
/// called before observations that the teammate's tracks do not contain are used.
///
/// A track of this robot and a received track may be the same target if neither side has the label
/// of the other. They are assumed to be one target if their positions are nearest to each other and
/// their Mahalanobis distance is at most 3. Both receive the older label; the teammate does the
/// same when it receives this robot's belief. A received track with a label that is still unknown
/// is added if a slot is free or a track is unconfirmed. For a track that both robots have, the
/// received belief replaces that of this robot if its entropy is lower by more than half a nat.
/// Choosing one of two beliefs never counts an observation twice, whatever information they share.
/// Robots that used the same observations have nothing to reconcile. Nothing is allocated.
Reconciled reconcile(std::vector<LabelledTrack>& tracks, std::span<ReceivedLabel> received);

/// Returns the confirmed tracks as Gaussians, by ascending label.
std::vector<models::TargetBelief> confirmed_beliefs(const MultiTargetFilter& filter,
                                                    const std::vector<LabelledTrack>& tracks);
/// Returns the mixtures and existence probabilities of the confirmed tracks.
std::vector<models::TargetMixture> confirmed_mixtures(const MultiTargetFilter& filter,
                                                      const std::vector<LabelledTrack>& tracks);
/// Replaces `tracks` by `beliefs`, each with one Gaussian and an existence probability
/// of 0.9. Beliefs with a number of components other than `dim` are omitted.
void set_tracks(std::vector<LabelledTrack>& tracks, std::span<const models::TargetBelief> beliefs,
                int dim);

}  // namespace vantage::estimator
