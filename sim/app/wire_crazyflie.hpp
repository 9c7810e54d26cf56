#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/app/wire_vehicle.hpp"
#include "sim/crazyflie/crazyflie_emulator.hpp"
#include "sim/vehicle_socket.hpp"

namespace vantage::sim {

/// Emulated Crazyflie on a UDP socket. It begins on the ground at the robot's start.
class WireCrazyflie : public WireVehicle {
 public:
  /// @throws StartupError for a robot without a `crazyflie`, with a url that is not
  /// udp://HOST:PORT,
  ///         or if the port cannot be opened.
  WireCrazyflie(const scenario::RobotSpec& robot, const scenario::WindSpec& wind,
                std::uint64_t seed, Time start);

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double radius_m() const override { return radius_m_; }
  [[nodiscard]] Pose3 world_from_body() const override { return emulator_.world_from_body(); }
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const override {
    return emulator_.velocity_world_mps();
  }
  void step(Time now, double dt_s) override;
  void exchange(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

  [[nodiscard]] const CrazyflieEmulator& emulator() const { return emulator_; }

 private:
  std::string name_;
  double radius_m_;
  CrazyflieEmulator emulator_;
  VehicleSocket socket_;
  Time stepped_;  ///< time to which the emulator was stepped
};

}  // namespace vantage::sim
