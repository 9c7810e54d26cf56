#include "test/drivers/quadrotor/wire_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>

#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "core/axes.hpp"
#include "drivers/safety/conditions.hpp"
#include "wire/mavlink/frame.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::test {
namespace {

namespace mavlink = wire::mavlink;
using models::AutopilotDialect;
using models::FlightState;
using models::OperatorAction;

constexpr Duration kStep{5'000};  // time step of the emulated autopilots and the nodes
constexpr double kFloorM = 0.05;  // m; height of the markers on the floor
constexpr double kLineS = 0.001;  // s; part of the latency that the server does not report
constexpr double kRunawayLagS = 0.15;
constexpr double kTiltFaultRad = 0.5;  // rad; a smaller tilt_rad is normal motion and not applied
constexpr std::uint8_t kArmedFlag = 0x80;
constexpr std::int8_t kFrozenPercent = 85;
constexpr std::uint32_t kPx4Position = 3U << 16U;
constexpr std::uint32_t kArducopterLoiter = 5;

bool is_battery(std::uint32_t message_id) {
  return message_id == mavlink::BatteryStatus::kMessage.id ||
         message_id == mavlink::SysStatus::kMessage.id;
}

/// Changes the payload of `frame` by `change` if the frame contains a `Message`.
template <class Message, class Change>
void alter(mavlink::Frame& frame, const Change& change) {
  if (auto message = mavlink::unpack<Message>(frame)) {
    change(*message);
    frame = mavlink::pack(*message, frame.origin);
  }
}

/// Returns the disturbance acceleration of the vehicle, m/s². The runaway fault accelerates the
/// vehicle up to its runaway speed.
Eigen::Vector3d push_mps2(const Vehicle& vehicle) {
  const Eigen::Vector3d& runaway_mps = vehicle.knobs.runaway_mps;
  const double speed_mps = runaway_mps.norm();
  if (speed_mps <= 0.0) {
    return vehicle.knobs.push_mps2;
  }
  const Eigen::Vector3d along = runaway_mps / speed_mps;
  const double missing_mps = std::max(0.0, speed_mps - vehicle.velocity_mps.dot(along));
  return vehicle.knobs.push_mps2 + along * missing_mps / kRunawayLagS;
}

/// Returns the message by which ArduCopter reports a motor without thrust.
mavlink::Statustext thrust_loss() {
  constexpr std::string_view kText = "Potential Thrust Loss (1)";
  mavlink::Statustext out;
  out.severity = 0;
  std::copy(kText.begin(), kText.end(), out.text.begin());
  return out;
}

/// Applies the faults to one message of the autopilot; returns false if it is lost.
bool passes(const VehicleKnobs& knobs, mavlink::Frame& frame) {
  if (knobs.telemetry_cut && frame.message_id != mavlink::Heartbeat::kMessage.id) {
    return false;
  }
  if (knobs.battery_silent && is_battery(frame.message_id)) {
    return false;
  }
  if (knobs.battery_frozen) {
    alter<mavlink::BatteryStatus>(
        frame, [](auto& message) { message.battery_remaining = kFrozenPercent; });
    alter<mavlink::SysStatus>(frame,
                              [](auto& message) { message.battery_remaining = kFrozenPercent; });
  }
  if (knobs.reports_disarmed) {
    alter<mavlink::Heartbeat>(frame, [](auto& message) {
      message.base_mode = static_cast<std::uint8_t>(message.base_mode & ~kArmedFlag);
    });
  }
  if (knobs.estimator_bad) {
    alter<mavlink::EstimatorStatus>(frame, [](auto& message) { message.flags = 0; });
    alter<mavlink::EkfStatusReport>(frame, [](auto& message) { message.flags = 0; });
  }
  if (knobs.motor_failed) {
    alter<mavlink::SysStatus>(frame, [](auto& message) {
      message.onboard_control_sensors_present |= mavlink::kSensorMotorOutputs;
      message.onboard_control_sensors_enabled |= mavlink::kSensorMotorOutputs;
      message.onboard_control_sensors_health &= ~mavlink::kSensorMotorOutputs;
    });
  }
  alter<mavlink::LocalPositionNed>(frame, [&](auto& message) {
    message.x += mavlink::f32(knobs.estimate_offset_m);
    message.vx += mavlink::f32(knobs.velocity_offset_mps);
  });
  alter<mavlink::Attitude>(frame, [&](auto& message) {
    message.roll = std::abs(knobs.tilt_rad) > kTiltFaultRad
                       ? mavlink::f32(knobs.tilt_rad)
                       : message.roll + mavlink::f32(knobs.attitude_offset_rad);
    message.yaw -= mavlink::f32(knobs.yaw_offset_rad);
  });
  return true;
}

}  // namespace

std::size_t WirePort::read(std::span<std::uint8_t> buffer, Time /*now*/) {
  if (to_driver.empty()) {
    return 0;
  }
  const std::vector<std::uint8_t> datagram = std::move(to_driver.front());
  to_driver.pop_front();
  std::copy(datagram.begin(), datagram.end(), buffer.begin());
  return datagram.size();
}

void WirePort::write(std::span<const std::uint8_t> message, Time /*now*/) {
  to_vehicle.emplace_back(message.begin(), message.end());
}

scenario::Scenario WireBench::wire_scenario(AutopilotDialect dialect) {
  const auto other =
      dialect == AutopilotDialect::kPx4 ? AutopilotDialect::kArdupilot : AutopilotDialect::kPx4;
  scenario::Scenario out = FlightBench::scenario();
  out.mocap = spec_of(scenario::MocapProtocol::kDataStream);
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    out.robots[i].autopilot =
        scenario::AutopilotSpec{i == 1 ? other : dialect, "udp://127.0.0.1:1", 1, ""};
  }
  return out;
}

WireBench::WiredVehicle::WiredVehicle(WireBench& bench, const scenario::RobotSpec& robot,
                                      std::uint64_t seed, Time start)
    : side(bench.hub_.connect()),
      bus(*side, 100 + static_cast<std::int64_t>(seed)),
      port(new WirePort),
      node(bus, bench.clock_, bench.bench_scenario(), robot.name,
           std::unique_ptr<drivers::Port>(port)),
      emulator(
          [&] {
            sim::AutopilotEmulatorSpec spec;
            spec.dialect = robot.autopilot->dialect;
            spec.start = lift(robot.start, kFloorM);
            spec.seed = seed;
            return spec;
          }(),
          start) {}

WireBench::WireBench(std::uint64_t seed, AutopilotDialect dialect)
    : FlightBench(seed, wire_scenario(dialect), kWireLeadS),
      clock_(now()),
      vicon_(bench_scenario().mocap, ViconBench::settings_for(bench_scenario().mocap)) {
  vicon_.epoch = now();
  for (std::size_t i = 0; i < bench_scenario().robots.size(); ++i) {
    wired_vehicles_.push_back(
        std::make_unique<WiredVehicle>(*this, bench_scenario().robots[i], seed + i, now()));
  }
  lab_.subscribe<models::VehicleStatus>(
      bus::vehicle_channel("*"),
      [this](const models::VehicleStatus& status) { on_status(status); });
}

bool WireBench::is_px4(const std::string& robot) const {
  return bench_scenario().find_robot(robot)->autopilot->dialect == AutopilotDialect::kPx4;
}

WireBench::WiredVehicle& WireBench::wired_vehicle(const std::string& robot) {
  return *wired_vehicles_[static_cast<std::size_t>(&vehicle(robot) - vehicles().data())];
}

sim::AutopilotEmulator& WireBench::emulator(const std::string& robot) {
  return wired_vehicle(robot).emulator;
}

const std::vector<std::string>& WireBench::reasons_of(const std::string& robot) {
  return wired_vehicle(robot).reasons;
}

void WireBench::on_status(const models::VehicleStatus& status) {
  Vehicle& of = vehicle(status.robot);
  of.out.state = status.state;
  wired_vehicle(status.robot).reasons = status.reasons;
  const auto rows = drivers::conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    of.out.reasons[i] = std::find(status.reasons.begin(), status.reasons.end(), rows[i].name) !=
                        status.reasons.end();
  }
}

std::vector<models::NamedCount> WireBench::counts_of(const Vehicle& vehicle) const {
  const WiredVehicle& of = *wired_vehicles_[static_cast<std::size_t>(
      std::find_if(bench_scenario().robots.begin(), bench_scenario().robots.end(),
                   [&](const auto& robot) { return robot.name == vehicle.name; }) -
      bench_scenario().robots.begin())];
  std::vector<models::NamedCount> out = of.node.counters();
  for (const models::NamedCount& each : of.bus.counters()) {
    out.push_back(each);
  }
  const drivers::vicon::FrameCounts& mocap = vicon_.driver.frame_counts();
  out.insert(out.end(), {{"vicon.poses_refused", mocap.poses_refused},
                         {"vicon.poses_stuck", mocap.poses_stuck},
                         {"vicon.poses_outlying", mocap.poses_outlying},
                         {"vicon.poses_flipped", mocap.poses_flipped},
                         {"vicon.poses_swapped", mocap.poses_swapped},
                         {"vicon.names_twice", mocap.names_twice},
                         {"vicon.frames_late", mocap.frames_late},
                         {"vicon.silences", vicon_.driver.link_counts().silences}});
  return out;
}

std::int64_t WireBench::count_of(const Vehicle& vehicle, const std::string& counter) const {
  for (const models::NamedCount& each : counts_of(vehicle)) {
    if (each.name == counter) {
      return each.count;
    }
  }
  return -1;
}

// Vehicles lift one after the other. A waiting vehicle's order is dropped after 10 s, and after its
// motors have been stopped it needs a new order. All orders are therefore repeated until all
// vehicles have flown.
void WireBench::fly_up(double until_s) {
  constexpr std::int64_t kCycleTicks = 2'000;
  while (time_s() < until_s) {
    const bool all_fly = std::all_of(vehicles().begin(), vehicles().end(),
                                     [](const Vehicle& each) { return each.has_flown; });
    const std::int64_t tick_of_cycle = ticks() % kCycleTicks;
    if (std::abs(time_s() - 3.5) < 0.5 * kTickS) {
      send_command(OperatorAction::kFollow);
    } else if (!all_fly && time_s() < 0.0 && tick_of_cycle == 90) {
      send_command(OperatorAction::kHold);
    } else if (!all_fly && time_s() < 0.0 && tick_of_cycle == 240) {
      send_command(OperatorAction::kArm);
    } else if (!all_fly && time_s() < 0.0 && tick_of_cycle == 250) {
      send_command(OperatorAction::kTakeOff);
    }
    tick();
    if (all_fly) {
      static bool once = false;
      if (!once) {
        once = true;
      }
    }
  }
}

template <class Message>
void WireBench::publish(const std::string& channel, const Message& message) {
  const auto wire = bus::to_wire(message);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, wire.getEncodedSize());
  planner_side_->publish(channel, bytes);
}

void WireBench::deliver(const models::MocapFrame& frame) {
  sim::vicon::EmulatedFrame sent;
  sent.number = static_cast<std::uint32_t>(frame.frame_number + 1);
  sent.captured = frame.stamp.time;
  sent.latency_s = to_seconds(now() - (frame.stamp.time - room().mocap_clock)) - kLineS;
  for (const models::MocapBody& body : frame.bodies) {
    sent.bodies.push_back({body.name, body.world_from_body, body.occluded});
    sent.bodies.back().world_from_body.translation_m.z() += kFloorM - 0.05;
  }
  vicon_.publish(sent);
}

bool WireBench::deliver(Vehicle& vehicle, const models::RobotPlan& plan) {
  publish(bus::plan_channel(vehicle.name).name, plan);
  return vehicle.knobs.plan == PlanFault::kNone;
}

void WireBench::deliver(const models::OperatorCommand& command) {
  publish(bus::kCommand.name, command);
}

void WireBench::change_vehicle(Vehicle& vehicle, WiredVehicle& wired_vehicle, double dt_s) {
  const VehicleKnobs& knobs = vehicle.knobs;
  sim::FlightController& controller = wired_vehicle.emulator.controller();
  if (!controller.airframe().is_on_ground()) {
    controller.airframe().push(dt_s * convert_axes(push_mps2(vehicle)));
  }
  if (knobs.battery_share && !wired_vehicle.charge_share) {
    wired_vehicle.charge_share = controller.airframe().battery_share();
  }
  if (wired_vehicle.charge_share) {
    controller.airframe().set_battery_share(
        knobs.battery_share.value_or(*wired_vehicle.charge_share));
  }
  if (knobs.motors_off) {
    controller.disarm(true);
  }
  if (knobs.mode_left && !std::exchange(wired_vehicle.was_mode_left, true)) {
    controller.set_mode(is_px4(vehicle.name) ? kPx4Position : kArducopterLoiter, clock_.now());
  }
}

void WireBench::pass_telemetry(const Vehicle& vehicle, WiredVehicle& wired_vehicle) {
  for (const auto& datagram : wired_vehicle.emulator.take_output()) {
    if (vehicle.knobs.link_cut) {
      continue;
    }
    mavlink::Parser parser;
    std::vector<std::uint8_t> passed;
    const auto pass = [&](mavlink::Frame frame) {
      if (passes(vehicle.knobs, frame)) {
        mavlink::append_bytes(frame, passed);
      }
      if (vehicle.knobs.motor_failed && frame.message_id == mavlink::Heartbeat::kMessage.id) {
        mavlink::append_bytes(mavlink::pack(thrust_loss(), frame.origin), passed);
      }
    };
    parser.feed(datagram, pass);
    if (!passed.empty()) {
      wired_vehicle.port->to_driver.push_back(std::move(passed));
    }
  }
}

void WireBench::read_truth(Vehicle& vehicle, WiredVehicle& wired_vehicle) {
  const Pose3 pose = wired_vehicle.emulator.world_from_body();
  vehicle.position_m = pose.translation_m;
  vehicle.velocity_mps = wired_vehicle.emulator.velocity_world_mps();
  vehicle.yaw_rad = flatten(pose).yaw_rad;
  vehicle.is_armed = wired_vehicle.emulator.controller().is_armed();
  vehicle.battery_share = wired_vehicle.emulator.controller().airframe().battery_share();
  vehicle.has_flown = vehicle.has_flown || vehicle.position_m.z() > 0.5;
}

void WireBench::move() {
  const bool is_map_changed =
      std::any_of(vehicles().begin(), vehicles().end(),
                  [](const Vehicle& each) { return each.knobs.map_differs; });
  if (is_map_changed && ticks() % 10 == 0) {
    models::ScenarioNotice notice;
    notice.stamp = {now(), 900, ticks()};
    notice.yaml = "another: true\n";
    publish(bus::kScenario.name, notice);
  }
  for (models::MocapFrame& frame : std::exchange(vicon_.frames, {})) {
    frame.stamp.time += room().mocap_clock;
    frame.arrival += room().mocap_clock;
    mocap_bus_.publish(bus::kVicon, frame);
  }
  for (Duration step{}; step < from_seconds(kTickS); step += kStep) {
    clock_.set(now() + step);
    for (std::size_t i = 0; i < wired_vehicles_.size(); ++i) {
      WiredVehicle& wired_vehicle = *wired_vehicles_[i];
      Vehicle& vehicle = vehicles()[i];
      change_vehicle(vehicle, wired_vehicle, to_seconds(kStep));
      wired_vehicle.emulator.advance_to(clock_.now());
      pass_telemetry(vehicle, wired_vehicle);
      if (vehicle.knobs.is_ending && !std::exchange(wired_vehicle.was_end_requested, true)) {
        wired_vehicle.node.on_stop_request(1, clock_.now());
      }
      wired_vehicle.node.on_processor_wait(vehicle.knobs.processor_wait_s);
      if (!vehicle.knobs.is_stalled) {
        wired_vehicle.bus.handle(std::chrono::microseconds(0));
        if (clock_.now() >= wired_vehicle.node.next_tick()) {
          wired_vehicle.node.tick(clock_.now());
        }
      }
      for (const auto& datagram : std::exchange(wired_vehicle.port->to_vehicle, {})) {
        if (!vehicle.knobs.link_cut) {
          wired_vehicle.emulator.receive(datagram, clock_.now());
        }
      }
      read_truth(vehicle, wired_vehicle);
    }
    lab_.handle(std::chrono::microseconds(0));
    vicon_.pass(kStep);
  }
}

}  // namespace vantage::test
