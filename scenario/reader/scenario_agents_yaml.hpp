#pragma once

#include <string>

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Widest coordinate and longest length that a scenario may hold.
inline constexpr double kLengthMaxM = 10'000.0;

/// Of A-Z and 0-9 only: what may stand behind `PLAN_` and the like.
bool is_channel_suffix(const std::string& name);

void read_device(Mapping& from, DeviceSource& device);

/// Reads `robots` over `robot_defaults`, and checks each robot against the world, the planner's
/// distances and the robots before it. Precondition: scenario.world and scenario.planner are read.
void read_robots(Mapping& top, Scenario& scenario);

/// Reads `targets`: a count or a list. Precondition: the world and the robots are read.
void read_targets(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
