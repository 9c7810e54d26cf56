#pragma once

#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/vehicle.hpp"
#include "sim/vehicle_socket.hpp"

namespace vantage::sim {

/// Robot of the scenario with the device `wire`: its true state is the state of an emulated device,
/// which its driver commands over UDP.
class WireVehicle : public Vehicle {
 public:
  /// Receives the driver's messages and sends the messages that are due. Call at `now`, after the
  /// world has been stepped for this tick. Never blocks.
  virtual void exchange(Time now) = 0;

  /// Returns the error counters and latencies of the connection, with names `wire.ROBOT.…`.
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const = 0;
};

/// WireVehicle whose emulator connects to its driver through a UDP socket. The Emulator has
/// world_from_body() and velocity_world_mps(). At first the vehicle is on the ground at the robot's
/// start.
template <class Emulator>
class EmulatedWireVehicle : public WireVehicle {
 public:
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double radius_m() const override { return radius_m_; }
  [[nodiscard]] Pose3 world_from_body() const override { return emulator_.world_from_body(); }
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const override {
    return emulator_.velocity_world_mps();
  }
  [[nodiscard]] const Emulator& emulator() const { return emulator_; }

 protected:
  /// @throws StartupError if the port of `socket_url` cannot be opened.
  template <class Spec>
  EmulatedWireVehicle(const scenario::RobotSpec& robot, const Spec& spec,
                      const std::string& socket_url, Time start)
      : name_(robot.name),
        radius_m_(robot.limits.radius_m),
        emulator_(spec, start),
        socket_(socket_url),
        stepped_(start) {}

  std::string name_;
  double radius_m_;
  Emulator emulator_;
  VehicleSocket socket_;
  Time stepped_;  ///< time to which the emulator was stepped
};

}  // namespace vantage::sim
