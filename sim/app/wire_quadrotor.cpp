#include "sim/app/wire_quadrotor.hpp"

#include <algorithm>
#include <optional>

#include "core/axes.hpp"
#include "core/check.hpp"
#include "models/exchange/counts.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::sim {
namespace {

const scenario::AutopilotSpec& autopilot_of(const scenario::RobotSpec& robot) {
  if (!robot.autopilot || robot.autopilot->url.empty()) {
    throw StartupError("robot " + robot.name +
                       " has device 'wire': it needs an `autopilot` or a `rover` with a `url`");
  }
  if (!robot.autopilot->key_file.empty()) {
    throw StartupError("robot " + robot.name +
                       ": the simulated autopilot cannot sign; remove `key_file`");
  }
  return *robot.autopilot;
}

AutopilotEmulatorSpec spec_of(const scenario::RobotSpec& robot,
                              const std::optional<scenario::WindSpec>& wind, std::uint8_t system_id,
                              std::uint64_t seed) {
  const scenario::AutopilotSpec& autopilot = autopilot_of(robot);
  AutopilotEmulatorSpec spec;
  spec.dialect = autopilot.dialect;
  spec.system_id =
      autopilot.system_id > 0 ? static_cast<std::uint8_t>(autopilot.system_id) : system_id;
  spec.start = lift(robot.start, 0.0);
  spec.seed = seed;
  spec.airframe = airframe_in(wind);
  return spec;
}

Time step_at_or_before(Time time) {
  const Duration step = AutopilotEmulator::kStep;
  return from_utime(to_utime(time) / step.count() * step.count());
}

}  // namespace

AirframeParameters airframe_in(const std::optional<scenario::WindSpec>& wind) {
  AirframeParameters out;
  if (wind) {
    out.wind_mean_mps = convert_axes(Eigen::Vector3d(wind->x_mps, wind->y_mps, 0.0));
    out.wind_sigma_mps = wind->gust_sigma_mps;
  }
  return out;
}

WireQuadrotor::WireQuadrotor(const scenario::RobotSpec& robot,
                             const std::optional<scenario::WindSpec>& wind, std::uint8_t system_id,
                             std::uint64_t seed, Time start)
    : EmulatedWireVehicle(robot, spec_of(robot, wind, system_id, seed), autopilot_of(robot).url,
                          step_at_or_before(start)) {}

void WireQuadrotor::step(Time now, double dt_s) {
  stepped_ = std::max(stepped_, step_at_or_before(now + from_seconds(dt_s)));
  emulator_.advance_to(stepped_);
}

void WireQuadrotor::exchange(Time now) {
  // Limits the reception time to the emulator's present step: a later time would skip steps.
  const Time received_at =
      std::clamp(now, stepped_, stepped_ + AutopilotEmulator::kStep - Duration{1});
  socket_.read_each([&](auto bytes, Time arrival) {
    watcher_.feed(bytes, [&](const wire::mavlink::Frame& frame) { measure(frame, arrival); });
    emulator_.receive(bytes, received_at);
  });
  for (const std::vector<std::uint8_t>& datagram : emulator_.take_output()) {
    socket_.write(datagram);
  }
}

void WireQuadrotor::measure(const wire::mavlink::Frame& frame, Time arrival) {
  std::optional<std::uint64_t> capture_us;
  if (const auto odometry = wire::mavlink::unpack<wire::mavlink::Odometry>(frame)) {
    capture_us = odometry->time_usec;
  } else if (const auto vision =
                 wire::mavlink::unpack<wire::mavlink::VisionPositionEstimate>(frame)) {
    capture_us = vision->usec;
  }
  if (capture_us) {
    newest_capture_ = from_utime(static_cast<std::int64_t>(*capture_us));
    pose_age_.add(arrival - newest_capture_);
  } else if (newest_capture_ != Time{} &&
             wire::mavlink::unpack<wire::mavlink::SetPositionTargetLocalNed>(frame)) {
    setpoint_age_.add(arrival - newest_capture_);
  }
}

std::vector<models::NamedCount> WireQuadrotor::counters() const {
  std::vector<models::NamedCount> out;
  const std::string prefix = "wire." + name_ + ".";
  models::append_latency(out, prefix + "pose", pose_age_);
  models::append_latency(out, prefix + "setpoint", setpoint_age_);
  out.push_back({prefix + "ignored", emulator_.ignored()});
  out.push_back({prefix + "bytes_skipped", watcher_.counts().bytes_skipped});
  out.push_back({prefix + "send_errors", socket_.send_errors()});
  return out;
}

}  // namespace vantage::sim
