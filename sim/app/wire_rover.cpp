#include "sim/app/wire_rover.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"

namespace vantage::sim {
namespace {

const scenario::RoverSpec& rover_of(const scenario::RobotSpec& robot) {
  if (!robot.rover || robot.rover->url.empty()) {
    throw StartupError("robot " + robot.name +
                       " has device 'wire': it needs a `rover` with a `url`");
  }
  return *robot.rover;
}

// Returns the parameters of the emulated rover. Its limits exceed the scenario's by at least 10 %,
// because a real rover may also be faster than its driver assumes.
RoverEmulatorSpec spec_of(const scenario::RobotSpec& robot, std::uint32_t boot) {
  constexpr double kReserve = 1.1;
  RoverEmulatorSpec spec;
  spec.number = static_cast<std::uint32_t>(rover_of(robot).number);
  spec.boot = boot;
  spec.start = robot.start;
  RoverParameters& limits = spec.limits;
  limits.speed_max_mps = std::max(limits.speed_max_mps, kReserve * robot.limits.speed_max_mps);
  limits.brake_mps2 = std::max(limits.brake_mps2, kReserve * robot.limits.brake_mps2);
  limits.yaw_rate_max_radps =
      std::max(limits.yaw_rate_max_radps, kReserve * robot.limits.yaw_rate_max_radps);
  return spec;
}

}  // namespace

WireRover::WireRover(const scenario::RobotSpec& robot, std::uint32_t boot, Time start)
    : name_(robot.name),
      radius_m_(robot.limits.radius_m),
      height_m_(robot.height_m),
      endpoint_(spec_of(robot, boot), rover_of(robot).url, start),
      stepped_(start) {}

Pose3 WireRover::world_from_body() const {
  return lift(emulator().state().world_from_body, height_m_);
}

Eigen::Vector3d WireRover::velocity_world_mps() const {
  const RoverState& state = emulator().state();
  const double yaw_rad = state.world_from_body.yaw_rad;
  return {state.speed_mps * std::cos(yaw_rad), state.speed_mps * std::sin(yaw_rad), 0.0};
}

void WireRover::step(Time now, double dt_s) {
  stepped_ = std::max(stepped_, now + from_seconds(dt_s));
  endpoint_.emulator().advance_to(stepped_);
}

void WireRover::exchange(Time /*now*/) { endpoint_.run_to(stepped_); }

std::vector<models::NamedCount> WireRover::counters() const {
  const std::string prefix = "wire." + name_ + ".";
  return {{prefix + "refused", emulator().refused()},
          {prefix + "send_errors", endpoint_.send_errors()}};
}

}  // namespace vantage::sim
