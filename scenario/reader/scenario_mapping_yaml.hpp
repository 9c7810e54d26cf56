#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads the section `mapping`, which the mapping objective requires. Precondition: the world and
/// the planner have been read.
void read_mapping_spec(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
