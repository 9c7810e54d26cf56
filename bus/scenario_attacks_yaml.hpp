#pragma once

#include "bus/yaml_mapping.hpp"
#include "models/scenario/scenario.hpp"

namespace vantage::bus {

/// The list `attacks`, after the robots: each with its span and the robots whose sensors it jams;
/// and that planner.attacks_max leaves at least one robot.
void read_attacks(Mapping& top, models::Scenario& scenario);

}  // namespace vantage::bus
