#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.hpp"
#include "scenario/scenario.hpp"

namespace vantage::sim {

/// Returns the start of each target in the scenario's order: the start in the scenario, or a random
/// one, drawn uniformly from the free ground with `seed`. It is at least 1 m from every robot's
/// start and 0.3 m (between surfaces) from other targets. If no position is found, these distances
/// are halved, up to four times.
/// @throws UsageError if no start is found for a target.
std::vector<Pose2> target_starts(const scenario::Scenario& scenario, std::uint64_t seed);

}  // namespace vantage::sim
