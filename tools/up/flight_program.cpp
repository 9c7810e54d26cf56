#include "tools/up/flight_program.hpp"

#include <algorithm>

#include "tools/console/station.hpp"

namespace vantage::tools {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr Duration kOrderPeriod = std::chrono::milliseconds(500);
constexpr Duration kHoldPatience = std::chrono::seconds(3);
// On the ground, every 60th order is a hold, which clears the order to arm. If the autopilot has
// stopped the motors, a driver restarts them only after such a hold.
constexpr int kOrdersPerHold = 60;

bool is_at_rest(FlightState state) {
  return state == FlightState::kIdle || state == FlightState::kKilled;
}

bool is_climbing(const models::VehicleStatus& status) {
  return std::any_of(status.reasons.begin(), status.reasons.end(),
                     [](const std::string& reason) { return reason.starts_with("waiting for"); });
}

}  // namespace

FlightProgram::FlightProgram(const std::vector<std::string>& robots) {
  for (const std::string& robot : robots) {
    vehicles_[robot];
  }
}

void FlightProgram::on_status(const models::VehicleStatus& status) {
  const auto found = vehicles_.find(status.robot);
  if (found == vehicles_.end()) {
    return;
  }
  Vehicle& vehicle = found->second;
  const FlightState state = status.state;
  vehicle.has_lifted = vehicle.has_lifted || state != FlightState::kIdle;
  if (state == FlightState::kFollow) {
    have_flown_.insert(status.robot);
  }
  if (state != FlightState::kHold) {
    vehicle.holding_since.reset();
  } else if (!vehicle.holding_since) {
    vehicle.holding_since = status.stamp.time;
  }
  vehicle.status = status;
}

void FlightProgram::on_other_station(const models::OperatorCommand& command, Time now) {
  if (command.action == OperatorAction::kHeartbeat ||
      !Station::is_current(command.stamp.time, now)) {
    return;
  }
  for (auto& [name, vehicle] : vehicles_) {
    vehicle.has_other_station =
        vehicle.has_other_station || command.robot.empty() || command.robot == name;
  }
}

std::optional<OperatorAction> FlightProgram::wanted(Vehicle& vehicle, Time now) const {
  const FlightState state = vehicle.status->state;
  if (is_over_) {
    const bool is_silent = vehicle.was_ordered_to_land && is_at_rest(state);
    vehicle.was_ordered_to_land = true;
    return is_silent ? std::nullopt : std::optional(OperatorAction::kLand);
  }
  if (vehicle.has_other_station) {
    return std::nullopt;
  }
  if (state == FlightState::kIdle && !vehicle.has_lifted) {
    ++vehicle.ground_orders;
    if (vehicle.ground_orders % kOrdersPerHold == 0) {
      return OperatorAction::kHold;
    }
    // Take-off is refused, without harm, until the motors run.
    return vehicle.ground_orders % 2 == 1 ? OperatorAction::kArm : OperatorAction::kTakeOff;
  }
  if (state == FlightState::kHold && !is_climbing(*vehicle.status)) {
    const bool is_first = vehicle.ground_orders > 0;
    if (is_first || now - *vehicle.holding_since >= kHoldPatience) {
      return OperatorAction::kFollow;
    }
  }
  return std::nullopt;
}

std::vector<FlightProgram::Order> FlightProgram::due(Time now) {
  std::vector<Order> out;
  for (auto& [name, vehicle] : vehicles_) {
    if (!vehicle.status || now < vehicle.next_order) {
      continue;
    }
    if (vehicle.status->state == FlightState::kFollow) {
      vehicle.ground_orders = 0;
    }
    if (const auto action = wanted(vehicle, now)) {
      out.push_back({*action, name});
      vehicle.next_order = now + kOrderPeriod;
    }
  }
  return out;
}

bool FlightProgram::is_down() const {
  return std::all_of(vehicles_.begin(), vehicles_.end(), [](const auto& each) {
    const Vehicle& vehicle = each.second;
    return !vehicle.status || (vehicle.was_ordered_to_land && is_at_rest(vehicle.status->state));
  });
}

}  // namespace vantage::tools
