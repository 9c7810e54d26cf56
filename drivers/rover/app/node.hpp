#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/rover/driver.hpp"
#include "drivers/vehicle/app/vehicle_node.hpp"

namespace vantage::drivers {

/// vantage-rover of one robot on the bus, which says how it is on VEHICLE_R as every vehicle
/// does. A command on its port each 20 ms, and at once on an operator's word.
class RoverNode : public VehicleNode<RoverDriver> {
 public:
  /// @throws UsageError for a robot that is not in the scenario or is no rover.
  RoverNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
            const std::string& robot, std::unique_ptr<Port> port);

 private:
  void on_mocap(const models::MocapFrame& frame, Time now) override;
  void on_command(const models::OperatorCommand& command, Time now) override;
  bool receive(std::span<const std::uint8_t> datagram, Time now) override;
  void act(Time now) override;
};

}  // namespace vantage::drivers
