#pragma once

#include "bus/yaml_mapping.hpp"
#include "models/scenario/scenario.hpp"

namespace vantage::bus {

/// The list `hosts`, after the robots: names of A-Z and 0-9, each with what it runs; nothing runs
/// twice.
void read_hosts(Mapping& top, models::Scenario& scenario);

}  // namespace vantage::bus
