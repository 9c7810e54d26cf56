#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/app/wire_vehicle.hpp"
#include "sim/rover/rover_endpoint.hpp"

namespace vantage::sim {

/// Ground robot with an emulated rover on a socket, which uses the protocol of
/// docs/guide/rovers.md. The height of its body is the height of its markers.
class WireRover : public WireVehicle {
 public:
  /// @param boot  boot number sent in the telemetry; must differ at each start
  /// @throws StartupError for a robot without a `rover`, or if a port cannot be opened.
  WireRover(const scenario::RobotSpec& robot, std::uint32_t boot, Time start);

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double radius_m() const override { return radius_m_; }
  [[nodiscard]] Pose3 world_from_body() const override;
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const override;
  void step(Time now, double dt_s) override;
  void exchange(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

  [[nodiscard]] const RoverEmulator& emulator() const { return endpoint_.emulator(); }

 private:
  std::string name_;
  double radius_m_;
  double height_m_;
  RoverEndpoint endpoint_;
  Time stepped_;  ///< time to which the emulator was stepped
};

}  // namespace vantage::sim
