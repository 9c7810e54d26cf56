#include "bus/convert/convert_parts.hpp"

// Status of vehicles and processes, commands and events: VEHICLE_R, COMMAND, COLLISION, ATTACK,
// HEALTH_*, HOST_*, SCENARIO.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

namespace {

bool are_texts(std::int32_t count, const std::vector<std::string>& texts) {
  if (!is_count(count, texts.size())) {
    return false;
  }
  for (const std::string& text : texts) {
    if (!is_text(text)) {
      return false;
    }
  }
  return true;
}

}  // namespace

vantage_lcm::vehicle_t to_wire(const models::VehicleStatus& status) {
  auto wire = stamped<vantage_lcm::vehicle_t>(status.stamp);
  wire.robot = status.robot;
  wire.state = static_cast<std::int32_t>(status.state);
  wire.battery_share = status.battery_share;
  wire.setpoint_x_world_m = status.setpoint.x_m;
  wire.setpoint_y_world_m = status.setpoint.y_m;
  wire.setpoint_yaw_world_rad = status.setpoint.yaw_rad;
  wire.setpoint_height_m = status.setpoint_height_m;
  wire.plan_round = status.plan_round;
  wire.num_reasons = count_of(status.reasons.size());
  for (const std::string& reason : status.reasons) {
    wire.reasons.push_back(to_wire_text(reason));
  }
  return wire;
}

std::optional<models::VehicleStatus> from_wire(const vantage_lcm::vehicle_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto state = enumerator_from(wire.state, models::FlightState::kKilled);
  const auto setpoint =
      pose2_from(wire.setpoint_x_world_m, wire.setpoint_y_world_m, wire.setpoint_yaw_world_rad);
  const bool has_battery = wire.battery_share >= 0.0 && wire.battery_share <= 1.0;  // false for NaN
  if (!stamp || !state || !setpoint || !has_battery || !are_finite(wire.setpoint_height_m) ||
      wire.plan_round < -1 || !is_text(wire.robot) || !are_texts(wire.num_reasons, wire.reasons)) {
    return std::nullopt;
  }
  return models::VehicleStatus{
      *stamp,          wire.robot,  *state, wire.battery_share, *setpoint, wire.setpoint_height_m,
      wire.plan_round, wire.reasons};
}

vantage_lcm::command_t to_wire(const models::OperatorCommand& command) {
  auto wire = stamped<vantage_lcm::command_t>(command.stamp);
  wire.action = static_cast<std::int32_t>(command.action);
  wire.robot = command.robot;
  return wire;
}

std::optional<models::OperatorCommand> from_wire(const vantage_lcm::command_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto action = enumerator_from(wire.action, models::OperatorAction::kEmergencyStop);
  if (!stamp || !action || !is_text(wire.robot)) {
    return std::nullopt;
  }
  return models::OperatorCommand{*stamp, *action, wire.robot};
}

vantage_lcm::collision_t to_wire(const models::CollisionReport& contact) {
  auto wire = stamped<vantage_lcm::collision_t>(contact.stamp);
  wire.kind = static_cast<std::int32_t>(contact.kind);
  wire.body_a = contact.body_a;
  wire.body_b = contact.body_b;
  wire.distance_m = contact.distance_m;
  return wire;
}

std::optional<models::CollisionReport> from_wire(const vantage_lcm::collision_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto kind = enumerator_from(wire.kind, models::CollisionKind::kNearMiss);
  if (!stamp || !kind || !is_text(wire.body_a) || !is_text(wire.body_b) ||
      !are_finite(wire.distance_m)) {
    return std::nullopt;
  }
  return models::CollisionReport{*stamp, *kind, wire.body_a, wire.body_b, wire.distance_m};
}

vantage_lcm::attack_t to_wire(const models::AttackNotice& attack) {
  auto wire = stamped<vantage_lcm::attack_t>(attack.stamp);
  wire.num_jammed = count_of(attack.jammed.size());
  wire.jammed = attack.jammed;
  return wire;
}

std::optional<models::AttackNotice> from_wire(const vantage_lcm::attack_t& wire) {
  const auto stamp = stamp_from(wire);
  if (!stamp || !are_texts(wire.num_jammed, wire.jammed)) {
    return std::nullopt;
  }
  return models::AttackNotice{*stamp, wire.jammed};
}

vantage_lcm::health_t to_wire(const models::ProcessHealth& health) {
  auto wire = stamped<vantage_lcm::health_t>(health.stamp);
  wire.process = health.process;
  wire.state = static_cast<std::int32_t>(health.state);
  wire.num_counters = count_of(health.counters.size());
  wire.counters.resize(health.counters.size());
  for (std::size_t i = 0; i < health.counters.size(); ++i) {
    // may contain a channel name from the network
    wire.counters[i].name = to_wire_text(health.counters[i].name);
    wire.counters[i].count = health.counters[i].count;
  }
  wire.loops = health.loops;
  wire.loop_worst_s = health.loop_worst_s;
  wire.deadlines_missed = health.deadlines_missed;
  return wire;
}

std::optional<models::ProcessHealth> from_wire(const vantage_lcm::health_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto state = enumerator_from(wire.state, models::ProcessState::kStopping);
  if (!stamp || !state || !is_text(wire.process) ||
      !is_count(wire.num_counters, wire.counters.size()) || wire.loops < 0 ||
      !are_finite(wire.loop_worst_s) || wire.loop_worst_s < 0.0 || wire.deadlines_missed < 0) {
    return std::nullopt;
  }
  models::ProcessHealth health{
      *stamp, wire.process, *state, {}, wire.loops, wire.loop_worst_s, wire.deadlines_missed};
  health.counters.reserve(wire.counters.size());
  for (const vantage_lcm::counter_t& counter : wire.counters) {
    if (!is_text(counter.name)) {
      return std::nullopt;
    }
    health.counters.push_back({counter.name, counter.count});
  }
  return health;
}

vantage_lcm::host_t to_wire(const models::HostReport& report) {
  auto wire = stamped<vantage_lcm::host_t>(report.stamp);
  wire.host = report.host;
  wire.num_processes = count_of(report.processes.size());
  for (const models::SupervisedProcess& process : report.processes) {
    vantage_lcm::supervised_t& out = wire.processes.emplace_back();
    out.name = process.name;
    out.phase = static_cast<std::int32_t>(process.phase);
    out.restarts = process.restarts;
    out.down_s = process.down_s;
    out.cpu_share = process.cpu_share;
    out.memory_bytes = process.memory_bytes;
    out.last_end = to_wire_text(process.last_end);
  }
  return wire;
}

std::optional<models::HostReport> from_wire(const vantage_lcm::host_t& wire) {
  const auto stamp = stamp_from(wire);
  if (!stamp || !is_text(wire.host) || !is_count(wire.num_processes, wire.processes.size())) {
    return std::nullopt;
  }
  models::HostReport report{*stamp, wire.host, {}};
  report.processes.reserve(wire.processes.size());
  for (const vantage_lcm::supervised_t& process : wire.processes) {
    const auto phase = enumerator_from(process.phase, models::SupervisedPhase::kEnded);
    if (!phase || !is_text(process.name) || !is_text(process.last_end) || process.restarts < 0 ||
        !are_finite(process.down_s, process.cpu_share) || process.down_s < 0.0 ||
        process.cpu_share < 0.0 || process.memory_bytes < 0) {
      return std::nullopt;
    }
    report.processes.push_back({process.name, *phase, process.restarts, process.down_s,
                                process.cpu_share, process.memory_bytes, process.last_end});
  }
  return report;
}

vantage_lcm::scenario_t to_wire(const models::ScenarioNotice& notice) {
  auto wire = stamped<vantage_lcm::scenario_t>(notice.stamp);
  wire.yaml = notice.yaml;
  wire.version = notice.version;
  wire.process = notice.process;
  return wire;
}

std::optional<models::ScenarioNotice> from_wire(const vantage_lcm::scenario_t& wire) {
  const auto stamp = stamp_from(wire);
  if (!stamp || !is_text(wire.yaml, kYamlBytesMax) || !is_text(wire.version) ||
      !is_text(wire.process)) {
    return std::nullopt;
  }
  return models::ScenarioNotice{*stamp, wire.yaml, wire.version, wire.process};
}

}  // namespace vantage::bus
