#include "scenario/vehicle_kinds.hpp"

#include <algorithm>

namespace vantage::scenario {
namespace {

constexpr VehicleKind kVehicleKinds[] = {
    {"autopilot", "quadrotor", true,
     [](const RobotSpec& robot) { return robot.autopilot ? &robot.autopilot->url : nullptr; }},
    {"rover", "rover", false,
     [](const RobotSpec& robot) { return robot.rover ? &robot.rover->url : nullptr; }},
    {"crazyflie", "crazyflie", true,
     [](const RobotSpec& robot) { return robot.crazyflie ? &robot.crazyflie->url : nullptr; }},
};

}  // namespace

std::span<const VehicleKind> all_vehicle_kinds() { return kVehicleKinds; }

const VehicleKind* vehicle_kind(const RobotSpec& robot) {
  const auto found = std::ranges::find_if(
      kVehicleKinds, [&](const VehicleKind& kind) { return kind.url(robot) != nullptr; });
  return found == std::end(kVehicleKinds) ? nullptr : found;
}

std::string vehicle_sections(std::string_view separator) {
  std::string out;
  for (const VehicleKind& kind : kVehicleKinds) {
    out.append(out.empty() ? "" : separator).append("`").append(kind.section).append("`");
  }
  return out;
}

}  // namespace vantage::scenario
