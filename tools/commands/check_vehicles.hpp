#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scenario/scenario.hpp"

namespace vantage::tools {

struct VehicleCheckOptions {
  std::string robot;      ///< this one alone; empty: all
  bool is_load = false;   ///< write what differs
  bool is_sure = false;   ///< without asking
  bool is_quiet = false;  ///< nothing on standard output
};

struct VehicleReport {
  nlohmann::ordered_json vehicles;  ///< an object each
  bool is_ready = false;
};

/// Asks the autopilots of a scenario for their parameters, says what differs and, when told to,
/// writes it and reads it back. Nothing is armed, and nothing written to an armed vehicle.
/// @throws StartupError for a port that cannot be opened, no such robot, or nobody to confirm.
VehicleReport check_vehicles(const scenario::Scenario& scenario,
                             const VehicleCheckOptions& options);

}  // namespace vantage::tools
