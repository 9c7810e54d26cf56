#include "drivers/crazyflie/app/node.hpp"

#include <utility>

#include "core/check.hpp"
#include "drivers/crazyflie/radio_port.hpp"
#include "wire/crtp/link_uri.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(5);
// Maximum duration of a landing. Before its descent a landing waits at most 20 s for free ground
// below.
constexpr Duration kLanding = std::chrono::seconds(45);

}  // namespace

std::unique_ptr<Port> open_crazyflie_port(const std::string& uri) {
  const auto parsed = wire::crtp::parse_link_uri(uri);
  if (!parsed.ok()) {
    throw StartupError(parsed.error().message);
  }
  if (const auto* udp = std::get_if<wire::crtp::UdpUri>(&parsed.value())) {
    return open_udp_port(udp->host, static_cast<std::uint16_t>(udp->port), true);
  }
  return open_radio_port(std::get<wire::crtp::RadioUri>(parsed.value()));
}

CrazyflieNode::CrazyflieNode(bus::Bus& bus, const bus::Clock& clock,
                             const scenario::Scenario& scenario, const std::string& robot,
                             std::unique_ptr<Port> port, const std::shared_ptr<TableCache>& cache)
    : VehicleNode("CRAZYFLIE_" + robot, kTickPeriod, kLanding, bus, clock, scenario, robot,
                  std::move(port), cache) {}

void CrazyflieNode::on_mocap(const models::MocapFrame& frame, Time now) {
  driver().on_mocap(frame, now);
  send_output(now);
}

void CrazyflieNode::on_command(const models::OperatorCommand& command, Time now) {
  driver().on_command(command, now);
  act(now);
}

bool CrazyflieNode::receive(std::span<const std::uint8_t> bytes, Time now) {
  return driver().receive(bytes, now);
}

void CrazyflieNode::act(Time now) {
  driver().tick(now);
  send_output(now);
}

void CrazyflieNode::send_output(Time now) {
  for (const wire::crtp::Encoded& packet : driver().take_output()) {
    port().write(packet.bytes(), now);
  }
}

}  // namespace vantage::drivers
