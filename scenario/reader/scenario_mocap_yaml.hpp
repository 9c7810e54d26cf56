#pragma once

#include "scenario/mocap_spec.hpp"
#include "scenario/reader/mapping.hpp"

namespace vantage::scenario {

/// Reads the mapping `mocap`: how a simulated system measures and how a driver reaches the server.
void read_mocap(Mapping& from, MocapSpec& mocap);

}  // namespace vantage::scenario
