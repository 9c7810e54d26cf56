#pragma once

#include "bus/yaml_mapping.hpp"
#include "models/scenario/mocap_spec.hpp"

namespace vantage::bus {

/// Reads the mapping `mocap`: how a simulated system measures and how a driver reaches the server.
void read_mocap(Mapping& from, models::MocapSpec& mocap);

}  // namespace vantage::bus
