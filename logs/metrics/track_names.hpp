#pragma once

#include <span>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/truth_history.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs {

/// Returns the tracks of one belief with the ids of true targets, by ascending id. Used for teams
/// with sensors that report no ids. The ids come from the assignment of tracks to true positions of
/// the `targets` at `time` with the least sum of squared distances, without a distance limit.
/// Surplus tracks are left out. All tracks are left out if the truth at `time` is unknown.
std::vector<models::TargetBelief> assign_ids_by_position(
    std::span<const models::TargetBelief> tracks, const TruthHistory& truth, int targets,
    Time time);

}  // namespace vantage::logs
