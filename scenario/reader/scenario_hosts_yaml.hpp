#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads the list `hosts`: names of A-Z and 0-9, each with the parts that it runs. A part may be
/// listed only once. Precondition: the robots have been read.
void read_hosts(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
