#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/safety/autopilot_watch.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/safety/height_state.hpp"
#include "drivers/safety/ladder.hpp"
#include "drivers/safety/landing.hpp"
#include "drivers/safety/plan_check.hpp"
#include "drivers/safety/setpoint.hpp"
#include "drivers/safety/take_off.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Set-point of the vehicle for this tick.
struct FlightSetpoint : Setpoint {
  enum class Kind {
    kNone,       ///< idle on the ground: no set-point; disarm if armed without need
    kTrack,      ///< position and velocity for the instant setpoint_lead_s from now
    kBlindLand,  ///< no usable position: the autopilot's landing mode
    kMotorsOff,  ///< forced disarm, repeated at each tick
  };
  Kind kind = Kind::kNone;
};

struct GuardOutput {
  models::FlightState state = models::FlightState::kIdle;
  FlightSetpoint setpoint;
  /// the autopilot must be armed (true) or disarmed (false)
  bool wants_armed = false;
  /// m; goal of the current climb: the first lift, then the flight height
  double climb_to_m = 0.0;
  /// true: the vehicle descends at its landing spot, and no body is below it
  bool is_sinking = false;
  bool changed = false;  ///< state, reasons or the status of a command changed
  /// in the air: acting conditions; on the ground: conditions that forbid arming or taking off
  Reasons reasons;
};

/// Flight safety of one flying vehicle. It receives all messages, checks them, and computes at each
/// tick what the vehicle must do. It is independent of the bus and of the autopilot's protocol.
/// GuardCore contains the state that all vehicle types share; AutopilotWatch, TakeOff and Landing
/// contain the rules of a flying vehicle.
///
/// `now` is the receiver's monotonic time, converted to the clock of plan stamps. It must not
/// decrease between calls. Call tick() at 50 Hz or more in all circumstances. Only the constructor
/// and the functions marked "Allocates" allocate memory.
class FlightGuard {
 public:
  /// @throws UsageError for an unknown robot or invalid limits.
  FlightGuard(const scenario::Scenario& scenario, const std::string& robot,
              const SafetyLimits& limits);

  /// Processes a mocap frame. Returns false for a publisher that is not accepted (MocapSource).
  /// The caller subscribes to VICON as a shared channel; this function selects the publisher.
  [[nodiscard]] bool on_mocap(const models::MocapFrame& frame, Time now);
  /// Returns the capture time of the last frame of the accepted publisher, by the local clock
  /// (MocapClock).
  [[nodiscard]] Time captured() const { return core_.captured(); }
  /// Returns the verdict about this vehicle's body in the last accepted frame.
  [[nodiscard]] PoseVerdict pose_verdict() const { return core_.pose_verdict(); }
  /// Checks a plan for this vehicle. The caller subscribes to PLAN_R as a shared channel; the
  /// planner lease selects the publisher.
  PlanVerdict on_plan(const models::RobotPlan& plan, Time now) {
    return core_.on_plan(plan, may_take_plans(), height_.command_m, now);
  }
  /// Processes a teammate's plan; plans of robots outside the scenario are ignored.
  void on_teammate_plan(const models::RobotPlan& plan, Time now) {
    core_.on_teammate_plan(plan, now);
  }
  /// Processes a teammate's status: records that its driver is alive, and whether it is in its
  /// first lift.
  void on_teammate_status(const models::VehicleStatus& status, Time now);
  CommandVerdict on_command(const models::OperatorCommand& command, Time now);
  void on_heartbeat(Time now) { autopilot_.on_heartbeat(now); }
  void on_autopilot(const AutopilotReport& report, Time now) { autopilot_.on_report(report, now); }
  void on_battery(double share, Time now) { autopilot_.on_battery(share, now); }
  /// Reports whether the scenario announced by other processes equals this driver's scenario.
  void on_map(bool is_same) { core_.on_map(is_same); }
  /// Reports the time that this thread waited for a processor within the last second, s.
  void on_processor_wait(double wait_s) { core_.on_processor_wait(wait_s); }
  /// Requests the end of the driver: the vehicle lands and is not armed again.
  void on_end_request() { core_.on_end_request(); }
  /// Reports a message of an unknown type on a channel of this stack.
  void on_other_version(Time now) { core_.on_other_version(now); }

  GuardOutput tick(Time now);

  /// Returns the status for VEHICLE_R; the publisher sets the stamp's run and sequence. Allocates.
  [[nodiscard]] models::VehicleStatus status(Time now) const;
  /// Returns the counters of refused and dropped messages. Allocates.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  /// Returns the inputs of the last tick.
  [[nodiscard]] const SafetyInputs& inputs() const { return core_.inputs(); }
  /// Returns the last plausible pose; the identity before the first plausible pose.
  [[nodiscard]] Pose3 world_from_body() const { return core_.pose().world_from_body(); }

 private:
  [[nodiscard]] bool may_take_plans() const;
  [[nodiscard]] bool is_descending() const;
  [[nodiscard]] bool is_blind() const;
  [[nodiscard]] double height_error_m() const;
  void update_inputs(Time now);
  void update_height(Time now);
  void detect_flight(Time now);
  void update_ages(Time now);
  void update_tracking_error(Time now);
  void on_state_change(models::FlightState before, Time now);
  void leave_plan(Time now);
  void hold(Time now);
  void move(double dt_s, Time now);
  void move_height(double dt_s, Time now);
  [[nodiscard]] FlightSetpoint setpoint(Time now) const;

  GuardCore core_;
  AutopilotWatch autopilot_;
  TakeOff take_off_;
  Landing landing_;
  HeightState height_;
  std::optional<Time> started_at_;  ///< time of the first tick
  Time airborne_at_{};
  bool distrusts_pose_ = false;  ///< an acting condition distrusts poses
  std::int64_t stalls_ = 0;
};

}  // namespace vantage::drivers
