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
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// What the autopilot said, as far as it is known; handed over whenever any of it is news.
struct AutopilotReport {
  bool armed = false;
  bool obeys = true;  ///< in the mode that takes our set-points, or we have not asked for it yet
  bool estimator_good = false;
  bool motor_failed = false;
  double tilt_rad = 0.0;
  bool has_position = false;
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();  ///< its own estimate
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  bool has_attitude = false;
  Quaternion world_from_body = Quaternion::Identity();  ///< its own estimate
  double yaw_rate_radps = 0.0;                          ///< by its gyroscopes
  bool is_flown_by_hand = false;                        ///< in a mode that a pilot flies
  bool is_in_our_mode = false;                          ///< the one that takes our set-points
  bool is_landing_itself = false;                       ///< in its landing mode
};

/// What the vehicle is to do now.
struct FlightSetpoint {
  enum class Kind {
    kNone,       ///< idle on the ground: nothing; disarm when armed and not wanted
    kTrack,      ///< be at position_world_m moving at velocity_world_mps, setpoint_lead_s from now
    kBlindLand,  ///< no position to steer by: the autopilot's own landing
    kMotorsOff,  ///< forced disarm, repeated each tick
  };
  Kind kind = Kind::kNone;
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_world_mps2 = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  double yaw_rate_radps = 0.0;
};

struct GuardOutput {
  models::FlightState state = models::FlightState::kIdle;
  FlightSetpoint setpoint;
  bool wants_armed = false;  ///< arm the autopilot when false there, disarm it when false here
  double climb_to_m = 0.0;   ///< height that a climb under way goes to; the first lift's, then more
  bool is_sinking = false;   ///< landing, over its place, and nobody below is waited for
  bool changed = false;      ///< state, reasons or what became of orders differ
  Reasons reasons;           ///< what acts (in the air) or blocks what is ordered (on the ground)
};

/// Flight safety of one vehicle: hears everything, judges it, and says at each tick what the
/// vehicle is to do. Sits between the bus and the autopilot's codec; knows neither.
///
/// `now` is the receiver's own monotonic time expressed in the stack's clock (plans are timed by
/// it), never older than the one before. Call tick() at 50 Hz or more, whatever else happens.
/// Nothing but the constructor and on_map() allocates.
class FlightGuard {
 public:
  /// @throws UsageError for an unknown robot or limits that cannot be.
  FlightGuard(const scenario::Scenario& scenario, const std::string& robot,
              const SafetyLimits& limits);
  ~FlightGuard();
  FlightGuard(const FlightGuard&) = delete;
  FlightGuard& operator=(const FlightGuard&) = delete;
  FlightGuard(FlightGuard&&) = delete;
  FlightGuard& operator=(FlightGuard&&) = delete;

  /// False for a frame of a publisher that is not believed (MocapSource). Subscribe to VICON as a
  /// shared channel: it is decided here.
  [[nodiscard]] bool on_mocap(const models::MocapFrame& frame, Time now);
  /// Capture of the last frame of the trusted publisher, by our clock (MocapClock).
  [[nodiscard]] Time captured() const;
  /// Of this vehicle's own body in the last frame that was believed.
  [[nodiscard]] PoseVerdict pose_verdict() const;
  /// A plan for this vehicle. Subscribe to PLAN_R as a shared channel: the lease decides here.
  PlanVerdict on_plan(const models::RobotPlan& plan, Time now);
  /// A teammate's; ignored for robots that the scenario does not know.
  void on_teammate_plan(const models::RobotPlan& plan, Time now);
  /// What a teammate says of itself: whether it is at its first lift.
  void on_teammate_status(const models::VehicleStatus& status, Time now);
  CommandVerdict on_command(const models::OperatorCommand& command, Time now);
  void on_heartbeat(Time now);
  void on_autopilot(const AutopilotReport& report, Time now);
  void on_battery(double share, Time now);
  /// Whether the scenario announced by others is the one flown here.
  void on_map(bool is_same);
  /// Reports how long our own thread waited for a processor within the last second, s.
  void on_processor_wait(double wait_s);
  /// The driver was asked to end: from now on the vehicle lands, and is not armed again.
  void on_end_request();
  /// Somebody said on a channel of ours what is of no type of ours.
  void on_other_version(Time now);

  GuardOutput tick(Time now);

  /// For VEHICLE_R; the stamp's run and sequence are the publisher's. Allocates.
  [[nodiscard]] models::VehicleStatus status(Time now) const;
  /// Everything refused or dropped, by name. Allocates.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  /// What the last tick looked at.
  [[nodiscard]] const SafetyInputs& inputs() const;
  /// Last plausible pose; identity before any.
  [[nodiscard]] Pose3 world_from_body() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vantage::drivers
