#pragma once

#include "bus/yaml_mapping.hpp"
#include "models/scenario/scenario.hpp"

namespace vantage::bus {

/// The section `mapping`, after the world and the planner. Refuses a scenario whose objective it
/// is that has none.
void read_mapping_spec(Mapping& top, models::Scenario& scenario);

}  // namespace vantage::bus
