#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "estimator/multi_target.hpp"
#include "models/exchange/messages.hpp"

// Labels of tracks without target ids, and their agreement in a team without negotiation. The label
// names the detection that started the track, so all robots that received that observation use the
// same label. A robot that found the target by a later observation learns the label from a
// teammate's belief: of two labels of one target, the older one is kept.

namespace vantage::estimator {

/// Observations of one robot that are at least this far apart have different labels.
inline constexpr Duration kLabelTick{20'000};
/// Numbers of robots, and of detections per observation, that have distinct labels.
inline constexpr int kLabelledRobots = 32;
inline constexpr int kLabelledDetections = 32;

/// Returns the label of a track started by the first detection of an observation; each further
/// detection has the next label. It encodes the instant in ticks modulo 2^20 (5.8 hours), the robot
/// and the detection. Labels are compared on the assumption that they are at most half of that
/// period apart.
/// @throws UsageError unless 0 ≤ robot < kLabelledRobots.
int first_label(Time of_look, int robot);
/// True if `label` names an earlier detection than `than`: of an earlier instant or, at the same
/// instant, of a robot with a smaller index.
bool is_older(int label, int than);

/// A track in a teammate's belief.
struct HeardLabel {
  int teller = 0;  ///< index of the teammate; its tracks are reconciled together
  Time at{};       ///< instant of `belief`
  int label = 0;
  models::Gaussian belief;
  Time last_seen{};
};

/// Results of reconcile(), counted.
struct Reconciled {
  std::int64_t relabelled = 0;  ///< own tracks that were given an older label
  std::int64_t adopted = 0;     ///< teammates' tracks that match no own track and were added
  std::int64_t taken_over = 0;  ///< own tracks that took a teammate's more informative belief
};

/// Reconciles `tracks` with those of one teammate, of the same instant. It must run before any
/// observation is used that is not in `heard`. `heard` is modified.
///
/// An own and a received track may be the same target if neither side has the label of the other.
/// They are taken to be one if their positions are nearest to each other by Mahalanobis distance,
/// and within 3. Both get the older label; the teammate does the same when it receives this robot's
/// belief. A received track with a label that is still unknown is added if there is room. For a
/// track that both have, the received belief replaces the own one if its entropy is lower by more
/// than half a nat. A choice between two beliefs never counts an observation twice, whatever they
/// have in common. Robots that used the same observations have nothing to reconcile. Allocates
/// nothing.
Reconciled reconcile(std::vector<LabelledTrack>& tracks, std::span<HeardLabel> heard);

/// Returns the confirmed tracks as Gaussians, by ascending label.
std::vector<models::TargetBelief> told(const MultiTargetFilter& filter,
                                       const std::vector<LabelledTrack>& tracks);
/// Returns the same tracks' mixtures and existence probabilities.
std::vector<models::TargetMixture> told_mixtures(const MultiTargetFilter& filter,
                                                 const std::vector<LabelledTrack>& tracks);
/// Replaces `tracks` by those of `told`, with one Gaussian and an existence of 0.9 each. Beliefs
/// without `dim` components are left out.
void set_told(std::vector<LabelledTrack>& tracks, std::span<const models::TargetBelief> told,
              int dim);

}  // namespace vantage::estimator
