#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/safety/authority.hpp"
#include "drivers/safety/course.hpp"
#include "drivers/safety/fleet.hpp"
#include "drivers/safety/guard.hpp"
#include "drivers/safety/lift.hpp"
#include "drivers/safety/mocap_clock.hpp"
#include "drivers/safety/mocap_source.hpp"
#include "drivers/safety/plan_gate.hpp"
#include "drivers/safety/pose_monitor.hpp"

namespace vantage::drivers {

inline constexpr double kPredictS = 0.1;  ///< how far the own pose is carried on

/// What a FlightGuard remembers, and what it does at each tick.
struct FlightGuard::Parts {
  Parts(const scenario::Scenario& scenario, const std::string& robot, const SafetyLimits& given)
      : name(robot),
        limits(given),
        fleet(scenario, robot),
        lift_queue(scenario, robot),
        plans(robot),
        // Speeds then change no faster than the vehicle brakes.
        course(half_window_s(given.vehicle), given.round_s) {}

  [[nodiscard]] double pose_age_s(Time now) const { return pose.age_s(now); }
  [[nodiscard]] BrakeWay brake_way(Time now, double reaction_s) const;
  [[nodiscard]] bool keeps_to_course(Time now) const;
  /// Landing, there is no position to steer by.
  [[nodiscard]] bool is_blind() const;
  void look(Time now);
  void look_at_autopilot(Time now);
  void look_at_lift(Time now);
  [[nodiscard]] bool believes_armed(Time now) const;
  [[nodiscard]] double height_error_m() const;
  void lift_off(Time now);
  void change(models::FlightState before, Time now);
  void move_off(Time now);
  void land(Time now, double dt_s);
  void move_height(double dt_s);
  [[nodiscard]] FlightSetpoint setpoint(Time now) const;
  [[nodiscard]] bool may_take_plans() const;

  std::string name;
  SafetyLimits limits;
  Fleet fleet;
  LiftQueue lift_queue;
  Lift lift;
  PoseMonitor pose;
  MocapSource source;
  MocapClock clock;
  PlanGate plans;
  OperatorAuthority authority;
  Course course;
  LadderState ladder;
  SafetyInputs in;
  Reasons reasons;
  Time last_tick{};
  Time started_at{};  ///< first tick
  bool has_ticked = false;

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
  int disarmed_beats = 0;  ///< heartbeats in a row that say so
  Time heartbeat_at{}, telemetry_at{}, battery_at{}, battery_changed_at{}, airborne_at{},
      estimator_good_at{};
  bool has_heartbeat = false, has_telemetry = false, has_battery = false;
  double battery_share = 1.0;
  bool map_differs = false;
  std::optional<Time> other_version_at;
  bool emergency_stop = false;
  std::optional<models::OperatorAction> request;

  std::array<std::int64_t, kPoseVerdicts> pose_counts{};
  std::int64_t clocks_set = 0, reports_refused = 0, commands_refused = 0, stalls = 0;
};

}  // namespace vantage::drivers
