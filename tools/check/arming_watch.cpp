#include "tools/check/arming_watch.hpp"

#include <string_view>

#include <fmt/format.h>

namespace vantage::tools {

ArmingWatch::ArmingWatch(bus::Bus& bus, const models::Scenario& scenario)
    : bus_(bus), scenario_(scenario) {
  // Heard so that what does not decode is counted.
  bus.subscribe<models::RobotPlan>(bus::plan_channel("*"), [](const models::RobotPlan&) {});
  bus.subscribe<models::ScenarioNotice>(bus::kScenario, [](const models::ScenarioNotice&) {});
  bus.subscribe<models::VehicleStatus>(
      bus::quadrotor_channel("*"),
      [this](const models::VehicleStatus& status) { vehicles_[status.robot] = status; });
  bus.subscribe<models::MocapFrame>(bus::kVicon, [this](const models::MocapFrame& frame) {
    ++frames_;
    for (const models::MocapBody& body : frame.bodies) {
      frames_with_[body.name] += body.occluded ? 0 : 1;
    }
  });
  bus.subscribe<models::OperatorCommand>(
      bus::kCommand, [this](const models::OperatorCommand& command) {
        const bool beats = command.action == models::OperatorAction::kHeartbeat;
        heartbeats_ += beats ? 1 : 0;
      });
}

std::vector<std::string> ArmingWatch::blocks() const {
  std::vector<std::string> out;
  if (frames_ == 0) {
    out.emplace_back("no mocap frame was heard on VICON: try vantage doctor");
  }
  if (heartbeats_ == 0) {
    out.emplace_back("no operator's heartbeat was heard on COMMAND: start vantage console");
  }
  for (const models::NamedCount& counter : bus_.counters()) {
    constexpr std::string_view kUndecoded = ".decode_errors";
    if (counter.name.ends_with(kUndecoded)) {
      out.push_back(fmt::format(
          "{} messages on {} are not of this version's types: somebody runs another version",
          counter.count, counter.name.substr(0, counter.name.size() - kUndecoded.size())));
    }
  }
  for (const models::RobotSpec& robot : scenario_.robots) {
    const auto shown = frames_with_.find(robot.name);
    const int count = shown == frames_with_.end() ? 0 : shown->second;
    if (frames_ > 0 && count == 0) {
      out.push_back(fmt::format("robot {}: mocap shows no body of that name", robot.name));
    } else if (count < frames_ * 9 / 10) {
      out.push_back(fmt::format("robot {}: occluded in {} of {} frames", robot.name,
                                frames_ - count, frames_));
    }
    const auto vehicle = vehicles_.find(robot.name);
    if (vehicle == vehicles_.end()) {
      out.push_back(
          fmt::format("robot {}: its driver says nothing on QUADROTOR_{}", robot.name, robot.name));
      continue;
    }
    const models::VehicleStatus& status = vehicle->second;
    if (status.state == models::FlightState::kKilled) {
      out.push_back(fmt::format("robot {}: killed; say arm on the ground to clear it", robot.name));
    }
    if (status.state == models::FlightState::kIdle ||
        status.state == models::FlightState::kKilled) {
      for (const std::string& reason : status.reasons) {
        out.push_back(fmt::format("robot {}: {}", robot.name, reason));
      }
    }
  }
  return out;
}

}  // namespace vantage::tools
