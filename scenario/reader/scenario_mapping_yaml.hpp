#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// The section `mapping`, after the world and the planner. Refuses a scenario whose objective it
/// is that has none.
void read_mapping_spec(Mapping& top, Scenario& scenario);

}  // namespace vantage::scenario
