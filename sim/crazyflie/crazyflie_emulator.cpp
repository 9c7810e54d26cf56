#include "sim/crazyflie/crazyflie_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/angle.hpp"
#include "wire/crtp/compression.hpp"
#include "wire/crtp/system.hpp"

namespace vantage::sim {
namespace {

namespace crtp = wire::crtp;
using crtp::Packet;
using crtp::Port;
using crtp::ValueType;

constexpr std::uint32_t kProtocol = 12;
constexpr double kMellinger = 2.0;

/// True for a set-point packet that crashes the firmware by a failed assertion.
bool is_deadly(const Packet& packet) {
  if (packet.port != Port::kSetpoint) {
    return false;
  }
  if (packet.size == 0) {
    return true;
  }
  if (packet.channel == 1) {
    return packet.data[0] == 0 && packet.size != 5;
  }
  constexpr std::uint8_t kFullState = 6;
  constexpr std::uint8_t kVelocity = 8;
  constexpr std::uint8_t kHover = 10;
  const std::uint8_t kind = packet.data[0];
  return (kind == kFullState && packet.size != 29) ||
         ((kind == kVelocity || kind == kHover) && packet.size != 17);
}

double yaw_of(const Quaternion& rotation) {
  return flatten({Eigen::Vector3d::Zero(), rotation}).yaw_rad;
}

}  // namespace

CrazyflieEmulator::CrazyflieEmulator(const CrazyflieEmulatorSpec& spec, Time boot)
    : id_(spec.id),
      boot_(boot),
      now_(boot),
      stepped_(boot),
      body_(spec.body, spec.seed, spec.start),
      control_(spec.body),
      supervisor_(spec.arms_itself),
      tables_(parameters(), logs()) {}

std::vector<CrazyflieVariable> CrazyflieEmulator::parameters() const {
  const auto row = [](const char* group, const char* name, ValueType type, double value,
                      bool is_read_only = false) {
    return CrazyflieVariable{group, name, type, is_read_only, value, nullptr};
  };
  return {row("stabilizer", "estimator", ValueType::kU8, 1.0),
          row("stabilizer", "controller", ValueType::kU8, 1.0),
          row("stabilizer", "stop", ValueType::kU8, 0.0),
          row("kalman", "resetEstimation", ValueType::kU8, 0.0),
          row("kalman", "initialX", ValueType::kF32, 0.0),
          row("kalman", "initialY", ValueType::kF32, 0.0),
          row("kalman", "initialZ", ValueType::kF32, 0.0),
          row("kalman", "initialYaw", ValueType::kF32, 0.0),
          row("locSrv", "extPosStdDev", ValueType::kF32, 0.01),
          row("locSrv", "extQuatStdDev", ValueType::kF32, 0.0045),
          row("hlCommander", "groupmask", ValueType::kU8, 0.0),
          row("supervisor", "prefltTimeout", ValueType::kU16, 30000.0),
          row("supervisor", "landedTimeout", ValueType::kU16, 3000.0),
          row("cpu", "flash", ValueType::kU16, 1024.0, true)};
}

std::vector<CrazyflieVariable> CrazyflieEmulator::logs() {
  const auto row = [](const char* group, const char* name, ValueType type,
                      std::function<double()> measure) {
    return CrazyflieVariable{group, name, type, false, 0.0, std::move(measure)};
  };
  const auto position = [this](int axis) {
    return [this, axis] { return estimate().translation_m(axis); };
  };
  const auto velocity = [this](int axis) {
    return [this, axis] { return estimated_velocity_mps()(axis); };
  };
  const auto attitude = [this] {
    return static_cast<double>(crtp::compress(estimate().rotation).value_or(0));
  };
  const auto variance = [this] {
    const double sigma_m = memory_.sigma_m(now_);
    return sigma_m * sigma_m;
  };
  const auto rate = [this](int axis) {
    return [this, axis] { return body_.rate_body_radps()(axis) * 180.0 / kPi; };
  };
  const auto volt = [this] { return battery_v_.value_or(body_.battery_v()); };
  return {
      row("stateEstimate", "x", ValueType::kF32, position(0)),
      row("stateEstimate", "y", ValueType::kF32, position(1)),
      row("stateEstimate", "z", ValueType::kF32, position(2)),
      row("stateEstimate", "vx", ValueType::kF32, velocity(0)),
      row("stateEstimate", "vy", ValueType::kF32, velocity(1)),
      row("stateEstimate", "vz", ValueType::kF32, velocity(2)),
      row("stateEstimateZ", "quat", ValueType::kU32, attitude),
      row("gyro", "x", ValueType::kF32, rate(0)),
      row("gyro", "y", ValueType::kF32, rate(1)),
      row("gyro", "z", ValueType::kF32, rate(2)),
      row("kalman", "varX", ValueType::kF32, variance),
      row("kalman", "varY", ValueType::kF32, variance),
      row("kalman", "varZ", ValueType::kF32, variance),
      row("supervisor", "info", ValueType::kU16, [this] { return static_cast<double>(info()); }),
      row("pm", "vbat", ValueType::kF32, volt),
      row("pm", "vbatMV", ValueType::kU16, [volt] { return std::round(1000.0 * volt()); }),
      row("pm", "batteryLevel", ValueType::kU8,
          [this] { return std::round(100.0 * body_.battery_share()); }),
      row("pm", "state", ValueType::kI8, [] { return 0.0; }),
      row("radio", "rssi", ValueType::kU8, [] { return 40.0; })};
}

void CrazyflieEmulator::receive(crtp::Bytes bytes, Time now) {
  now_ = std::max(now_, now);
  const auto packet = crtp::decode(bytes);
  if (is_dead_) {
    return;
  }
  if (!packet) {
    ++ignored_;
    return;
  }
  process(*packet, now_);
}

void CrazyflieEmulator::process(const Packet& packet, Time now) {
  if (is_deadly(packet)) {
    is_dead_ = true;
    return;
  }
  switch (packet.port) {
    case Port::kLocalisation:
    case Port::kSetpoint:
    case Port::kHighLevel:
      process_flight(packet, now);
      return;
    case Port::kSupervisor:
      process_supervisor(packet, now);
      return;
    case Port::kParameter:
    case Port::kLog:
      if (const auto answer = tables_.receive(packet, now)) {
        reply(*answer);
      }
      if (tables_.parameter("kalman.resetEstimation") != 0.0) {
        memory_.reset();
        tables_.set_parameter("kalman.resetEstimation", 0.0);
      }
      if (tables_.parameter("stabilizer.stop") != 0.0) {
        supervisor_.stop(now);
      }
      return;
    case Port::kPlatform:
    case Port::kLink:
      process_platform(packet);
      return;
    case Port::kMemory:
      process_memory(packet);
      return;
    default:
      ++ignored_;
  }
}

// Clients ask for the number of memories when they connect; the emulated vehicle has none.
void CrazyflieEmulator::process_memory(const Packet& packet) {
  constexpr std::uint8_t kCountRequest = 1;
  if (packet.channel != 0 || packet.size != 1 || packet.data[0] != kCountRequest) {
    ++ignored_;
    return;
  }
  Packet out = packet;
  out.data[1] = 0;
  out.size = 2;
  reply(out);
}

void CrazyflieEmulator::process_platform(const Packet& packet) {
  if (packet.port == Port::kLink) {
    if (packet.channel == 1) {
      reply(crtp::source_reply());
    } else if (packet.channel != 2) {  // a request for an echo, or the search for vehicles
      reply(packet);
    }
    return;
  }
  if (packet == crtp::platform_request(crtp::PlatformRequest::kProtocol)) {
    reply(crtp::protocol_reply(kProtocol));
  } else if (packet == crtp::platform_request(crtp::PlatformRequest::kFirmware)) {
    reply(crtp::platform_text_reply(crtp::PlatformRequest::kFirmware, "2026.08"));
  } else if (packet == crtp::platform_request(crtp::PlatformRequest::kDevice)) {
    reply(crtp::platform_text_reply(crtp::PlatformRequest::kDevice, "CF21"));
  } else {
    ++ignored_;
  }
}

void CrazyflieEmulator::process_supervisor(const Packet& packet, Time now) {
  const auto request = crtp::decode_supervisor_request(packet);
  if (!request) {
    ++ignored_;
    return;
  }
  if (request->is_info) {
    reply(crtp::info_reply(info()));
    return;
  }
  switch (request->command) {
    case crtp::SupervisorCommand::kArm: {
      const bool is_ok = supervisor_.arm(request->is_to_arm, now);
      reply(crtp::supervisor_reply(request->command, is_ok,
                                   (supervisor_.bits() & crtp::info::kArmed) != 0));
      return;
    }
    case crtp::SupervisorCommand::kRecover: {
      const bool is_ok = supervisor_.recover();
      reply(crtp::supervisor_reply(request->command, is_ok, is_ok));
      return;
    }
    case crtp::SupervisorCommand::kEmergencyStop:
      supervisor_.stop(now);
      return;
    case crtp::SupervisorCommand::kStopWatchdog:
      supervisor_.feed_watchdog(now);
      return;
  }
}

void CrazyflieEmulator::process_flight(const Packet& packet, Time now) {
  const auto message = crtp::decode_flight(packet);
  if (!message) {
    if (packet.port == Port::kHighLevel) {
      reply(crtp::encode_reply(packet, crtp::kHighLevelUnknown).value_or(packet));
    } else if (packet.port == Port::kLocalisation) {
      process_supervisor(packet, now);  // the emergency-stop request of older firmware
    } else {
      ++ignored_;
    }
    return;
  }
  if (packet.port == Port::kHighLevel) {
    const std::uint8_t error = command(*message, now);
    reply(crtp::encode_reply(packet, error).value_or(packet));
    return;
  }
  if (const auto* full = std::get_if<crtp::FullStateSetpoint>(&*message)) {
    take_setpoint({full->position_world_m, full->velocity_world_mps, full->acceleration_world_mps2,
                   yaw_of(full->world_from_body), false},
                  true, now);
  } else if (const auto* position = std::get_if<crtp::PositionSetpoint>(&*message)) {
    ControlGoal wanted;
    wanted.position_world_m = position->position_world_m;
    wanted.yaw_rad = position->yaw_rad;
    take_setpoint(wanted, true, now);
  } else if (std::holds_alternative<crtp::StopSetpoint>(*message)) {
    take_setpoint({}, false, now);
  } else if (const auto* end = std::get_if<crtp::SetpointsEnd>(&*message)) {
    if (low_level_) {
      low_level_->valid_until = now + Duration{1000} * end->valid_for_ms;
    }
  } else if (const auto* pose = std::get_if<crtp::ExternalPose>(&*message)) {
    take_pose(*pose, true, now);
  } else if (const auto* place = std::get_if<crtp::ExternalPosition>(&*message)) {
    take_pose({place->position_world_m, Quaternion::Identity()}, false, now);
  } else if (const auto* packed = std::get_if<std::vector<crtp::PackedPose>>(&*message)) {
    for (const crtp::PackedPose& each : *packed) {
      if (each.id == id_) {
        take_pose(each.pose, true, now);
      }
    }
  }
}

void CrazyflieEmulator::take_pose(const crtp::ExternalPose& pose, bool has_rotation, Time now) {
  if (!pose.world_from_body.coeffs().allFinite()) {
    is_dead_ = true;
    return;
  }
  ++poses_;
  const bool is_rotation = has_rotation && pose.world_from_body.norm() > 0.5;
  memory_.take(pose.position_world_m,
               is_rotation ? std::optional(pose.world_from_body) : std::nullopt,
               body_.world_from_body(), now);
}

void CrazyflieEmulator::take_setpoint(const ControlGoal& goal, bool has_motors, Time now) {
  ++setpoints_;
  low_level_ = LowLevel{goal, has_motors, now, std::nullopt};
  level_m_.reset();
  trajectory_.reset();  // each low-level set-point erases a plan of the high-level commander
}

std::uint8_t CrazyflieEmulator::command(const crtp::FlightMessage& message, Time now) {
  if (!supervisor_.can_fly() || supervisor_.is_locked()) {
    return crtp::kHighLevelBusy;
  }
  const Pose3 here = estimate();
  const double yaw_rad = yaw_of(here.rotation);
  if (const auto* height = std::get_if<crtp::HighLevelHeight>(&message)) {
    const bool is_flying = supervisor_.is_flying();
    const bool is_landing = trajectory_ && trajectory_->is_landing;
    if ((!height->is_landing && is_flying && trajectory_) || (height->is_landing && is_landing)) {
      return crtp::kHighLevelRefused;
    }
    const Eigen::Vector3d to_m(here.translation_m.x(), here.translation_m.y(), height->height_m);
    return plan(to_m, height->yaw_rad.value_or(yaw_rad), height->duration_s, height->is_landing,
                now);
  }
  if (const auto* go_to = std::get_if<crtp::HighLevelGoTo>(&message)) {
    const Eigen::Vector3d to_m =
        go_to->position_world_m +
        (go_to->is_relative ? here.translation_m : Eigen::Vector3d(Eigen::Vector3d::Zero()));
    return plan(to_m, go_to->yaw_rad + (go_to->is_relative ? yaw_rad : 0.0), go_to->duration_s,
                false, now);
  }
  trajectory_.reset();  // ends the trajectory
  return crtp::kHighLevelOk;
}

std::uint8_t CrazyflieEmulator::plan(const Eigen::Vector3d& to_m, double yaw_rad, double duration_s,
                                     bool is_landing, Time now) {
  const Pose3 here = estimate();
  trajectory_ =
      Trajectory{here.translation_m,         to_m,      yaw_of(here.rotation), yaw_rad, now,
                 std::max(0.05, duration_s), is_landing};
  return crtp::kHighLevelOk;
}

// Returns the motion that the controller must track; nullopt: motors off.
std::optional<ControlGoal> CrazyflieEmulator::goal(Time now) {
  if (low_level_ && low_level_->valid_until && now >= *low_level_->valid_until) {
    low_level_.reset();
  }
  if (low_level_) {
    if (!low_level_->has_motors) {
      return std::nullopt;
    }
    ControlGoal out = low_level_->goal;
    if (to_seconds(now - low_level_->received) > CrazyflieSupervisor::kLevelsS) {
      level_m_ = level_m_.value_or(estimate().translation_m.z());
      out = {};
      out.is_level = true;
      out.position_world_m.z() = *level_m_;
      out.yaw_rad = low_level_->goal.yaw_rad;
    }
    return out;
  }
  if (!trajectory_) {
    return std::nullopt;
  }
  const double share =
      std::clamp(to_seconds(now - trajectory_->begin) / trajectory_->duration_s, 0.0, 1.0);
  if (trajectory_->is_landing && share >= 1.0) {
    trajectory_.reset();
    return std::nullopt;
  }
  const double s = share * share * share * (10.0 + share * (6.0 * share - 15.0));
  const double rate = 30.0 * share * share * (1.0 - share) * (1.0 - share);
  ControlGoal out;
  const Eigen::Vector3d way_m = trajectory_->to_m - trajectory_->from_m;
  out.position_world_m = trajectory_->from_m + s * way_m;
  out.velocity_world_mps = rate / trajectory_->duration_s * way_m;
  out.yaw_rad = trajectory_->yaw_from_rad +
                s * wrap_to_pi(trajectory_->yaw_to_rad - trajectory_->yaw_from_rad);
  return out;
}

void CrazyflieEmulator::step(Time now) {
  now_ = now;
  constexpr double kDtS = 1e-6 * static_cast<double>(kStep.count());
  const std::optional<ControlGoal> wanted = goal(now);
  const bool may_run = !is_dead_ && supervisor_.may_run_motors();
  Throttles throttles{};
  are_motors_running_ = wanted && may_run;
  if (are_motors_running_) {
    const bool uses_motion = tables_.parameter("stabilizer.controller") == kMellinger;
    throttles = control_.step(*wanted, uses_motion, estimate(), estimated_velocity_mps(),
                              body_.rate_body_radps(), kDtS);
  } else {
    control_.reset();
  }
  body_.step(throttles, kDtS);
  SupervisedFacts facts;
  facts.are_motors_running = are_motors_running_;
  facts.tilt_rad = std::acos(
      std::clamp((body_.world_from_body().rotation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
  if (low_level_) {
    facts.setpoint_age_s = to_seconds(now - low_level_->received);
  }
  if (!is_dead_) {
    supervisor_.step(facts, now);
  }
}

void CrazyflieEmulator::advance_to(Time now) {
  for (Time at = stepped_ + kStep; at <= now; at += kStep) {
    stepped_ = at;
    step(at);
    if (is_dead_) {
      continue;
    }
    std::vector<Packet> due;
    tables_.append_due(at, boot_, due);
    std::ranges::for_each(due, [this](const Packet& packet) { reply(packet); });
  }
}

void CrazyflieEmulator::reply(const Packet& packet) {
  const crtp::Encoded encoded = crtp::encode(packet, 0);
  output_.emplace_back(encoded.bytes().begin(), encoded.bytes().end());
}

std::vector<std::vector<std::uint8_t>> CrazyflieEmulator::take_output() {
  return std::exchange(output_, {});
}

std::uint16_t CrazyflieEmulator::info() const {
  std::uint16_t out = supervisor_.bits();
  const auto set = [&out](std::uint16_t bit, bool is_set) {
    out = static_cast<std::uint16_t>(out | (is_set ? bit : 0U));
  };
  set(crtp::info::kHighLevelActive, !low_level_ && trajectory_.has_value());
  const bool is_done =
      !trajectory_ || to_seconds(now_ - trajectory_->begin) >= trajectory_->duration_s;
  set(crtp::info::kTrajectoryDone, is_done);
  return out;
}

std::optional<Eigen::Vector3d> CrazyflieEmulator::setpoint_m() const {
  return low_level_ ? std::optional(low_level_->goal.position_world_m) : std::nullopt;
}

}  // namespace vantage::sim
