#pragma once

#include <span>
#include <string>
#include <string_view>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// A kind of vehicle that a driver controls: a row of the table in vehicle_kinds.cpp.
/// scenario/reader/scenario_agents_yaml reads the section of the kind in the scenario;
/// sim/app/wire_kinds emulates the device.
struct VehicleKind {
  std::string_view section;  ///< key of the section in a robot's settings, such as "autopilot"
  std::string_view driver;   ///< driver process, vantage-<driver>
  bool flies;
  /// Returns the address of the robot's vehicle; null if the robot has no such section.
  const std::string* (*url)(const RobotSpec& robot);
};

/// Returns all kinds of vehicles, in display order.
std::span<const VehicleKind> all_vehicle_kinds();

/// Returns the kind of the robot's vehicle; null if the robot has no section of any kind.
const VehicleKind* vehicle_kind(const RobotSpec& robot);

/// Returns the sections of all kinds: "`autopilot`" and so on, joined by `separator`.
std::string vehicle_sections(std::string_view separator);

}  // namespace vantage::scenario
