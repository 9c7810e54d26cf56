#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads the list `attacks`: each attack has a time span and a list of robots with sensors to be
/// jammed. Checks that planner.attacks_max is less than the number of robots. Precondition: the
/// robots have been read.
void read_attacks(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
