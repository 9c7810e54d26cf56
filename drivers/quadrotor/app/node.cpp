#include "drivers/quadrotor/app/node.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include "core/check.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(5);

std::string key_file_of(const models::Scenario& scenario, const std::string& robot) {
  const models::RobotSpec* spec = scenario.find_robot(robot);
  return spec != nullptr && spec->autopilot ? spec->autopilot->key_file : "";
}

}  // namespace

std::optional<models::mavlink::SigningKey> load_key(const std::string& file) {
  if (file.empty()) {
    return std::nullopt;
  }
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in),
                                std::istreambuf_iterator<char>()};
  models::mavlink::SigningKey key{};
  if (bytes.size() != key.size()) {
    throw StartupError(file + ": a signing key is a file of 32 bytes, this one has " +
                       std::to_string(bytes.size()));
  }
  std::transform(bytes.begin(), bytes.end(), key.begin(),
                 [](char c) { return static_cast<std::uint8_t>(c); });
  return key;
}

QuadrotorNode::QuadrotorNode(bus::Bus& bus, const bus::Clock& clock,
                             const models::Scenario& scenario, const std::string& robot,
                             std::unique_ptr<Port> port)
    : VehicleNode("QUADROTOR_" + robot, kTickPeriod, bus, clock, scenario, robot, std::move(port),
                  load_key(key_file_of(scenario, robot))) {}

void QuadrotorNode::on_mocap(const models::MocapFrame& frame, Time now) {
  driver().on_mocap(frame, now);
  send_output(now);
}

void QuadrotorNode::on_command(const models::OperatorCommand& command, Time now) {
  driver().on_command(command, now);
  act(now);
}

void QuadrotorNode::receive(std::span<const std::uint8_t> bytes, Time now) {
  driver().receive(bytes, port().is_datagram(), now);
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
