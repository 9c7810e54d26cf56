#include "sim/app/wire_crazyflie.hpp"

#include <algorithm>

#include "core/check.hpp"
#include "wire/crtp/link_uri.hpp"

namespace vantage::sim {
namespace {

CrazyflieEmulatorSpec crazyflie_in(const scenario::RobotSpec& robot, const scenario::WindSpec& wind,
                                   std::uint64_t seed) {
  CrazyflieEmulatorSpec out;
  out.start = robot.start;
  out.seed = seed;
  out.body.wind_world_mps = {wind.x_mps, wind.y_mps, 0.0};
  out.body.gust_sigma_mps = wind.gust_sigma_mps;
  return out;
}

/// Returns the URL for VehicleSocket of a connection on which the driver sends first.
std::string socket_url(const scenario::RobotSpec& robot) {
  const std::string url = robot.crazyflie ? robot.crazyflie->url : "";
  const auto parsed = wire::crtp::parse_link_uri(url);
  const auto* udp = parsed.ok() ? std::get_if<wire::crtp::UdpUri>(&parsed.value()) : nullptr;
  if (udp == nullptr) {
    throw StartupError("robot " + robot.name +
                       " has device 'wire': its `crazyflie` needs a `url` " +
                       "udp://HOST:PORT, is '" + url + "'");
  }
  return "udpout://" + udp->host + ":" + std::to_string(udp->port);
}

}  // namespace

WireCrazyflie::WireCrazyflie(const scenario::RobotSpec& robot, const scenario::WindSpec& wind,
                             std::uint64_t seed, Time start)
    : EmulatedWireVehicle(robot, crazyflie_in(robot, wind, seed), socket_url(robot), start) {}

void WireCrazyflie::step(Time now, double dt_s) {
  stepped_ = std::max(stepped_, now + from_seconds(dt_s));
  emulator_.advance_to(stepped_);
}

void WireCrazyflie::exchange(Time /*now*/) {
  socket_.read_each([&](auto bytes, Time /*arrival*/) { emulator_.receive(bytes, stepped_); });
  for (const std::vector<std::uint8_t>& datagram : emulator_.take_output()) {
    socket_.write(datagram);
  }
}

std::vector<models::NamedCount> WireCrazyflie::counters() const {
  const std::string prefix = "wire." + name_ + ".";
  return {{prefix + "ignored", emulator_.ignored()},
          {prefix + "firmware_ended", emulator_.has_crashed_firmware() ? 1 : 0},
          {prefix + "send_errors", socket_.send_errors()}};
}

}  // namespace vantage::sim
