#pragma once

#include <string>

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Largest coordinate and length in a scenario, m.
inline constexpr double kLengthMaxM = 10'000.0;

/// True if `name` consists of A-Z and 0-9 only, as channel names such as `PLAN_<name>` require.
bool is_channel_suffix(const std::string& name);

void read_device(Mapping& from, DeviceSource& device);
/// Reads the key `device` of an estimator or a planner.
void read_publisher(Mapping& from, Publisher& publisher);

/// Reads `robots`, with missing keys from `robot_defaults`. Checks each robot against the world,
/// the planner's distances and the previous robots in the list. Precondition: scenario.world and
/// scenario.planner have been read.
void read_robots(Mapping& top, Scenario& scenario);

/// Reads `targets`: a count or a list. Precondition: the world and the robots have been read.
void read_targets(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
