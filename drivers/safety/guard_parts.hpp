#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/safety/guard.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/safety/lift.hpp"

namespace vantage::drivers {

/// State of the guard of a flying vehicle, and the steps of its tick.
struct FlightGuard::Parts : GuardCore {
  Parts(const scenario::Scenario& scenario, const std::string& robot, const SafetyLimits& given)
      : GuardCore(scenario, robot, given,
                  // This window limits changes of speed to the vehicle's braking deceleration.
                  Course(half_window_s(given.vehicle), given.round_s)),
        lift_queue(scenario, robot) {}

  [[nodiscard]] double pose_age_s(Time now) const { return pose.age_s(now); }
  [[nodiscard]] BrakingPath braking_path(Time now, double reaction_s) const;
  [[nodiscard]] bool keeps_to_course(Time now) const;
  [[nodiscard]] bool has_planned_speed(Time now) const;
  /// True if a landing has no position that it can use.
  [[nodiscard]] bool is_blind() const;
  void update_inputs(Time now);
  void update_autopilot_inputs(Time now);
  void update_lift_inputs(Time now);
  void update_identity_inputs(Time now);
  [[nodiscard]] bool is_assumed_armed(Time now) const;
  [[nodiscard]] double height_error_m() const;
  void lift_off(Time now);
  void on_state_change(models::FlightState before, Time now);
  void restore_clearance(Time now);
  void land(Time now, double dt_s);
  void move_height(double dt_s);
  [[nodiscard]] FlightSetpoint setpoint(Time now) const;
  [[nodiscard]] bool may_take_plans() const;

  LiftQueue lift_queue;
  Lift lift;
  Time started_at{};  ///< time of the first tick

  // Heights.
  bool had_motors = false;  ///< motor state at the last tick
  bool has_flown = false;   ///< the first lift was completed, or the vehicle was found in the air
  double height_ref_m = 0.0;
  double height_rate_mps = 0.0;  ///< m/s; rate of height_ref_m at the last tick
  double height_goal_m = 0.0;
  double blind_height_m = 0.0;
  double unarmed_height_m = 0.0;   ///< m; height on the ground before the motors started
  std::optional<double> ground_m;  ///< m; last height measured with the motors off
  double climb_from_m = 0.0;
  Time climb_since{};
  bool is_climbing = false;  ///< a take-off is climbing; the autopilot may choose the climb rate
  Time landing_since{}, spot_since{};
  Eigen::Vector3d spot_m = Eigen::Vector3d::Zero();
  bool has_spot = false;
  bool is_sinking = false;
  bool is_committed = false;

  // Received messages.
  AutopilotReport autopilot;
  bool distrusts_pose = false;  ///< an acting condition distrusts poses
  // Horizontal motion, averaged with the time constant velocity_memory_s.
  Eigen::Vector2d moved_apart_m = Eigen::Vector2d::Zero();  ///< m; autopilot's minus mocap's motion
  double moved_m = 0.0;                                     ///< m; length of the autopilot's motion
  Eigen::Vector2d compared_m = Eigen::Vector2d::Zero();     ///< m; position at the last comparison
  double hover_deviation_s = 0.0;  ///< s; duration of the deviation from the commanded hover
  /// m; maximum distance from the hover position since the vehicle last came nearer
  double farthest_off_m = 0.0;
  int disarmed_beats = 0;  ///< number of consecutive heartbeats that report disarmed motors
  Time heartbeat_at{}, telemetry_at{}, battery_at{}, battery_changed_at{}, airborne_at{},
      estimator_good_at{};
  bool has_heartbeat = false, has_telemetry = false, has_battery = false;
  double battery_share = 1.0;

  std::int64_t reports_refused = 0, stalls = 0;
};

}  // namespace vantage::drivers
