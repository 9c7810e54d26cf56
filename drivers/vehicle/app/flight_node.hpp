#pragma once

#include <memory>
#include <string>
#include <utility>

#include "drivers/vehicle/app/vehicle_node.hpp"

namespace vantage::drivers {

/// Bus node of one flying vehicle. It forwards poses and obeys commands immediately, and reads its
/// port every 5 ms. A derived class only passes received bytes to its driver. In addition to what
/// VehicleNode requires, the driver has on_mocap, on_command, tick and take_output.
template <class Driver>
class FlightNode : public VehicleNode<Driver> {
 protected:
  /// @param name  name of the process in HEALTH_<name>
  /// @param own   last argument of Driver, after scenario, robot and limits
  template <class Own>
  FlightNode(const std::string& name, bus::Bus& bus, const bus::Clock& clock,
             const scenario::Scenario& scenario, const std::string& robot,
             std::unique_ptr<Port> port, const Own& own)
      : VehicleNode<Driver>(name, kTickPeriod, kLanding, bus, clock, scenario, robot,
                            std::move(port), own) {}

 private:
  void on_mocap(const models::MocapFrame& frame, Time now) final {
    this->driver().on_mocap(frame, now);
    send_output(now);
  }
  void on_command(const models::OperatorCommand& command, Time now) final {
    this->driver().on_command(command, now);
    act(now);
  }
  void act(Time now) final {
    this->driver().tick(now);
    send_output(now);
  }
  void send_output(Time now) {
    for (const auto& message : this->driver().take_output()) {
      if constexpr (requires { message.bytes(); }) {
        this->port().write(message.bytes(), now);
      } else {
        this->port().write(message, now);
      }
    }
  }

  static constexpr Duration kTickPeriod = std::chrono::milliseconds(5);
  /// Maximum duration of a landing. Before its descent a landing waits at most 20 s for free ground
  /// below.
  static constexpr Duration kLanding = std::chrono::seconds(45);
};

}  // namespace vantage::drivers
