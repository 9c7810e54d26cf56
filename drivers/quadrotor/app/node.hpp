#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "drivers/quadrotor/driver.hpp"
#include "drivers/vehicle/app/flight_node.hpp"

namespace vantage::drivers {

/// Returns the 32 bytes of a key file; nullopt for an empty name.
/// @throws StartupError if the file cannot be read, is not 32 bytes long or belongs to another
/// user, or if its mode permits more than 0600.
std::optional<wire::mavlink::SigningKey> load_key(const std::string& file);

/// Bus node of vantage-quadrotor for one robot.
class QuadrotorNode : public FlightNode<QuadrotorDriver> {
 public:
  /// @throws UsageError for a robot that is not in the scenario or has no autopilot.
  QuadrotorNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                const std::string& robot, std::unique_ptr<Port> port);

 private:
  bool receive(std::span<const std::uint8_t> bytes, Time now) override;
};

}  // namespace vantage::drivers
