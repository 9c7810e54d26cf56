#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"
#include "drivers/quadrotor/body_tracker.hpp"
#include "drivers/quadrotor/flight_sequence.hpp"
#include "drivers/quadrotor/steering.hpp"
#include "drivers/safety/guard.hpp"
#include "drivers/vehicle/driver_end.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// The driver of one quadrotor, without any input or output of its own: what arrives is handed to
/// it with the time of arrival, what is to go out is fetched. Flight safety (FlightGuard) decides
/// where the vehicle is to be; this carries it out over MAVLink and reports what the vehicle says.
///
/// Times are the receiver's monotonic ones, expressed in the stack's clock. The same calls give the
/// same bytes.
class QuadrotorDriver {
 public:
  /// Set-points leave with a pose, as soon as this is over since the last one, so that they are
  /// told from a pose that is new; and without poses by the clock.
  static constexpr Duration kSetpointSpacing{15'000};
  static constexpr Duration kSetpointPeriod{20'000};  ///< 50 Hz
  static constexpr Duration kPoseGrace{3'000};        ///< that the clock waits longer for a pose
  static constexpr Duration kPosePeriod{20'000};      ///< poses are forwarded no faster

  /// @throws UsageError for a robot that is not in the scenario or has no autopilot.
  QuadrotorDriver(const scenario::Scenario& scenario, const std::string& robot,
                  const SafetyLimits& limits,
                  const std::optional<wire::mavlink::SigningKey>& key = std::nullopt);

  /// Takes bytes from the autopilot: a datagram, or a piece of a serial stream. True if a frame of
  /// this vehicle was complete with them.
  bool receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now);
  /// Forwards the pose of this vehicle at once.
  void on_mocap(const models::MocapFrame& frame, Time now);
  /// This vehicle's plan, or a teammate's.
  void on_plan(const models::RobotPlan& plan, Time now);
  void on_teammate_status(const models::VehicleStatus& status, Time now) {
    guard_.on_teammate_status(status, now);
  }
  void on_command(const models::OperatorCommand& command, Time now);
  /// Whether the scenario that others announce is the one flown here.
  void on_map(bool is_same) { guard_.on_map(is_same); }
  /// Somebody said what is of no type of ours: another version of this program, perhaps.
  void on_other_version(Time now) { guard_.on_other_version(now); }
  /// Reports how long the driver's thread waited for a processor within the last second, s.
  void on_processor_wait(double wait_s) { guard_.on_processor_wait(wait_s); }
  /// The driver is to end: lands the vehicle, keeps it from being armed. In a hurry the autopilot's
  /// own landing does that from here on.
  void end(bool is_hurried);
  [[nodiscard]] EndFacts end_facts(Time now) const;
  /// Does what is due. To be called every 5 ms or so; set-points go out at 50 Hz.
  void tick(Time now);

  [[nodiscard]] std::vector<WireMessage> take_output() { return link_.take_output(); }
  /// For VEHICLE_R: flight safety's view, and in its reasons what the autopilot refuses or waits
  /// for.
  [[nodiscard]] models::VehicleStatus status(Time now) const;
  /// True once after the state or the reasons have changed.
  [[nodiscard]] bool take_news() { return std::exchange(has_news_, false); }
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  [[nodiscard]] const Telemetry& telemetry() const { return link_.telemetry(); }
  [[nodiscard]] const ParameterCheck& parameters() const { return link_.parameters(); }

 private:
  void report_autopilot(Time now);
  void fly(Time now);
  [[nodiscard]] FlightGoal goal(const GuardOutput& out) const;
  [[nodiscard]] bool is_nearly_down() const;
  [[nodiscard]] bool may_steer_landing() const;
  [[nodiscard]] std::optional<std::string> refusal(Time now) const;

  std::string robot_;
  models::AutopilotDialect dialect_;
  scenario::ParameterPolicy parameter_policy_;
  AutopilotLink link_;
  FlightGuard guard_;
  BodyTracker tracker_;
  FlightSequence sequence_;
  models::VehicleLimits vehicle_;
  GuardOutput orders_;
  std::optional<double> ground_m_;  ///< height of the body when it was last seen standing unarmed
  std::optional<Time> mode_ordered_at_;  ///< stamp of the last order that takes the mode
  Time last_setpoint_{};
  Time next_setpoint_{};
  Time next_pose_{};
  std::optional<Time> heartbeat_reported_;
  std::optional<Time> battery_reported_;
  std::optional<Time> telemetry_reported_;
  bool has_news_ = false;
  bool lands_blind_ = false;  ///< the autopilot's landing under way began without poses
  double settled_s_ = 0.0;    ///< since poses came without a gap
  bool is_hurried_ = false;   ///< to end
  Time motors_wanted_at_{};   ///< when it was last to run its motors
  std::int64_t poses_refused_ = 0;
  std::int64_t poses_unseen_ = 0;
};

}  // namespace vantage::drivers
