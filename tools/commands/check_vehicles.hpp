#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scenario/scenario.hpp"

namespace vantage::tools {

struct VehicleCheckOptions {
  std::string robot;                ///< only robot to check; empty: all robots
  bool is_load = false;             ///< true: write the parameters that differ
  bool skips_confirmation = false;  ///< true: write without asking the user
  bool is_quiet = false;            ///< true: print nothing on standard output
};

struct VehicleReport {
  nlohmann::ordered_json vehicles;  ///< result with one object per vehicle
  bool is_ready = false;
};

/// Reads the parameters of a scenario's autopilots and reports those that differ from the rules.
/// With `is_load` also writes these parameters and reads them back. Arms no vehicle, and writes
/// nothing to an armed vehicle.
/// @throws StartupError if a port cannot be opened, the robot does not exist, or confirmation is
///   needed without a terminal.
VehicleReport check_vehicles(const scenario::Scenario& scenario,
                             const VehicleCheckOptions& options);

}  // namespace vantage::tools
