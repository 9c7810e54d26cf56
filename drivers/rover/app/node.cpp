#include "drivers/rover/app/node.hpp"

#include <utility>

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(20);
constexpr Duration kStopping = std::chrono::seconds(5);

}  // namespace

RoverNode::RoverNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                     const std::string& robot, std::unique_ptr<Port> port)
    : VehicleNode("ROVER_" + robot, kTickPeriod, kStopping, bus, clock, scenario, robot,
                  std::move(port), static_cast<std::uint32_t>(bus.run_id())) {}

void RoverNode::on_mocap(const models::MocapFrame& frame, Time now) {
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
