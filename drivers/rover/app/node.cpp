#include "drivers/rover/app/node.hpp"

#include <utility>

#include "bus/convert/channels.hpp"
#include "scenario/reader/localizer_yaml.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(20);
constexpr Duration kStopping = std::chrono::seconds(5);

/// Returns the limits of `robot` with the section localizer.safety.
SafetyLimits rover_limits_for(const scenario::Scenario& scenario, const std::string& robot) {
  SafetyLimits limits = limits_for(scenario, robot);
  const auto localizer = scenario::localizer_of(scenario);
  if (localizer && scenario::index_of(*localizer, robot) >= 0) {
    limits.moves_by_estimate = localizer->safety.rovers_may_drive;
    limits.pose_sigma_hold_m = localizer->safety.sigma_hold_m;
    limits.pose_sigma_land_m = localizer->safety.sigma_stop_m;
    limits.pose_sigma_margin = localizer->safety.margin_sigmas;
  }
  return limits;
}

}  // namespace

RoverNode::RoverNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                     const std::string& robot, std::unique_ptr<Port> port)
    : VehicleNode("ROVER_" + robot, kTickPeriod, kStopping, bus, clock, scenario, robot,
                  std::move(port), static_cast<std::uint32_t>(bus.run_id()),
                  rover_limits_for(scenario, robot)) {
  if (rover_limits_for(scenario, robot).moves_by_estimate) {
    const scenario::RobotSpec& spec = *scenario.find_robot(robot);
    estimate_.emplace(spec.name, spec.start, spec.height_m, clock.now());
    subscribe_to_estimates(bus, spec);
  }
}

void RoverNode::subscribe_to_estimates(bus::Bus& bus, const scenario::RobotSpec& robot) {
  bus.subscribe<models::PoseEstimate>(
      bus::pose_channel(robot.name),
      [this](const models::PoseEstimate& estimate) { estimate_->on_pose(estimate); });
  bus.subscribe<models::OdometryReport>(
      bus::odometry_channel(robot.name),
      [this](const models::OdometryReport& odometry) { estimate_->on_odometry(odometry); });
}

void RoverNode::on_mocap(const models::MocapFrame& frame, Time now) {
  if (estimate_) {
    if (const auto filled = estimate_->fill(frame)) {
      driver().on_mocap(filled->frame, now, filled->sigma_m);
      return;
    }
  }
  driver().on_mocap(frame, now);
}

void RoverNode::on_command(const models::OperatorCommand& command, Time now) {
  static_cast<void>(driver().on_command(command, now));  // the driver counts refusals
  if (command.action != models::OperatorAction::kHeartbeat) {
    act(now);
  }
}

bool RoverNode::receive(std::span<const std::uint8_t> datagram, Time now) {
  return driver().receive(datagram, now);
}

void RoverNode::act(Time now) { port().write(driver().tick(now), now); }

}  // namespace vantage::drivers
