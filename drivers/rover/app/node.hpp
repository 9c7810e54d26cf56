#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/rover/driver.hpp"
#include "drivers/vehicle/app/vehicle_node.hpp"

namespace vantage::drivers {

/// Bus node of vantage-rover for one robot; publishes VEHICLE_R. It sends a command on its port
/// every 20 ms, and immediately after an operator command.
class RoverNode : public VehicleNode<RoverDriver> {
 public:
  /// @throws UsageError for a robot that is not in the scenario or not a rover.
  RoverNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
            const std::string& robot, std::unique_ptr<Port> port);

 private:
  void on_mocap(const models::MocapFrame& frame, Time now) override;
  void on_command(const models::OperatorCommand& command, Time now) override;
  bool receive(std::span<const std::uint8_t> datagram, Time now) override;
  void act(Time now) override;
};

}  // namespace vantage::drivers
