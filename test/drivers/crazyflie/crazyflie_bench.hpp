#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/crazyflie/driver.hpp"
#include "sim/crazyflie/crazyflie_emulator.hpp"
#include "test/drivers/vehicle/stepped_bench.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::test {

/// Cache of tables in memory.
class MemoryTables : public drivers::TableCache {
 public:
  std::optional<std::vector<wire::crtp::TocItem>> find(wire::crtp::Port port,
                                                       const wire::crtp::TocInfo& info) override {
    const auto found = tables.find({static_cast<int>(port), info.crc});
    return found == tables.end() ? std::nullopt : std::optional(found->second);
  }
  void store(wire::crtp::Port port, const wire::crtp::TocInfo& info,
             const std::vector<wire::crtp::TocItem>& items) override {
    tables[{static_cast<int>(port), info.crc}] = items;
    ++stored;
  }
  std::map<std::pair<int, std::uint32_t>, std::vector<wire::crtp::TocItem>> tables;
  int stored = 0;
};

/// A closed loop in virtual time: driver, emulated Crazyflie, mocap at 50 Hz, operator and planner.
/// Q1 starts on the floor at (2, 2) with its heading along y.
class CrazyflieBench : public SteppedBench {
 public:
  static constexpr Duration kTick{5'000};

  static scenario::Scenario scenario_for() {
    scenario::Scenario scenario = lab_scenario();
    scenario.world.obstacles.clear();
    scenario.robots.resize(1);
    scenario.robots[0].start = {2.0, 2.0, kPi / 2};
    scenario.robots[0].limits.radius_m = 0.1;
    scenario.robots[0].crazyflie.emplace().url = "udp://127.0.0.1:1";
    return scenario;
  }
  static sim::CrazyflieEmulatorSpec vehicle_for(bool arms_itself) {
    sim::CrazyflieEmulatorSpec out;
    out.start = {2.0, 2.0, kPi / 2};
    out.arms_itself = arms_itself;
    return out;
  }

  explicit CrazyflieBench(bool arms_itself = true) {
    restart_vehicle(arms_itself);
    restart_driver();
  }

  void restart_vehicle(bool arms_itself = true) {
    vehicle = std::make_unique<sim::CrazyflieEmulator>(vehicle_for(arms_itself), now);
  }
  void restart_driver() {
    driver = std::make_unique<drivers::CrazyflieDriver>(
        scenario, "Q1", drivers::limits_for(scenario, "Q1"), tables);
  }

  void command(models::OperatorAction action) { driver->on_command(next_command(action), now); }

  /// Arms, takes off and hovers; returns false if that fails.
  bool take_off() {
    return ready() && arm() && (command(models::OperatorAction::kTakeOff), hovers());
  }
  bool ready() {
    return run_until([this] { return now > kStart + from_seconds(2.0) && reasons().empty(); },
                     20.0);
  }
  bool arm() {
    command(models::OperatorAction::kArm);
    return run_until([this] { return driver->inputs().autopilot_armed; }, 5.0);
  }
  bool hovers() {
    return run_until([this] { return std::abs(height_m() - scenario.robots[0].height_m) < 0.1; },
                     20.0);
  }
  /// Follows a straight plan from the hover; returns false if the vehicle does not start.
  bool follow_straight(double speed_mps, double seconds = 2.5) {
    command(models::OperatorAction::kFollow);
    run(0.1);
    std::vector<models::PlanSegment> segments{{{speed_mps, 0.0}, seconds, 0.0}};
    for (const models::PlanSegment& stop :
         models::brake(speed_mps, scenario.robots[0].limits.brake_mps2)) {
      segments.push_back(stop);
    }
    driver->on_plan(next_plan("Q1", now + from_seconds(0.5), flatten(vehicle->world_from_body()),
                              scenario.robots[0].height_m, segments),
                    now);
    return run_until([&] { return this->speed_mps() > 0.9 * speed_mps; }, 2.5);
  }

  models::VehicleStatus status() const { return driver->status(now); }
  models::FlightState state() const { return status().state; }
  bool has_reason(const std::string& part) const {
    return reasons().find(part) != std::string::npos;
  }
  std::string reasons() const {
    std::string out;
    for (const std::string& reason : status().reasons) {
      out += reason + "; ";
    }
    return out;
  }
  double height_m() const { return vehicle->world_from_body().translation_m.z(); }
  double speed_mps() const { return vehicle->velocity_world_mps().head<2>().norm(); }
  bool is_locked() const { return (vehicle->info() & wire::crtp::info::kLocked) != 0; }
  bool is_flying() const { return (vehicle->info() & wire::crtp::info::kFlying) != 0; }
  /// True if the vehicle's firmware runs and its motors are not locked.
  bool is_sound() const { return !vehicle->has_crashed_firmware() && !is_locked(); }

  scenario::Scenario scenario = scenario_for();
  std::shared_ptr<MemoryTables> tables = std::make_shared<MemoryTables>();
  std::unique_ptr<drivers::CrazyflieDriver> driver;
  std::unique_ptr<sim::CrazyflieEmulator> vehicle;
  bool has_mocap = true;
  bool has_operator = true;
  bool has_driver = true;       ///< false: the driver's process was killed
  bool reaches_vehicle = true;  ///< packets from the driver arrive
  bool reaches_driver = true;   ///< packets from the vehicle arrive
  std::function<bool(const wire::crtp::Packet&)> loses_sent;  ///< selects packets that are lost
  std::function<void(models::MocapFrame&)> alter_frame;
  std::vector<wire::crtp::Packet> sent;  ///< packets sent by the driver since the last clear()
  double descent_max_mps = 0.0;          ///< m/s; largest descent of the body so far

 private:
  void step() final {
    now += kTick;
    ++ticks_;
    vehicle->advance_to(now);
    descent_max_mps = std::max(descent_max_mps, -vehicle->velocity_world_mps().z());
    for (const auto& bytes : vehicle->take_output()) {
      if (has_driver && reaches_driver) {
        driver->receive(bytes, now);
      }
    }
    if (!has_driver) {
      return;
    }
    if (ticks_ % 4 == 0) {
      deliver_mocap();
    }
    if (has_operator && ticks_ % 40 == 0) {
      command(models::OperatorAction::kHeartbeat);
    }
    driver->tick(now);
    for (const wire::crtp::Encoded& packet : driver->take_output()) {
      const auto decoded = wire::crtp::decode(packet.bytes());
      sent.push_back(decoded.value());
      if (reaches_vehicle && !(loses_sent && loses_sent(*decoded))) {
        vehicle->receive(packet.bytes(), now);
      }
    }
  }
  void deliver_mocap() {
    models::MocapFrame frame;
    frame.stamp = {now, 33, frame_sequence_++};
    frame.arrival = now;
    frame.frame_number = frame_sequence_;
    models::MocapBody body;
    body.name = "Q1";
    body.world_from_body = vehicle->world_from_body();
    // Noise of 0.1 mm ensures that consecutive poses differ.
    body.world_from_body.translation_m.x() += 1e-4 * std::sin(static_cast<double>(ticks_));
    frame.bodies.push_back(body);
    if (alter_frame) {
      alter_frame(frame);
    }
    if (has_mocap) {
      driver->on_mocap(frame, now);
    }
  }

  std::int64_t ticks_ = 0;
  std::int64_t frame_sequence_ = 0;
};

}  // namespace vantage::test
