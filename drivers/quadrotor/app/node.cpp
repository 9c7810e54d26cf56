#include "drivers/quadrotor/app/node.hpp"

#include <utility>

#include "bus/auth/secret.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(5);
// Maximum duration of a landing. Before its descent a landing waits at most 20 s for free ground
// below.
constexpr Duration kLanding = std::chrono::seconds(45);

std::string key_file_of(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* spec = scenario.find_robot(robot);
  return spec != nullptr && spec->autopilot ? spec->autopilot->key_file : "";
}

}  // namespace

std::optional<wire::mavlink::SigningKey> load_key(const std::string& file) {
  if (file.empty()) {
    return std::nullopt;
  }
  wire::mavlink::SigningKey key{};
  bus::auth::read_secret_file(file, key, "signing key");
  return key;
}

QuadrotorNode::QuadrotorNode(bus::Bus& bus, const bus::Clock& clock,
                             const scenario::Scenario& scenario, const std::string& robot,
                             std::unique_ptr<Port> port)
    : VehicleNode("QUADROTOR_" + robot, kTickPeriod, kLanding, bus, clock, scenario, robot,
                  std::move(port), load_key(key_file_of(scenario, robot))) {}

void QuadrotorNode::on_mocap(const models::MocapFrame& frame, Time now) {
  driver().on_mocap(frame, now);
  send_output(now);
}

void QuadrotorNode::on_command(const models::OperatorCommand& command, Time now) {
  driver().on_command(command, now);
  act(now);
}

bool QuadrotorNode::receive(std::span<const std::uint8_t> bytes, Time now) {
  return driver().receive(bytes, port().is_datagram(), now);
}

void QuadrotorNode::act(Time now) {
  driver().tick(now);
  send_output(now);
}

void QuadrotorNode::send_output(Time now) {
  for (const WireMessage& message : driver().take_output()) {
    port().write(message, now);
  }
}

}  // namespace vantage::drivers
