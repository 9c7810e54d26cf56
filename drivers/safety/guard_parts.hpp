#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/safety/guard.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/safety/lift.hpp"

namespace vantage::drivers {

/// What the guard of a vehicle that flies remembers besides, and what it does at each tick.
struct FlightGuard::Parts : GuardCore {
  Parts(const scenario::Scenario& scenario, const std::string& robot, const SafetyLimits& given)
      : GuardCore(scenario, robot, given,
                  // Speeds then change no faster than the vehicle brakes.
                  Course(half_window_s(given.vehicle), given.round_s)),
        lift_queue(scenario, robot) {}

  [[nodiscard]] double pose_age_s(Time now) const { return pose.age_s(now); }
  [[nodiscard]] BrakeWay brake_way(Time now, double reaction_s) const;
  [[nodiscard]] bool keeps_to_course(Time now) const;
  [[nodiscard]] bool has_planned_speed(Time now) const;
  /// Landing, there is no position to steer by.
  [[nodiscard]] bool is_blind() const;
  void look_at_all(Time now);
  void look_at_autopilot(Time now);
  void look_at_lift(Time now);
  void look_at_identity(Time now);
  [[nodiscard]] bool believes_armed(Time now) const;
  [[nodiscard]] double height_error_m() const;
  void lift_off(Time now);
  void change(models::FlightState before, Time now);
  void move_off(Time now);
  void land(Time now, double dt_s);
  void move_height(double dt_s);
  [[nodiscard]] FlightSetpoint setpoint(Time now) const;
  [[nodiscard]] bool may_take_plans() const;

  LiftQueue lift_queue;
  Lift lift;
  Time started_at{};  ///< first tick

  // Heights.
  bool had_motors = false;  ///< at the last tick
  bool has_flown = false;   ///< its first lift was proven, or it was found in the air
  double height_ref_m = 0.0;
  double height_rate_mps = 0.0;  ///< of height_ref_m, at the last tick
  double height_goal_m = 0.0;
  double blind_height_m = 0.0;
  double stand_height_m = 0.0;     ///< where it was last seen without motors
  std::optional<double> ground_m;  ///< where it was last seen with its motors off
  double climb_from_m = 0.0;
  Time climb_since{};
  bool is_climbing = false;  ///< to where a take-off goes; by the autopilot's own law perhaps
  Time landing_since{}, spot_since{};
  Eigen::Vector3d spot_m = Eigen::Vector3d::Zero();
  bool has_spot = false;
  bool is_sinking = false;
  bool is_committed = false;

  // What was heard.
  AutopilotReport autopilot;
  bool distrusts_pose = false;  ///< by a row that acts
  // Motion in the plane, which is forgotten within velocity_memory_s.
  Eigen::Vector2d moved_apart_m = Eigen::Vector2d::Zero();  ///< reported motion less seen motion
  double moved_m = 0.0;                                     ///< length of the reported motion
  Eigen::Vector2d compared_m = Eigen::Vector2d::Zero();     ///< pose at the last comparison
  double restless_s = 0.0;      ///< for so long it was to hover and did not
  double restless_off_m = 0.0;  ///< farthest from its position since it last came nearer
  int disarmed_beats = 0;       ///< heartbeats in a row that say so
  Time heartbeat_at{}, telemetry_at{}, battery_at{}, battery_changed_at{}, airborne_at{},
      estimator_good_at{};
  bool has_heartbeat = false, has_telemetry = false, has_battery = false;
  double battery_share = 1.0;

  std::int64_t reports_refused = 0, stalls = 0;
};

}  // namespace vantage::drivers
