#pragma once

#include <cstddef>
#include <memory>

#include "core/time.hpp"
#include "scenario/scenario.hpp"
#include "sim/app/wire_vehicle.hpp"

namespace vantage::sim {

/// Creates the emulated device of robot `index` of the scenario. A new kind of vehicle
/// (scenario/vehicle_kinds) needs a line in wire_kinds.cpp.
/// @throws StartupError for a robot that has no section of any kind, or whose device cannot be
///         emulated
std::unique_ptr<WireVehicle> make_wire_vehicle(const scenario::Scenario& scenario,
                                               std::size_t index, Time start);

}  // namespace vantage::sim
