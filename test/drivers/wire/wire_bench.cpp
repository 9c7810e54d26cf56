#include "test/drivers/wire/wire_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
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

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kStep{5'000};  // of the emulated autopilots and the nodes
constexpr double kFloorM = 0.05;  // height of the markers of a vehicle that stands
constexpr double kRunawayLagS = 0.15;
constexpr double kTiltFaultRad = 0.5;  // smaller ones are what a vehicle does anyway
constexpr std::uint8_t kArmedFlag = 0x80;
constexpr std::int8_t kFrozenPercent = 85;
constexpr std::uint32_t kPx4Position = 3U << 16U;
constexpr std::uint32_t kArducopterLoiter = 5;

bool is_battery(std::uint32_t message_id) {
  return message_id == mavlink::BatteryStatus::kMessage.id ||
         message_id == mavlink::SysStatus::kMessage.id;
}

/// Replaces the payload of `frame` by what `change` makes of it, if it is a `Message`.
template <class Message, class Change>
void alter(mavlink::Frame& frame, const Change& change) {
  if (auto message = mavlink::unpack<Message>(frame)) {
    change(*message);
    frame = mavlink::pack(*message, frame.origin);
  }
}

/// What the vehicle's fault makes of one message of its autopilot; false: it does not arrive.
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
  if (knobs.says_disarmed) {
    alter<mavlink::Heartbeat>(frame, [](auto& message) {
      message.base_mode = static_cast<std::uint8_t>(message.base_mode & ~kArmedFlag);
    });
  }
  if (knobs.estimator_bad) {
    alter<mavlink::EstimatorStatus>(frame, [](auto& message) { message.flags = 0; });
    alter<mavlink::EkfStatusReport>(frame, [](auto& message) { message.flags = 0; });
  }
  alter<mavlink::LocalPositionNed>(
      frame, [&](auto& message) { message.x += mavlink::f32(knobs.estimate_offset_m); });
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

scenario::Scenario WireBench::wire_scenario() {
  scenario::Scenario out = FlightBench::scenario();
  out.mocap = spec_of(scenario::MocapProtocol::kDataStream);
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    const auto dialect = i == 1 ? AutopilotDialect::kArdupilot : AutopilotDialect::kPx4;
    out.robots[i].autopilot = scenario::AutopilotSpec{dialect, "udp://127.0.0.1:1", 1, ""};
  }
  return out;
}

WireBench::Seat::Seat(WireBench& bench, const scenario::RobotSpec& robot, std::uint64_t seed,
                      Time start)
    : side(bench.hub_.connect()),
      bus(*side, 100 + static_cast<std::int64_t>(seed)),
      port(new WirePort),
      node(bus, bench.clock_, bench.flown(), robot.name, std::unique_ptr<drivers::Port>(port)),
      emulator(
          [&] {
            sim::AutopilotEmulatorSpec spec;
            spec.dialect = robot.autopilot->dialect;
            spec.start = lift(robot.start, kFloorM);
            spec.seed = seed;
            return spec;
          }(),
          start) {}

WireBench::WireBench(std::uint64_t seed)
    : FlightBench(seed, wire_scenario(), kWireLeadS),
      clock_(now()),
      vicon_(flown().mocap, ViconBench::settings_for(flown().mocap)) {
  vicon_.elapsed = now() - kStart;
  for (std::size_t i = 0; i < flown().robots.size(); ++i) {
    seats_.push_back(std::make_unique<Seat>(*this, flown().robots[i], seed + i, now()));
  }
  lab_.subscribe<models::VehicleStatus>(
      bus::vehicle_channel("*"),
      [this](const models::VehicleStatus& status) { on_status(status); });
}

WireBench::Seat& WireBench::seat(const std::string& robot) {
  return *seats_[static_cast<std::size_t>(&vehicle(robot) - vehicles().data())];
}

sim::AutopilotEmulator& WireBench::emulator(const std::string& robot) {
  return seat(robot).emulator;
}

const std::vector<std::string>& WireBench::reasons_of(const std::string& robot) {
  return seat(robot).reasons;
}

void WireBench::on_status(const models::VehicleStatus& status) {
  Vehicle& of = vehicle(status.robot);
  of.out.state = status.state;
  seat(status.robot).reasons = status.reasons;
  const auto rows = drivers::conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    of.out.reasons[i] = std::find(status.reasons.begin(), status.reasons.end(), rows[i].name) !=
                        status.reasons.end();
  }
}

std::int64_t WireBench::count_of(const Vehicle& vehicle, const std::string& counter) const {
  const auto index = static_cast<std::size_t>(
      std::find_if(flown().robots.begin(), flown().robots.end(),
                   [&](const auto& robot) { return robot.name == vehicle.name; }) -
      flown().robots.begin());
  for (const models::NamedCount& each : seats_[index]->node.counters()) {
    if (each.name == counter) {
      return each.count;
    }
  }
  return -1;
}

// Arms each vehicle once it has no reason not to, then lets all take off, then follow.
void WireBench::fly_up(double until_s) {
  bool is_taking_off = false;
  while (time_s() < until_s) {
    const bool all_armed = std::all_of(seats_.begin(), seats_.end(), [](const auto& each) {
      return each->emulator.controller().is_armed();
    });
    if (!is_taking_off && all_armed && ticks() % 200 == 90) {
      say(OperatorAction::kTakeOff);
      is_taking_off = true;
    } else if (!all_armed && time_s() < 0.0 && ticks() % 200 == 80) {
      say(OperatorAction::kArm);
    } else if (std::abs(time_s() - 3.5) < 0.5 * kTickS) {
      say(OperatorAction::kFollow);
    }
    tick();
  }
}

template <class Message>
void WireBench::publish(const std::string& channel, const Message& message) {
  const auto wire = bus::to_wire(message);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, wire.getEncodedSize());
  stranger_->publish(channel, bytes);
}

void WireBench::deliver(const models::MocapFrame& frame) {
  sim::vicon::EmulatedFrame sent;
  sent.number = static_cast<std::uint32_t>(frame.frame_number + 1);
  sent.captured = frame.stamp.time;
  sent.latency_s = 0.004;
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

void WireBench::change_vehicle(Vehicle& vehicle, Seat& seat, double dt_s) {
  const VehicleKnobs& knobs = vehicle.knobs;
  sim::FlightController& controller = seat.emulator.controller();
  if (!controller.airframe().is_on_ground()) {
    controller.airframe().push(
        dt_s * turn_axes(Eigen::Vector3d(knobs.push_mps2 + knobs.runaway_mps / kRunawayLagS)));
  }
  if (knobs.battery_share) {
    controller.airframe().set_battery_share(*knobs.battery_share);
  }
  if (knobs.motors_off) {
    controller.disarm(true);
  }
  if (knobs.mode_left && !std::exchange(seat.was_mode_left, true)) {
    controller.set_mode(vehicle.name == "Q2" ? kArducopterLoiter : kPx4Position, clock_.now());
  }
}

void WireBench::pass_telemetry(const Vehicle& vehicle, Seat& seat) {
  for (const auto& datagram : seat.emulator.take_output()) {
    if (vehicle.knobs.link_cut) {
      continue;
    }
    mavlink::Parser parser;
    std::vector<std::uint8_t> passed;
    const auto pass = [&](mavlink::Frame frame) {
      if (passes(vehicle.knobs, frame)) {
        mavlink::append_bytes(frame, passed);
      }
    };
    parser.feed(datagram, pass);
    if (!passed.empty()) {
      seat.port->to_driver.push_back(std::move(passed));
    }
  }
}

void WireBench::read_truth(Vehicle& vehicle, Seat& seat) {
  const Pose3 pose = seat.emulator.world_from_body();
  vehicle.position_m = pose.translation_m;
  vehicle.velocity_mps = seat.emulator.velocity_world_mps();
  vehicle.yaw_rad = flatten(pose).yaw_rad;
  vehicle.is_armed = seat.emulator.controller().is_armed();
  vehicle.battery_share = seat.emulator.controller().airframe().battery_share();
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
    mocap_bus_.publish(bus::kVicon, frame);
  }
  for (Duration step{}; step < from_seconds(kTickS); step += kStep) {
    clock_.set(now() + step);
    for (std::size_t i = 0; i < seats_.size(); ++i) {
      Seat& seat = *seats_[i];
      Vehicle& vehicle = vehicles()[i];
      change_vehicle(vehicle, seat, to_seconds(kStep));
      seat.emulator.advance_to(clock_.now());
      pass_telemetry(vehicle, seat);
      if (!vehicle.knobs.is_stalled) {
        seat.bus.handle(std::chrono::microseconds(0));
        if (clock_.now() >= seat.node.next_tick()) {
          seat.node.tick(clock_.now());
        }
      }
      for (const auto& datagram : std::exchange(seat.port->to_vehicle, {})) {
        if (!vehicle.knobs.link_cut) {
          seat.emulator.receive(datagram, clock_.now());
        }
      }
      read_truth(vehicle, seat);
    }
    lab_.handle(std::chrono::microseconds(0));
    vicon_.pass(kStep);
  }
}

}  // namespace vantage::test
