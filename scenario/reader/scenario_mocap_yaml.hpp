#pragma once

#include "scenario/mocap_spec.hpp"
#include "scenario/reader/mapping.hpp"

namespace vantage::scenario {

/// Reads the section `mocap`: noise of a simulated system, and connection of the driver to the
/// server.
void read_mocap(Mapping& from, MocapSpec& mocap);

}  // namespace vantage::scenario
