#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// The list `attacks`, after the robots: each with its span and the robots whose sensors it jams;
/// and that planner.attacks_max leaves at least one robot.
void read_attacks(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
