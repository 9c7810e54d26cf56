#pragma once

#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "test/drivers/quadrotor/flight_bench.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::test {

/// Argument of set_velocity(): does not change the velocity along this axis.
inline constexpr double kFreeAxis = std::numeric_limits<double>::quiet_NaN();

/// Flight bench that collects the reasons in the status of the driver.
struct ReasonBench : FlightBench {
  explicit ReasonBench(models::AutopilotDialect dialect) : FlightBench(dialect) {
    on_step = [this](Time at) {
      if (each_step) {
        each_step(at);
      }
      for (const std::string& reason : status().reasons) {
        reasons_seen.insert(reason);
      }
    };
  }

  std::set<std::string> reasons_seen;
  std::function<void(Time)> each_step;

  [[nodiscard]] bool is_px4() const {
    return scenario.robots[0].autopilot->dialect == models::AutopilotDialect::kPx4;
  }
  [[nodiscard]] double height_m() const {
    return vehicle.world_from_body().translation_m.z() - kFloorM;
  }
  /// Drops all messages of the emulated autopilot with one of these ids.
  void drop_messages(const std::set<std::uint32_t>& ids) {
    loses_received = [ids](const std::vector<std::uint8_t>& datagram) {
      bool found = false;
      wire::mavlink::Parser parser;
      parser.feed(datagram, [&](const wire::mavlink::Frame& frame) {
        found = found || ids.contains(frame.message_id);
      });
      return found;
    };
  }
  /// Delivers `message` to the driver, encoded as by the autopilot.
  template <class Message>
  void deliver(const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(
        wire::mavlink::pack(message, {1, wire::mavlink::kComponentAutopilot, 0}), bytes);
    driver->receive(bytes, true, now);
  }
  /// Replaces the attitude in the autopilot's messages; `yaw_off_rad` is relative to the yaw at the
  /// start.
  void report_attitude(double roll_rad, double yaw_off_rad, double yaw_rate_radps) {
    drop_messages({wire::mavlink::Attitude::kMessage.id});
    each_step = [=, this](Time) {
      wire::mavlink::Attitude out;
      out.roll = wire::mavlink::f32(roll_rad);
      out.yaw = wire::mavlink::f32(yaw_off_rad - kPi / 2);
      out.yawspeed = wire::mavlink::f32(yaw_rate_radps);
      deliver(out);
    };
  }
  /// Replaces the position and velocity in the autopilot's messages by the true values plus these
  /// offsets along x.
  void report_motion(double off_m, double off_mps) {
    drop_messages({wire::mavlink::LocalPositionNed::kMessage.id});
    each_step = [=, this](Time) {
      const Eigen::Vector3d at_m = vehicle.world_from_body().translation_m;
      const Eigen::Vector3d mps = vehicle.velocity_world_mps();
      wire::mavlink::LocalPositionNed out;
      out.x = wire::mavlink::f32(at_m.x() + off_m);
      out.y = wire::mavlink::f32(-at_m.y());
      out.z = wire::mavlink::f32(-at_m.z());
      out.vx = wire::mavlink::f32(mps.x() + off_mps);
      out.vy = wire::mavlink::f32(-mps.y());
      out.vz = wire::mavlink::f32(-mps.z());
      deliver(out);
    };
  }
  void drop_batteries() {
    drop_messages(
        {wire::mavlink::BatteryStatus::kMessage.id, wire::mavlink::SysStatus::kMessage.id});
  }
  void charge(double share) { vehicle.controller().airframe().set_battery_share(share); }
  /// Sets the vehicle's velocity in the world frame at each step; NaN does not change that axis.
  void set_velocity(double x_mps, double y_mps, double z_mps) {
    each_step = [=, this](Time) {
      const Eigen::Vector3d now_mps = vehicle.velocity_world_mps();
      const auto off = [](double wanted, double is) {
        return wanted == wanted ? wanted - is : 0.0;
      };
      vehicle.controller().airframe().push(
          {off(x_mps, now_mps.x()), -off(y_mps, now_mps.y()), -off(z_mps, now_mps.z())});
    };
  }
  void stay_down() { set_velocity(0.0, 0.0, -0.1); }
  /// Adds two more robots with bodies that are stationary and far from Q1.
  void add_robots() {
    scenario = lab_scenario();
    scenario.world.obstacles.clear();
    scenario.robots[0] = scenario_for(models::AutopilotDialect::kPx4).robots[0];
    scenario.robots[0].autopilot->dialect = vehicle_dialect();
    restart_driver();
  }
  [[nodiscard]] models::AutopilotDialect vehicle_dialect() const { return dialect_; }
  void show_other(std::function<double()> height_m) {
    alter_frame = [height_m = std::move(height_m)](models::MocapFrame& frame) {
      models::MocapBody body = frame.bodies.front();
      body.name = "Q2";
      body.world_from_body.translation_m = {1.0, 6.0, height_m()};
      frame.bodies.push_back(body);
    };
  }
  void stay_on_ground() { run(8.0); }
  void arm() {
    stay_on_ground();
    command(models::OperatorAction::kArm);
    run_until([this] { return is_armed(); }, 30.0);
    run(1.5);
  }
  void begin_take_off() {
    arm();
    command(models::OperatorAction::kTakeOff);
  }
  void fly() { ASSERT_TRUE(take_off()) << reasons(); }
  void hover() {
    fly();
    run(2.0);
  }
  models::RobotPlan plan_on(double speed_mps, double seconds) {
    std::vector<models::PlanSegment> segments{{{speed_mps, 0.0}, seconds, 0.0}};
    for (const models::PlanSegment& stop :
         models::brake(speed_mps, scenario.robots[0].limits.brake_mps2)) {
      segments.push_back(stop);
    }
    return plan(flatten(vehicle.world_from_body()), segments, std::chrono::milliseconds(500));
  }

  models::AutopilotDialect dialect_ = scenario.robots[0].autopilot->dialect;
};

}  // namespace vantage::test
