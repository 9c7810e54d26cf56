#pragma once

#include <cstdint>
#include <vector>

#include "experiments/surveillance/landmark_watch.hpp"

namespace vantage::experiments {

/// Returns the setting of the camp surveillance with T_REPLAN = `replan_steps` and α = `attacks`.
/// The dissertation does not state the layout of the camp, the range noise (here that of its
/// tracking experiment), the prior or the number of nodes.
/// Source: dissertation, section 4.F.3.
WatchSetting surveillance_setting(int replan_steps, int attacks);

/// Returns random obstacle-free starts in the camp with random headings, at the robots' heights;
/// determined by `seed`.
std::vector<models::Viewpoint> surveillance_starts(const WatchSetting& setting, int robots,
                                                   std::uint64_t seed);

}  // namespace vantage::experiments
