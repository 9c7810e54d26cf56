#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// The list `hosts`, after the robots: names of A-Z and 0-9, each with what it runs; nothing runs
/// twice.
void read_hosts(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
