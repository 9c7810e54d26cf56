#include "tools/check/arming_watch.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "bus/auth/authenticator.hpp"
#include "core/utf8.hpp"

namespace vantage::tools {
namespace {

/// Returns a sentence for the operator that explains why bus::auth refused a message.
const char* explain(std::string_view reason) {
  constexpr std::array<std::pair<std::string_view, const char*>, 12> kWords{{
      {"unsigned", "not signed: the sender runs without security, or does not belong to the trial"},
      {"unknown_key", "signed with a key that is not in the key folder: another or a revoked key"},
      {"wrong_role", "signed with a key of a role that may not publish on this channel"},
      {"bad_mac", "content does not match its signature: forged"},
      {"bad_signature", "not signed by an operator station: forged"},
      {"over_budget", "too many to verify: probably a flood of forged commands"},
      {"wrong_mode", "from a simulation, a replay or another kind of trial"},
      {"stale",
       "time stamp not current: an old log is played, or the hosts' clocks differ by over 2 s"},
      {"replayed", "received before: an earlier message was sent again"},
      {"wrong_session", "a command of an earlier session"},
      {"wrong_destination", "a command of a station that receives no messages from this vehicle"},
      {"no_key", "published unsigned: this host has no key for the channel"},
  }};
  const auto found = std::find_if(kWords.begin(), kWords.end(),
                                  [&](const auto& entry) { return entry.first == reason; });
  return found == kWords.end() ? "refused" : found->second;
}

}  // namespace

ArmingWatch::ArmingWatch(bus::Bus& bus, const scenario::Scenario& scenario)
    : bus_(bus), scenario_(scenario) {
  // Subscribes so that messages that cannot be decoded are counted.
  bus.subscribe<models::RobotPlan>(bus::plan_channel("*"), [](const models::RobotPlan&) {});
  bus.subscribe<models::ScenarioNotice>(bus::kScenario, [](const models::ScenarioNotice&) {});
  bus.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"),
                                       [this](const models::VehicleStatus& status) {
                                         if (scenario_.find_robot(status.robot) != nullptr) {
                                           vehicles_[status.robot] = status;
                                         }
                                       });
  bus.subscribe<models::MocapFrame>(bus::kVicon, [this](const models::MocapFrame& frame) {
    ++frames_;
    for (const models::MocapBody& body : frame.bodies) {
      if (scenario_.find_robot(body.name) != nullptr) {
        frames_with_[body.name] += body.occluded ? 0 : 1;
      }
    }
  });
  bus.subscribe<models::OperatorCommand>(
      bus::kCommand, [this](const models::OperatorCommand& command) {
        const bool beats = command.action == models::OperatorAction::kHeartbeat;
        heartbeats_ += beats ? 1 : 0;
      });
  bus.subscribe<models::ProcessHealth>(
      bus::health_channel("*"), [this](const models::ProcessHealth& health) { on_health(health); });
}

// Each process counts from its start, so only the growth since its first received message counts.
void ArmingWatch::on_health(const models::ProcessHealth& health) {
  if (!processes_.contains(health.process) && processes_.size() >= kProcessesMax) {
    return;
  }
  const bool is_first = !std::exchange(processes_[health.process], true);
  for (const models::NamedCount& counter : health.counters) {
    auto& known = refusals_[health.process];
    const bool has_room = known.contains(counter.name) || known.size() < kRefusalsMax;
    if (has_room && bus::auth::parse_refusal(counter.name)) {
      Growth& growth = known[counter.name];
      growth.first = is_first ? counter.count : growth.first;
      growth.last = counter.count;
    }
  }
}

void ArmingWatch::append_refusals(std::vector<std::string>& out) const {
  for (const models::NamedCount& counter : bus_.counters()) {
    if (const auto refusal = bus::auth::parse_refusal(counter.name)) {
      out.push_back(fmt::format("{}: {} messages refused here ({}): {}", readable(refusal->channel),
                                counter.count, refusal->reason, explain(refusal->reason)));
    }
  }
  for (const auto& [process, counters] : refusals_) {
    for (const auto& [name, growth] : counters) {
      const auto refusal = bus::auth::parse_refusal(name);
      if (refusal && growth.last > growth.first) {
        out.push_back(fmt::format("{}: process {} refused {} messages during this check ({}): {}",
                                  readable(refusal->channel), readable(process),
                                  growth.last - growth.first, refusal->reason,
                                  explain(refusal->reason)));
      }
    }
  }
}

std::vector<std::string> ArmingWatch::blocks() const {
  std::vector<std::string> out;
  if (frames_ == 0) {
    out.emplace_back("no mocap frame received on VICON: try vantage doctor");
  }
  if (heartbeats_ == 0) {
    out.emplace_back("no operator heartbeat received on COMMAND: start vantage console");
  }
  for (const models::NamedCount& counter : bus_.counters()) {
    constexpr std::string_view kUndecoded = ".decode_errors";
    if (counter.name.ends_with(kUndecoded)) {
      out.push_back(fmt::format(
          "{} messages on {} cannot be decoded: a process of another version of vantage is running",
          counter.count, counter.name.substr(0, counter.name.size() - kUndecoded.size())));
    }
  }
  append_refusals(out);
  for (const scenario::RobotSpec& robot : scenario_.robots) {
    const auto shown = frames_with_.find(robot.name);
    const int count = shown == frames_with_.end() ? 0 : shown->second;
    if (frames_ > 0 && count == 0) {
      out.push_back(
          fmt::format("robot {}: mocap frames contain no body with this name", robot.name));
    } else if (count < frames_ * 9 / 10) {
      out.push_back(fmt::format("robot {}: occluded in {} of {} frames", robot.name,
                                frames_ - count, frames_));
    }
    const auto vehicle = vehicles_.find(robot.name);
    if (vehicle == vehicles_.end()) {
      out.push_back(fmt::format("robot {}: no status from its driver received on VEHICLE_{}",
                                robot.name, robot.name));
      continue;
    }
    const models::VehicleStatus& status = vehicle->second;
    if (status.state == models::FlightState::kKilled) {
      out.push_back(fmt::format(
          "robot {}: killed; to clear this, send arm when it is on the ground", robot.name));
    }
    if (status.state == models::FlightState::kIdle ||
        status.state == models::FlightState::kKilled) {
      for (const std::string& reason : status.reasons) {
        out.push_back(fmt::format("robot {}: {}", robot.name, readable(reason)));
      }
    }
  }
  return out;
}

}  // namespace vantage::tools
