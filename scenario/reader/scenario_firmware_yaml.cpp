#include "scenario/reader/scenario_firmware_yaml.hpp"

#include <string>

namespace vantage::scenario {
namespace {

/// Returns the kind of firmware that the robot's vehicle has; empty if there is none.
std::string firmware_kind(const RobotSpec& robot) {
  if (robot.crazyflie) {
    return "crazyflie";
  }
  return robot.autopilot ? models::name_of(robot.autopilot->dialect) : "";
}

void check_firmware_kind(Mapping& from, const RobotSpec& robot, const FirmwareSpec& firmware) {
  std::string kind = firmware_kind(robot);
  from.text("kind", kind);
  if (!firmware_kind(robot).empty() && kind != firmware_kind(robot)) {
    from.refuse("kind", "must be '" + firmware_kind(robot) +
                            "', the kind of the robot's vehicle, is '" + kind + "'");
  }
  if (robot.crazyflie && !firmware.serial.empty()) {
    from.refuse("serial", "is for boards with PX4 only: remove it");
  }
  if (robot.crazyflie && !firmware.parameters.empty()) {
    from.refuse("parameters",
                "is for PX4 and ArduPilot only: the driver sets a Crazyflie's parameters");
  }
}

void read_section(Mapping& from, const RobotSpec& robot, FirmwareSpec& firmware) {
  constexpr int kInstanceMax = 99;
  from.text("binary", firmware.binary);
  from.text("parameters", firmware.parameters);
  from.text("serial", firmware.serial);
  int instance = -1;
  from.integer("instance", instance, 0, kInstanceMax);
  if (instance >= 0) {
    firmware.instance = instance;
  }
  if (!firmware.serial.empty() && !firmware.binary.empty()) {
    from.refuse("serial", "selects a board, which runs its own firmware: remove `binary`");
  }
  check_firmware_kind(from, robot, firmware);
}

}  // namespace

void read_firmware(Mapping& from, RobotSpec& robot) {
  from.section("firmware",
               [&](Mapping& firmware) { read_section(firmware, robot, robot.firmware.emplace()); });
  if (robot.firmware && firmware_kind(robot).empty()) {
    from.refuse("firmware",
                "needs an `autopilot` or `crazyflie` section, which selects the firmware");
  }
  if (robot.firmware && robot.crazyflie && !robot.crazyflie->url.starts_with("udp://")) {
    from.refuse("firmware", "needs a crazyflie.url of the form udp://127.0.0.1:PORT, is '" +
                                robot.crazyflie->url + "'");
  }
  if (robot.firmware && robot.device != DeviceSource::kWire) {
    from.refuse("firmware", "is for simulated vehicles only: set device to 'wire'");
  }
}

}  // namespace vantage::scenario
