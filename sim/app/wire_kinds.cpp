#include "sim/app/wire_kinds.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "core/check.hpp"
#include "scenario/vehicle_kinds.hpp"
#include "sim/app/wire_crazyflie.hpp"
#include "sim/app/wire_firmware.hpp"
#include "sim/app/wire_quadrotor.hpp"
#include "sim/app/wire_rover.hpp"

namespace vantage::sim {
namespace {

using scenario::RobotSpec;
using scenario::Scenario;

/// Returns the vehicle that the robot's real firmware flies. Precondition: robot.firmware.
std::unique_ptr<WireVehicle> make_with_firmware(const Scenario& scenario, std::size_t index) {
  const RobotSpec& robot = scenario.robots[index];
  return std::make_unique<WireFirmware>(robot, scenario.wind.value_or(scenario::WindSpec{}),
                                        scenario.firmware_instance(robot), scenario.seed + index);
}

std::unique_ptr<WireVehicle> make_flying(const Scenario& scenario, std::size_t index, Time start) {
  const RobotSpec& robot = scenario.robots[index];
  const std::uint64_t seed = scenario.seed + index;
  if (robot.firmware) {
    return make_with_firmware(scenario, index);
  }
  const auto system_id = static_cast<std::uint8_t>(index % 250 + 1);
  return std::make_unique<WireQuadrotor>(robot, scenario.wind, system_id, seed, start);
}

std::unique_ptr<WireVehicle> make_rover(const Scenario& scenario, std::size_t index, Time start) {
  const auto boot = static_cast<std::uint32_t>(to_utime(start) / 1'000'000);
  return std::make_unique<WireRover>(scenario.robots[index], boot, start);
}

std::unique_ptr<WireVehicle> make_crazyflie(const Scenario& scenario, std::size_t index,
                                            Time start) {
  if (scenario.robots[index].firmware) {
    return make_with_firmware(scenario, index);
  }
  return std::make_unique<WireCrazyflie>(scenario.robots[index],
                                         scenario.wind.value_or(scenario::WindSpec{}),
                                         scenario.seed + index, start);
}

struct Row {
  std::string_view section;
  std::unique_ptr<WireVehicle> (*make)(const Scenario&, std::size_t index, Time start);
};

constexpr Row kRows[] = {
    {"autopilot", make_flying}, {"rover", make_rover}, {"crazyflie", make_crazyflie}};

}  // namespace

std::unique_ptr<WireVehicle> make_wire_vehicle(const Scenario& scenario, std::size_t index,
                                               Time start) {
  const RobotSpec& robot = scenario.robots[index];
  const scenario::VehicleKind* kind = scenario::vehicle_kind(robot);
  if (kind == nullptr) {
    throw StartupError("robot " + robot.name + " has device 'wire': it needs " +
                       scenario::vehicle_sections(" or ") + " with a `url`");
  }
  const auto row = std::ranges::find(kRows, kind->section, &Row::section);
  if (row == std::end(kRows)) {
    throw StartupError("robot " + robot.name + " has device 'wire', but `" +
                       std::string(kind->section) + "` has no emulator");
  }
  return row->make(scenario, index, start);
}

}  // namespace vantage::sim
