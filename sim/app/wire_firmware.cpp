#include "sim/app/wire_firmware.hpp"

#include <memory>
#include <string>
#include <string_view>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "sim/firmware/ardupilot_link.hpp"
#include "sim/firmware/crazyflie_link.hpp"
#include "sim/firmware/px4_link.hpp"

namespace vantage::sim {
namespace {

MultirotorParameters body_of(const scenario::RobotSpec& robot, const scenario::WindSpec& wind) {
  MultirotorParameters out = robot.crazyflie ? crazyflie_body() : MultirotorParameters{};
  out.wind_world_mps = {wind.x_mps, wind.y_mps, 0.0};
  out.gust_sigma_mps = wind.gust_sigma_mps;
  return out;
}

/// Returns the link between firmware and driver. The driver is the client and sends to
/// `crazyflie.url`.
std::unique_ptr<FirmwareLink> crazyflie_link_to(const scenario::RobotSpec& robot, int instance) {
  constexpr std::string_view kUdp = "udp://";
  const std::string_view url = robot.crazyflie->url;
  const auto address = split_address(url.substr(url.starts_with(kUdp) ? kUdp.size() : 0));
  if (!url.starts_with(kUdp) || !address.ok()) {
    throw StartupError("robot " + robot.name + " has `firmware`: its crazyflie.url must be " +
                       "udp://127.0.0.1:PORT, is '" + std::string(url) + "'");
  }
  CrazyflieLink::Ports ports = CrazyflieLink::ports_of(instance);
  ports.client = address.value().port;
  return std::make_unique<CrazyflieLink>(ports);
}

std::unique_ptr<FirmwareLink> link_to(const scenario::RobotSpec& robot, int instance) {
  if (robot.crazyflie) {
    return crazyflie_link_to(robot, instance);
  }
  if (robot.autopilot->dialect == models::AutopilotDialect::kArdupilot) {
    return std::make_unique<ArdupilotLink>(instance);
  }
  return robot.firmware->serial.empty() ? Px4Link::listening(instance)
                                        : Px4Link::on_serial_line(robot.firmware->serial);
}

}  // namespace

WireFirmware::WireFirmware(const scenario::RobotSpec& robot, const scenario::WindSpec& wind,
                           int instance, std::uint64_t seed)
    : name_(robot.name),
      radius_m_(robot.limits.radius_m),
      flight_(body_of(robot, wind), robot.crazyflie ? crazyflie_noise() : SensorNoise{}, seed,
              robot.start, link_to(robot, instance)),
      now_(flight_.at(monotonic_ns())) {}

void WireFirmware::step(Time now, double dt_s) {
  const std::int64_t wanted_ns =
      has_clock_ ? to_utime(now + from_seconds(dt_s)) * 1'000 + monotonic_minus_clock_ns_
                 : monotonic_ns();
  now_ = flight_.at(wanted_ns);
}

void WireFirmware::exchange(Time now) {
  monotonic_minus_clock_ns_ = monotonic_ns() - to_utime(now) * 1'000;
  has_clock_ = true;
}

std::vector<models::NamedCount> WireFirmware::counters() const {
  const FirmwareFlight::Counts counts = flight_.counts();
  const std::string prefix = "wire." + name_ + ".firmware_";
  return {{prefix + "silences", counts.silences},
          {prefix + "resumed", counts.resumed},
          {prefix + "dropped", counts.dropped}};
}

}  // namespace vantage::sim
