#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/crazyflie/driver.hpp"
#include "drivers/vehicle/app/vehicle_node.hpp"

namespace vantage::drivers {

/// Opens the connection to a Crazyflie by its URI (wire/crtp/link_uri).
/// @throws StartupError that names the fault in the URI or the device.
std::unique_ptr<Port> open_crazyflie_port(const std::string& uri);

/// Bus node of vantage-crazyflie for one robot. It reads packets from its port every 5 ms. It
/// forwards poses and obeys commands immediately.
class CrazyflieNode : public VehicleNode<CrazyflieDriver> {
 public:
  /// @throws UsageError for a robot that is not in the scenario or has no `crazyflie`.
  CrazyflieNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                const std::string& robot, std::unique_ptr<Port> port,
                const std::shared_ptr<TableCache>& cache);

 private:
  void on_mocap(const models::MocapFrame& frame, Time now) override;
  void on_command(const models::OperatorCommand& command, Time now) override;
  bool receive(std::span<const std::uint8_t> bytes, Time now) override;
  void act(Time now) override;
  void send_output(Time now);
};

}  // namespace vantage::drivers
