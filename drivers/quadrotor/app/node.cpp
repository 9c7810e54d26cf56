#include "drivers/quadrotor/app/node.hpp"

#include <utility>

#include "bus/auth/secret.hpp"

namespace vantage::drivers {
namespace {

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
    : FlightNode("QUADROTOR_" + robot, bus, clock, scenario, robot, std::move(port),
                 load_key(key_file_of(scenario, robot))) {}

bool QuadrotorNode::receive(std::span<const std::uint8_t> bytes, Time now) {
  return driver().receive(bytes, port().is_datagram(), now);
}

}  // namespace vantage::drivers
