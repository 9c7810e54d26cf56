#include "drivers/crazyflie/app/node.hpp"

#include <utility>

#include "core/check.hpp"
#include "drivers/crazyflie/radio_port.hpp"
#include "wire/crtp/link_uri.hpp"

namespace vantage::drivers {

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
    : FlightNode("CRAZYFLIE_" + robot, bus, clock, scenario, robot, std::move(port), cache) {}

bool CrazyflieNode::receive(std::span<const std::uint8_t> bytes, Time now) {
  return driver().receive(bytes, now);
}

}  // namespace vantage::drivers
