#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/time.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/safety/ladder.hpp"
#include "drivers/safety/plan_check.hpp"
#include "drivers/safety/setpoint.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Newest state reported by the autopilot; passed to the guard whenever a field changes.
struct AutopilotReport {
  bool armed = false;
  bool obeys = true;  ///< in the mode that accepts set-points, or this mode was not requested yet
  bool estimator_good = false;
  bool motor_failed = false;
  double tilt_rad = 0.0;
  bool has_position = false;
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();  ///< m; estimate of the autopilot
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  bool has_attitude = false;
  Quaternion world_from_body = Quaternion::Identity();  ///< estimate of the autopilot
  double yaw_rate_radps = 0.0;                          ///< rad/s; by its gyroscopes
  bool is_flown_by_hand = false;                        ///< a pilot controls the vehicle
  bool is_in_our_mode = false;                          ///< the autopilot is in the mode that
                                                        ///< accepts set-points
  bool is_landing_itself = false;                       ///< the autopilot is in its landing mode
};

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
  bool is_sinking = false;  ///< descending at its landing spot, with no body below
  bool changed = false;     ///< state, reasons or the status of a command changed
  Reasons reasons;          ///< in the air: acting conditions; on the ground: conditions that
                            ///< forbid arming or taking off
};

/// Flight safety of one flying vehicle. It receives all messages, checks them, and computes at each
/// tick what the vehicle must do. It is independent of the bus and of the autopilot's protocol.
///
/// `now` is the receiver's monotonic time, converted to the clock of plan stamps. It must not
/// decrease between calls. Call tick() at 50 Hz or more in all circumstances. Only the constructor
/// and the functions marked "Allocates" allocate memory.
class FlightGuard {
 public:
  /// @throws UsageError for an unknown robot or invalid limits.
  FlightGuard(const scenario::Scenario& scenario, const std::string& robot,
              const SafetyLimits& limits);
  ~FlightGuard();
  FlightGuard(const FlightGuard&) = delete;
  FlightGuard& operator=(const FlightGuard&) = delete;
  FlightGuard(FlightGuard&&) = delete;
  FlightGuard& operator=(FlightGuard&&) = delete;

  /// Processes a mocap frame. Returns false for a publisher that is not accepted (MocapSource).
  /// Subscribe to VICON as a shared channel: this function chooses the publisher.
  [[nodiscard]] bool on_mocap(const models::MocapFrame& frame, Time now);
  /// Returns the capture time of the last frame of the accepted publisher, by the local clock
  /// (MocapClock).
  [[nodiscard]] Time captured() const;
  /// Returns the verdict about this vehicle's body in the last accepted frame.
  [[nodiscard]] PoseVerdict pose_verdict() const;
  /// Checks a plan for this vehicle. Subscribe to PLAN_R as a shared channel: the lease chooses the
  /// publisher.
  PlanVerdict on_plan(const models::RobotPlan& plan, Time now);
  /// Processes a teammate's plan; plans of robots outside the scenario are ignored.
  void on_teammate_plan(const models::RobotPlan& plan, Time now);
  /// Processes a teammate's status: records that its driver is alive, and whether it is in its
  /// first lift.
  void on_teammate_status(const models::VehicleStatus& status, Time now);
  CommandVerdict on_command(const models::OperatorCommand& command, Time now);
  void on_heartbeat(Time now);
  void on_autopilot(const AutopilotReport& report, Time now);
  void on_battery(double share, Time now);
  /// Reports whether the scenario announced by other processes equals this driver's scenario.
  void on_map(bool is_same);
  /// Reports the time that this thread waited for a processor within the last second, s.
  void on_processor_wait(double wait_s);
  /// Requests the end of the driver: the vehicle lands and is not armed again.
  void on_end_request();
  /// Reports a message of an unknown type on a channel of this stack.
  void on_other_version(Time now);

  GuardOutput tick(Time now);

  /// Returns the status for VEHICLE_R; the publisher sets the stamp's run and sequence. Allocates.
  [[nodiscard]] models::VehicleStatus status(Time now) const;
  /// Returns the counters of refused and dropped messages. Allocates.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  /// Returns the inputs of the last tick.
  [[nodiscard]] const SafetyInputs& inputs() const;
  /// Returns the last plausible pose; the identity before the first plausible pose.
  [[nodiscard]] Pose3 world_from_body() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vantage::drivers
