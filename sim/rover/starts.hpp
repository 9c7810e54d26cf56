#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.hpp"
#include "scenario/scenario.hpp"

namespace vantage::sim {

/// Returns the start of each target in the scenario's order: as stated, or else drawn uniformly by
/// `seed` from the free ground, 1 m from every robot's start and 0.3 m (between surfaces) from
/// other targets. These distances are halved, up to four times, while the ground is too crowded.
/// @throws UsageError if no start is found for a target.
std::vector<Pose2> target_starts(const scenario::Scenario& scenario, std::uint64_t seed);

}  // namespace vantage::sim
