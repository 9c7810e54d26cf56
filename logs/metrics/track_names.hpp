#pragma once

#include <span>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/truth_history.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs {

/// The tracks of one belief of a team whose sensors tell no ids, each under the id of the target
/// that it is taken for: by the assignment of least squared distance to where the `targets` are at
/// `time`, however far that is. Tracks beyond the number of targets have none and are left out; all
/// of them where the truth of `time` is not known. By ascending id.
std::vector<models::TargetBelief> named_by_place(std::span<const models::TargetBelief> tracks,
                                                 const TruthHistory& truth, int targets, Time time);

}  // namespace vantage::logs
