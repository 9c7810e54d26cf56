#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/quadrotor/driver.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "test/drivers/vehicle/stepped_bench.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::test {

/// A closed loop in virtual time: driver, emulated autopilot, mocap at 100 Hz, operator and
/// planner. Q1 starts on the floor at (2, 2) with its heading along y.
class FlightBench : public SteppedBench {
 public:
  static constexpr Duration kTick{5'000};
  static constexpr Duration kLatency{5'000};
  static constexpr double kFloorM = 0.05;  ///< m; height of its markers on the floor

  static scenario::Scenario scenario_for(models::AutopilotDialect dialect) {
    scenario::Scenario scenario = lab_scenario();
    scenario.world.obstacles.clear();
    scenario.robots.resize(1);
    scenario.robots[0].start = {2.0, 2.0, kPi / 2};
    scenario.robots[0].autopilot = scenario::AutopilotSpec{dialect, "udp://127.0.0.1:1", 1, ""};
    return scenario;
  }
  static sim::AutopilotEmulatorSpec vehicle_for(models::AutopilotDialect dialect) {
    sim::AutopilotEmulatorSpec spec;
    spec.dialect = dialect;
    spec.start = lift({2.0, 2.0, kPi / 2}, kFloorM);
    return spec;
  }

  explicit FlightBench(models::AutopilotDialect dialect)
      : FlightBench(dialect, vehicle_for(dialect)) {}
  FlightBench(models::AutopilotDialect dialect, const sim::AutopilotEmulatorSpec& vehicle_spec)
      : scenario(scenario_for(dialect)), vehicle(vehicle_spec, kStart) {
    restart_driver();
  }

  void restart_driver() {
    driver = std::make_unique<drivers::QuadrotorDriver>(scenario, "Q1",
                                                        drivers::limits_for(scenario, "Q1"));
  }

  void command(models::OperatorAction action) { driver->on_command(order(action), now); }
  models::OperatorCommand order(models::OperatorAction action) { return next_command(action); }
  /// Returns a new message that repeats `earlier`, with the same time.
  models::OperatorCommand repeated(const models::OperatorCommand& earlier) {
    models::OperatorCommand out = next_command(earlier.action);
    out.stamp.time = earlier.stamp.time;
    return out;
  }

  /// Returns a plan that begins at `start`, `delay` from now.
  models::RobotPlan plan(const Pose2& start, const std::vector<models::PlanSegment>& segments,
                         Duration delay) {
    return next_plan("Q1", now + delay, start, scenario.robots[0].height_m, segments);
  }

  /// Arms, takes off and hovers; returns false if that fails.
  bool take_off() {
    if (!run_until([this] { return now > kStart + from_seconds(1.0) && reasons().empty(); },
                   20.0)) {
      return false;
    }
    command(models::OperatorAction::kArm);
    if (!run_until([this] { return vehicle.controller().is_armed(); }, 60.0)) {
      return false;
    }
    // The vehicle's heartbeat reports the armed state up to a second later.
    run(1.5);
    command(models::OperatorAction::kTakeOff);
    return run_until([this] { return height_error_m() < 0.1; }, 15.0);
  }

  /// Follows a straight plan from the hover until the vehicle has flown at `speed_mps` for 0.4 s;
  /// returns false if that fails.
  bool follow_straight(double speed_mps) {
    command(models::OperatorAction::kFollow);
    run(0.1);
    std::vector<models::PlanSegment> segments{{{speed_mps, 0.0}, 2.5, 0.0}};
    for (const models::PlanSegment& stop :
         models::brake(speed_mps, scenario.robots[0].limits.brake_mps2)) {
      segments.push_back(stop);
    }
    driver->on_plan(
        plan(flatten(vehicle.world_from_body()), segments, std::chrono::milliseconds(500)), now);
    const bool is_under_way = run_until([&] { return this->speed_mps() > 0.9 * speed_mps; }, 2.0);
    run(0.4);
    return is_under_way && state() == models::FlightState::kFollow;
  }

  models::VehicleStatus status() const { return driver->status(now); }
  models::FlightState state() const { return status().state; }
  bool has_reason(const std::string& part) const {
    const auto reasons = status().reasons;
    return std::any_of(reasons.begin(), reasons.end(), [&](const std::string& reason) {
      return reason.find(part) != std::string::npos;
    });
  }
  std::string reasons() const {
    std::string out;
    for (const std::string& reason : status().reasons) {
      out += reason + "; ";
    }
    return out;
  }
  double height_error_m() const {
    return std::abs(vehicle.world_from_body().translation_m.z() - scenario.robots[0].height_m);
  }
  bool is_armed() const { return vehicle.controller().is_armed(); }
  /// Returns the horizontal position of the body, m.
  Eigen::Vector2d place_m() const { return vehicle.world_from_body().translation_m.head<2>(); }
  double speed_mps() const { return vehicle.velocity_world_mps().head<2>().norm(); }

  scenario::Scenario scenario;
  std::unique_ptr<drivers::QuadrotorDriver> driver;
  sim::AutopilotEmulator vehicle;
  bool has_mocap = true;
  bool has_operator = true;
  bool is_wire_cut = false;
  bool driver_receives_nothing = false;  ///< only the link from vehicle to driver fails
  using Loses = std::function<bool(const std::vector<std::uint8_t>& datagram)>;
  Loses loses_received;  ///< selects datagrams from the vehicle that are lost
  Loses loses_sent;      ///< selects datagrams from the driver that are lost
  std::function<void(models::MocapFrame&)> alter_frame;  ///< changes mocap frames
  /// Receives each captured frame instead of the driver; empty: the bench delivers it.
  std::function<void(const models::MocapFrame&)> on_capture;
  std::optional<Eigen::Vector3d> walker_m;  ///< m; position of the first target as shown by mocap
  std::function<void(Time)> on_step;
  std::vector<std::vector<std::uint8_t>> sent;  ///< datagrams sent by the driver in the last step

 private:
  void step() final {
    now += kTick;
    ++ticks_;
    vehicle.advance_to(now);
    for (const auto& datagram : vehicle.take_output()) {
      if (!is_wire_cut && !driver_receives_nothing &&
          !(loses_received && loses_received(datagram))) {
        driver->receive(datagram, true, now);
      }
    }
    if (ticks_ % 2 == 0) {
      deliver_mocap();
      capture_mocap();
    }
    if (has_operator && ticks_ % 40 == 0) {
      command(models::OperatorAction::kHeartbeat);
    }
    driver->tick(now);
    sent = driver->take_output();
    for (const auto& datagram : sent) {
      if (!is_wire_cut && !(loses_sent && loses_sent(datagram))) {
        vehicle.receive(datagram, now);
      }
    }
    if (on_step) {
      on_step(now);
    }
  }
  void capture_mocap() {
    models::MocapFrame frame;
    frame.stamp = {now, 33, frame_sequence_++};
    frame.frame_number = frame_sequence_;
    models::MocapBody body;
    body.name = "Q1";
    body.world_from_body = vehicle.world_from_body();
    // Noise of 0.1 mm ensures that consecutive poses differ.
    body.world_from_body.translation_m.x() += 1e-4 * std::sin(static_cast<double>(ticks_));
    frame.bodies.push_back(body);
    if (walker_m) {
      body.name = scenario.targets.front().name;
      body.world_from_body = {};
      body.world_from_body.translation_m = *walker_m;
      frame.bodies.push_back(body);
    }
    if (alter_frame) {
      alter_frame(frame);
    }
    if (on_capture) {
      on_capture(frame);
    } else {
      waiting_.push_back(frame);
    }
  }
  /// Delivers the frames captured one frame time ago.
  void deliver_mocap() {
    for (models::MocapFrame& frame : waiting_) {
      frame.arrival = frame.stamp.time + kLatency;  // on the clock that stamps the frame
      if (has_mocap) {
        driver->on_mocap(frame, now);
      }
    }
    waiting_.clear();
  }

  std::int64_t ticks_ = 0;
  std::int64_t frame_sequence_ = 0;
  std::vector<models::MocapFrame> waiting_;
};

}  // namespace vantage::test
