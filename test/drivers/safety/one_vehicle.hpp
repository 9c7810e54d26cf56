#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/safety/guard.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::test {

/// One guard, ticked at 50 Hz. The test sets all its inputs exactly. (FlightBench simulates a room
/// with noise.) With `tracks_setpoint` the body is exactly at its set-point, unless its speed is
/// limited.
struct OneVehicle {
  static constexpr double kTickS = 0.02;

  static scenario::Scenario room() {
    scenario::Scenario out;
    out.world.bounds = {{-5.0, -5.0}, {5.0, 5.0}};
    out.world.ceiling_m = 9.0;
    for (const char* name : {"Q1", "Q2"}) {
      scenario::RobotSpec robot;
      robot.name = name;
      robot.height_m = 1.0;
      robot.limits = {1.0, 3.0, 2.0, 0.25};
      out.robots.push_back(robot);
    }
    for (const char* name : {"W1", "W2"}) {
      out.targets.emplace_back().name = name;
    }
    return out;
  }

  explicit OneVehicle(const Eigen::Vector3d& at_m = {0.0, 0.0, 1.5}, double turned_rad = 0.0,
                      const scenario::Scenario& in = room(), const std::string& name = "Q1")
      : OneVehicle(at_m, turned_rad, in, name, drivers::limits_for(in, name)) {}
  OneVehicle(const Eigen::Vector3d& at_m, double turned_rad, const scenario::Scenario& in,
             const std::string& name, const drivers::SafetyLimits& with)
      : limits(with), guard(in, name, with), own(name), position_m(at_m), yaw_rad(turned_rad) {
    report.armed = report.is_in_our_mode = true;
    report.estimator_good = report.has_position = report.has_attitude = true;
  }

  /// Places the vehicle on the ground with its motors off.
  void place_on_ground() {
    report.armed = report.is_in_our_mode = false;
    position_m.z() = 0.0;
  }

  void send_command(models::OperatorAction action) {
    (void)send_command_to(action == models::OperatorAction::kHeartbeat ? "" : own, action);
  }
  /// Sends a command from the given station to one vehicle ("": all vehicles).
  drivers::CommandVerdict send_command_to(const std::string& whom, models::OperatorAction action,
                                          std::int64_t station = 7) {
    models::OperatorCommand command;
    command.stamp = {now, station, ++said};
    command.action = action;
    command.robot = whom;
    return guard.on_command(command, now);
  }

  /// Delivers a mocap frame of the current state.
  void deliver_mocap() {
    models::MocapFrame frame;
    frame.stamp = {now, 3, ++frames};
    frame.arrival = now;
    frame.frame_number = frames;
    frame.bodies = others;
    if (is_seen) {
      models::MocapBody& body = frame.bodies.emplace_back();
      body.name = own;
      // A real measurement never repeats bit for bit, so every second pose is shifted by 1 nm.
      const double twitch_m = frames % 2 == 0 && !is_frozen ? 1e-9 : 0.0;
      body.world_from_body =
          lift({position_m.x(), position_m.y(), yaw_rad}, position_m.z() + twitch_m);
    }
    if (has_mocap) {
      (void)guard.on_mocap(frame, now);
    }
  }
  /// Delivers all other inputs: heartbeats, autopilot report, battery.
  void deliver_inputs() {
    if (is_commanded && ticks % 10 == 0) {
      send_command(models::OperatorAction::kHeartbeat);
    }
    if (sends_heartbeats) {
      guard.on_heartbeat(now);
    }
    if (sends_telemetry) {
      report.position_world_m = estimate_m.value_or(position_m);
      report.velocity_world_mps = velocity_mps;
      report.velocity_world_mps.z() += climb_rate_error_mps;
      report.world_from_body = lift({0.0, 0.0, yaw_rad}, 0.0).rotation;
      guard.on_autopilot(report, now);
    }
    if (battery_share) {
      guard.on_battery(*battery_share, now);
    }
  }

  void tick() {
    now += from_seconds(kTickS);
    const Eigen::Vector3d from_m = position_m;
    const double from_rad = yaw_rad;
    move();
    velocity_mps = (position_m - from_m) / kTickS;
    report.yaw_rate_radps = wrap_to_pi(yaw_rad - from_rad) / kTickS + yaw_rate_error_radps;
    deliver_mocap();
    deliver_inputs();
    out = guard.tick(now);
    ++ticks;
  }
  void run(
      double seconds, const std::function<void()>& each = [] {}) {
    for (long i = std::lround(seconds / kTickS); i > 0; --i) {
      tick();
      each();
    }
  }

  /// Moves the body to its current set-point.
  void move() {
    const Eigen::Vector3d from_m = position_m;
    const double from_rad = yaw_rad;
    if (drift_mps) {
      position_m += kTickS * *drift_mps;
    } else if (tracks_setpoint && out.setpoint.kind == drivers::FlightSetpoint::Kind::kTrack) {
      position_m = out.setpoint.position_world_m +
                   (kTickS - limits.setpoint_lead_s) * out.setpoint.velocity_world_mps;
      position_m += setpoint_offset_m;
      position_m.z() = std::max(0.0, position_m.z());
      yaw_rad = wrap_to_pi(out.setpoint.yaw_rad +
                           (kTickS - limits.setpoint_lead_s) * out.setpoint.yaw_rate_radps);
      const Eigen::Vector3d offset_m = position_m - from_m;
      if (offset_m.norm() > kTickS * fastest_mps) {
        position_m = from_m + kTickS * fastest_mps * offset_m.normalized();
      }
      const double turn_rad = wrap_to_pi(yaw_rad - from_rad);
      if (std::abs(turn_rad) > kTickS * fastest_radps) {
        yaw_rad = wrap_to_pi(from_rad + std::copysign(kTickS * fastest_radps, turn_rad));
      }
    }
    yaw_rad = wrap_to_pi(yaw_rad + kTickS * turns_radps);
    if (!rises) {
      position_m.z() = from_m.z() + std::clamp(held_m - from_m.z(), -0.02, 0.02);
    }
  }
  void hold_at_height(double height_m) {
    rises = false;
    held_m = height_m;
  }

  models::MocapBody body(const std::string& name, const Eigen::Vector3d& at_m) const {
    models::MocapBody out_body;
    out_body.name = name;
    out_body.world_from_body.translation_m = at_m;
    out_body.world_from_body.translation_m.z() += ticks % 2 == 0 ? 1e-9 : 0.0;
    return out_body;
  }

  /// Returns a plan from the current pose: `speed_mps` for `seconds`, then a stop.
  models::RobotPlan plan(double speed_mps, double turn_radps, double seconds, double height_m,
                         double start_in_s = 0.0) {
    models::RobotPlan made;
    made.robot = own;
    made.stamp = {now, 100, ++plans};
    made.trajectory.start_time = now + from_seconds(start_in_s);
    made.trajectory.start = {position_m.x(), position_m.y(), yaw_rad};
    made.trajectory.height_m = height_m;
    made.trajectory.segments = {{{speed_mps, turn_radps}, seconds, 0.0},
                                {{speed_mps, 0.0}, speed_mps / 2.0, 2.0}};
    return made;
  }
  /// Delivers a plan as returned by plan() to the guard.
  drivers::PlanVerdict follow(double speed_mps, double turn_radps, double seconds, double height_m,
                              double start_in_s = 0.0) {
    return guard.on_plan(plan(speed_mps, turn_radps, seconds, height_m, start_in_s), now);
  }
  /// Puts the vehicle in the air, visible to mocap, at the given position and commands it to land.
  void begin_landing_at(const Eigen::Vector3d& from_m) {
    position_m = from_m;
    report.armed = true;
    run(0.4);
    send_command(models::OperatorAction::kLand);
    tick();
    EXPECT_EQ(out.state, models::FlightState::kLand);
  }
  /// Moves the body to the ground regardless of the commands, and stops its motors.
  void finish_landing() {
    others.clear();
    drift_mps = Eigen::Vector3d(0.0, 0.0, -1.0);
    run(position_m.z());
    drift_mps = Eigen::Vector3d::Zero();
    position_m.z() = 0.0;
    report.armed = false;
    run(1.0);
    drift_mps.reset();
    EXPECT_EQ(out.state, models::FlightState::kIdle);
  }
  /// Arms the vehicle on the ground by a command.
  void arm() {
    place_on_ground();
    run(1.5);
    send_command(models::OperatorAction::kArm);
    for (int i = 0; i < 100 && !out.wants_armed; ++i) {
      tick();
    }
    report.armed = report.is_in_our_mode = true;
    run(0.4);
  }
  /// Arms, commands the take-off and runs until the first lift begins.
  void begin_lift() {
    arm();
    send_command(models::OperatorAction::kTakeOff);
    for (int i = 0; i < 100 && out.state == models::FlightState::kIdle; ++i) {
      tick();
    }
  }
  [[nodiscard]] std::vector<std::string> reasons() const { return guard.status(now).reasons; }
  [[nodiscard]] bool has_reason(const std::string& reason) const {
    const std::vector<std::string> all = reasons();
    return std::find(all.begin(), all.end(), reason) != all.end();
  }
  /// Returns the value of the counter with this name, −1 if there is none.
  [[nodiscard]] std::int64_t count(const std::string& name) const {
    for (const models::NamedCount& each : guard.counters()) {
      if (each.name == name) {
        return each.count;
      }
    }
    return -1;
  }
  [[nodiscard]] bool lifts() const { return has_reason("first lift"); }

  /// Shows the vehicle in flight and commands it to follow; afterwards it waits for plans.
  void hover_without_plan() {
    run(0.1);
    send_command(models::OperatorAction::kFollow);
    run(0.1);
  }

  const drivers::SafetyInputs& in() const { return guard.inputs(); }
  models::FlightState state() const { return out.state; }
  Eigen::Vector2d setpoint_m() const { return out.setpoint.position_world_m.head<2>(); }

  drivers::SafetyLimits limits;
  drivers::FlightGuard guard;
  std::string own;
  Time now = from_utime(1'700'000'000'000'000);
  std::int64_t ticks = 0, said = 0, frames = 0, plans = 0;

  // State of the body.
  Eigen::Vector3d position_m;
  double yaw_rad;
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  bool tracks_setpoint = true;
  /// m/s and rad/s; limits of the speed towards the set-point.
  double fastest_mps = drivers::kNever, fastest_radps = drivers::kNever;
  Eigen::Vector3d setpoint_offset_m =
      Eigen::Vector3d::Zero();               ///< m; offset of the body from its set-point
  std::optional<Eigen::Vector3d> drift_mps;  ///< m/s; if set, velocity of the body
  double turns_radps = 0.0;
  bool rises = true;
  double held_m = 0.0;
  std::vector<models::MocapBody> others;

  // Selects the inputs that arrive.
  bool is_seen = true, has_mocap = true, is_commanded = true, sends_heartbeats = true,
       sends_telemetry = true;
  bool is_frozen = false;  ///< mocap repeats the same pose bit for bit
  drivers::AutopilotReport report;
  std::optional<Eigen::Vector3d> estimate_m;  ///< m; autopilot's estimate if not exact
  double climb_rate_error_mps = 0.0, yaw_rate_error_radps = 0.0;  ///< errors of `report`
  std::optional<double> battery_share = 0.9;
  drivers::GuardOutput out;
};

}  // namespace vantage::test
