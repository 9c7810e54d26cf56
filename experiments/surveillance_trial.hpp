#pragma once

#include <cstdint>
#include <vector>

#include "experiments/landmark_watch.hpp"

namespace vantage::experiments {

/// The camp watched over as in the text, T_REPLAN = `replan_steps`, α = `attacks`. What the text
/// leaves open: the camp, the noise of the range (that of its tracking), the prior, the nodes.
/// Source: dissertation 4 F.3.
WatchSetting surveillance_setting(int replan_steps, int attacks);

/// Robots at their heights, anywhere free in the camp, facing anywhere. By `seed` alone.
std::vector<models::Viewpoint> surveillance_starts(const WatchSetting& setting, int robots,
                                                   std::uint64_t seed);

}  // namespace vantage::experiments
