#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/angle.hpp"
#include "drivers/safety/guard.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {

/// The flight safety of Q1 alone, heard and seen as the test says: its body goes where it is asked
/// to be, slowly, or stays where it is put. Nothing is wrong unless it is set so.
class HandFlown {
 public:
  static constexpr double kTickS = 0.01;

  explicit HandFlown(const Eigen::Vector3d& place_m = {-2.0, -1.3, 0.0},
                     const std::optional<drivers::SafetyLimits>& given = {})
      : limits(given.value_or(drivers::limits_for(FlightBench::scenario(), "Q1"))),
        guard(FlightBench::scenario(), "Q1", limits),
        body_m(place_m),
        before_m_(place_m) {}

  /// Found in the air: holds, and every note of its beginning is over.
  HandFlown& hover() {
    is_armed = true;
    run(0.6);
    return *this;
  }
  /// Told to follow, and given a plan that begins a moment later; until it does.
  HandFlown& follow(const models::RobotPlan& plan) {
    (void)say(models::OperatorAction::kFollow);
    tick();
    (void)guard.on_plan(plan, now());
    run(to_seconds(plan.trajectory.start_time - now()) + kTickS);
    return *this;
  }
  /// Straight on at `speed_mps` for 3 s, from where it is, 0.1 s from now.
  [[nodiscard]] models::RobotPlan plan(double speed_mps) {
    models::RobotPlan made;
    made.robot = "Q1";
    made.round = 41;
    made.stamp = {now() + from_seconds(0.1), 100, plans_++};
    made.trajectory.start_time = made.stamp.time;
    made.trajectory.start = {body_m.x(), body_m.y(), yaw_rad};
    made.trajectory.height_m = body_m.z();
    made.trajectory.segments = {{{speed_mps, 0.0}, 3.0, 0.0},
                                models::brake(speed_mps, limits.vehicle.brake_mps2).front()};
    return made;
  }

  [[nodiscard]] Time now() const { return now_; }
  void pass(double seconds) { now_ += from_seconds(seconds); }
  /// The operator says it now, and is heard.
  drivers::CommandVerdict say(models::OperatorAction action, const std::string& whom = "",
                              std::int64_t station = 7) {
    models::OperatorCommand command;
    command.stamp = {now_, station, sequence_++};
    command.action = action;
    command.robot = whom;
    return guard.on_command(command, now_);
  }
  /// Mocap shows it now. Never the same bits twice, unless it is frozen.
  void see() {
    models::MocapFrame frame;
    frame.stamp = {now_, 3, number_};
    frame.arrival = now_;
    frame.frame_number = number_++;
    const double twitch_m = is_frozen ? 0.0 : 1e-9 * static_cast<double>(number_ % 2);
    const Eigen::Vector3d shown_m = body_m + Eigen::Vector3d(0.0, 0.0, twitch_m);
    const Quaternion turned(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    frame.bodies.push_back({"Q1", {shown_m, turned}, false});
    if (walker_m) {
      frame.bodies.push_back({"W1", {*walker_m, Quaternion::Identity()}, false});
    }
    (void)guard.on_mocap(frame, now_);
  }
  void hear(double passed_s) {
    drivers::AutopilotReport report;
    report.armed = is_armed;
    report.estimator_good = report.has_position = report.has_attitude = true;
    report.is_in_our_mode = true;
    report.position_world_m = body_m;
    report.velocity_world_mps = (body_m - before_m_) / passed_s;
    report.world_from_body = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
    report.yaw_rate_radps = (yaw_rad - before_rad_) / passed_s;
    guard.on_autopilot(report, now_);
    guard.on_heartbeat(now_);
    guard.on_battery(battery_share, now_);
    before_m_ = body_m;
    before_rad_ = yaw_rad;
    (void)say(models::OperatorAction::kHeartbeat);
  }
  const drivers::GuardOutput& tick(double passed_s = kTickS) {
    pass(passed_s);
    if (obeys && out.setpoint.kind == drivers::FlightSetpoint::Kind::kTrack) {
      const models::VehicleStatus asked = guard.status(now_);
      Eigen::Vector3d way_m(asked.setpoint.x_m, asked.setpoint.y_m, asked.setpoint_height_m);
      way_m -= body_m;
      body_m += way_m * std::min(1.0, kFastestMps * passed_s / std::max(1e-9, way_m.norm()));
      const double turn_rad = wrap_to_pi(asked.setpoint.yaw_rad - yaw_rad);
      yaw_rad += std::clamp(turn_rad, -kTurnRadps * passed_s, kTurnRadps * passed_s);
    }
    if (is_seen) {
      see();
    }
    hear(passed_s);
    out = guard.tick(now_);
    return out;
  }
  const drivers::GuardOutput& run(double seconds) {
    for (const Time end = now_ + from_seconds(seconds - 0.5 * kTickS); now_ < end;) {
      tick();
    }
    return out;
  }
  [[nodiscard]] std::vector<std::string> reasons() const { return guard.status(now_).reasons; }
  [[nodiscard]] bool has(const std::string& reason) const {
    const auto all = reasons();
    return std::find(all.begin(), all.end(), reason) != all.end();
  }
  [[nodiscard]] std::int64_t count(const std::string& name) const {
    for (const models::NamedCount& each : guard.counters()) {
      if (each.name == name) {
        return each.count;
      }
    }
    return -1;
  }

  drivers::SafetyLimits limits;
  drivers::FlightGuard guard;
  drivers::GuardOutput out;
  Eigen::Vector3d body_m;
  double yaw_rad = 0.0;
  double battery_share = 0.9;
  bool is_armed = false;
  bool obeys = true;  ///< its body goes where it is asked to be
  bool is_seen = true;
  bool is_frozen = false;                   ///< in what is seen of it
  std::optional<Eigen::Vector3d> walker_m;  ///< somebody else whom mocap shows

 private:
  static constexpr double kFastestMps = 1.0;
  static constexpr double kTurnRadps = 0.5;

  Time now_ = from_utime(1'700'000'000'000'000);
  Eigen::Vector3d before_m_;
  double before_rad_ = 0.0;
  std::int64_t number_ = 0;
  std::int64_t sequence_ = 0;
  std::int64_t plans_ = 0;
};

}  // namespace vantage::test
