#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.hpp"
#include "scenario/scenario.hpp"

namespace vantage::sim {

/// Where each target of the scenario starts, in its order: as stated, else drawn uniformly from the
/// free ground by `seed`, 1 m away from every robot's start and 0.3 m (between surfaces) from
/// other targets; these distances are halved, up to four times, while the ground is too crowded.
/// @throws UsageError when a target still finds no room.
std::vector<Pose2> target_starts(const scenario::Scenario& scenario, std::uint64_t seed);

}  // namespace vantage::sim
