#include "tools/check/vehicle_check.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::tools {
namespace {

// Returns the robot's autopilot settings with the policy `verify` for parameters instead of the
// scenario's policy.
scenario::AutopilotSpec spec_of(const scenario::RobotSpec& robot) {
  require(robot.autopilot.has_value(), "vehicle check: robot " + robot.name + " has no autopilot");
  scenario::AutopilotSpec out = *robot.autopilot;
  out.parameters = scenario::ParameterPolicy::kVerify;
  return out;
}

}  // namespace

VehicleCheck::VehicleCheck(const scenario::RobotSpec& robot,
                           const std::optional<wire::mavlink::SigningKey>& key, Time now)
    : robot_(robot.name), spec_(spec_of(robot)), link_(spec_, key), started_(now) {}

void VehicleCheck::load() { link_.repair_parameters(); }

bool VehicleCheck::is_done(Time now) const {
  if (link_.fault(now)) {
    return now - started_ > kFirstMessageTimeout;
  }
  return link_.telemetry().is_armed() || link_.parameters().is_complete();
}

std::optional<std::string> VehicleCheck::fault(Time now) const {
  if (const auto fault = link_.fault(now)) {
    return *fault + " at " + spec_.url;
  }
  const drivers::ParameterCheck& parameters = link_.parameters();
  if (!parameters.is_complete()) {
    return link_.telemetry().is_armed()
               ? "its motors are running: disarm it before reading or writing parameters"
               : fmt::format("only {} of {} parameters were read", settled(), size());
  }
  const auto entries = parameters.entries();
  const bool is_mute = std::none_of(entries.begin(), entries.end(),
                                    [](const auto& entry) { return entry.actual.has_value(); });
  return is_mute
             ? std::optional<std::string>("the autopilot reported none of the requested parameters")
             : std::nullopt;
}

std::vector<drivers::ParameterCheck::Entry> VehicleCheck::differences() const {
  std::vector<drivers::ParameterCheck::Entry> out = link_.parameters().entries();
  std::erase_if(out, [](const auto& entry) { return entry.is_kept(); });
  return out;
}

std::vector<const scenario::RobotSpec*> robots_with_autopilot(const scenario::Scenario& scenario) {
  std::vector<const scenario::RobotSpec*> out;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (robot.device != scenario::DeviceSource::kDirect && robot.autopilot &&
        !robot.autopilot->url.empty()) {
      out.push_back(&robot);
    }
  }
  return out;
}

std::vector<std::string> describe(const VehicleCheck& vehicle, Time now) {
  const std::string who = fmt::format("robot {} ({})", vehicle.robot(), name_of(vehicle.dialect()));
  if (const auto fault = vehicle.fault(now)) {
    return {who + ": " + *fault};
  }
  const auto differences = vehicle.differences();
  if (differences.empty()) {
    return {fmt::format("{}: all {} parameters have the required values", who, vehicle.size())};
  }
  std::vector<std::string> out{
      fmt::format("{}: {} of {} parameters differ", who, differences.size(), vehicle.size()),
      fmt::format("  {:<16} {:>9}  {:<20}  {}", "parameter", "value", "required",
                  "effect of a wrong value")};
  for (const auto& [rule, actual, is_settled] : differences) {
    out.push_back(fmt::format("  {:<16} {:>9}  {:<20}  {}{}", rule.name,
                              actual ? wire::parameter_text(*actual) : "missing",
                              rule.requirement_text(), rule.effect,
                              rule.is_advised ? " (recommended)" : ""));
  }
  return out;
}

}  // namespace vantage::tools
