#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "drivers/rover/driver.hpp"
#include "drivers/vehicle/app/vehicle_node.hpp"
#include "drivers/vehicle/estimated_pose.hpp"

namespace vantage::drivers {

/// Bus node of vantage-rover for one robot; publishes VEHICLE_R. It sends a command on its port
/// every 20 ms, and immediately after an operator command. With localizer.safety.rovers_may_drive
/// it drives by POSE_R and ODOMETRY_R while motion capture does not see the rover.
class RoverNode : public VehicleNode<RoverDriver> {
 public:
  /// @throws UsageError for a robot that is not in the scenario or not a rover.
  RoverNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
            const std::string& robot, std::unique_ptr<Port> port);

 private:
  void subscribe_to_estimates(bus::Bus& bus, const scenario::RobotSpec& robot);
  void on_mocap(const models::MocapFrame& frame, Time now) override;
  void on_command(const models::OperatorCommand& command, Time now) override;
  bool receive(std::span<const std::uint8_t> datagram, Time now) override;
  void act(Time now) override;

  std::optional<EstimatedPose> estimate_;  ///< present only if the rover may drive by POSE_R
};

}  // namespace vantage::drivers
