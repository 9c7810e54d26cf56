#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/crazyflie/driver.hpp"
#include "drivers/vehicle/app/flight_node.hpp"

namespace vantage::drivers {

/// Opens the connection to a Crazyflie by its URI (wire/crtp/link_uri).
/// @throws StartupError that names the fault in the URI or the device.
std::unique_ptr<Port> open_crazyflie_port(const std::string& uri);

/// Bus node of vantage-crazyflie for one robot.
class CrazyflieNode : public FlightNode<CrazyflieDriver> {
 public:
  /// @throws UsageError for a robot that is not in the scenario or has no `crazyflie`.
  CrazyflieNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                const std::string& robot, std::unique_ptr<Port> port,
                const std::shared_ptr<TableCache>& cache);

 private:
  bool receive(std::span<const std::uint8_t> bytes, Time now) override;
};

}  // namespace vantage::drivers
