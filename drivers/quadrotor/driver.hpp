#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"
#include "drivers/quadrotor/flight_sequence.hpp"
#include "drivers/vehicle/driver_end.hpp"
#include "drivers/vehicle/guarded_flight.hpp"
#include "drivers/vehicle/steering.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Driver of one quadrotor, without input and output: received messages are passed in with their
/// arrival time, and messages to send are fetched by the caller. Flight safety (FlightGuard)
/// computes the set-points. The driver sends them over MAVLink and reports the state of the
/// vehicle.
///
/// Arrival times are measured with a monotonic clock and converted to the stack's clock. The same
/// sequence of calls gives the same bytes.
class QuadrotorDriver : public GuardedFlight {
 public:
  static constexpr Duration kPosePeriod{20'000};  ///< minimum time between forwarded poses

  /// @throws UsageError for a robot that is not in the scenario or has no autopilot.
  QuadrotorDriver(const scenario::Scenario& scenario, const std::string& robot,
                  const SafetyLimits& limits,
                  const std::optional<wire::mavlink::SigningKey>& key = std::nullopt);

  /// Processes bytes from the autopilot: a datagram, or a piece of a serial stream. Returns true if
  /// they completed a frame of this vehicle.
  bool receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now);
  /// Checks a mocap frame, and forwards the pose of this vehicle to the autopilot.
  void on_mocap(const models::MocapFrame& frame, Time now);
  void on_command(const models::OperatorCommand& command, Time now);
  /// Ends the driver: lands the vehicle and prevents arming. If `is_hurried`, the autopilot's own
  /// landing mode is used from now on.
  void end(bool is_hurried) { request_end(is_hurried); }
  [[nodiscard]] EndFacts end_facts(Time now) const;
  /// Performs all pending work. Call it about every 5 ms; set-points are sent at 50 Hz.
  void tick(Time now);

  [[nodiscard]] std::vector<WireMessage> take_output() { return link_.take_output(); }
  /// Returns the status for VEHICLE_R: the status of flight safety. Its reasons also state the
  /// refusals and pending actions of the autopilot.
  [[nodiscard]] models::VehicleStatus status(Time now) const;
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  [[nodiscard]] const Telemetry& telemetry() const { return link_.telemetry(); }
  [[nodiscard]] const ParameterCheck& parameters() const { return link_.parameters(); }

 private:
  void report_autopilot(Time now);
  void fly(Time now);
  [[nodiscard]] FlightGoal goal(const GuardOutput& out) const;
  [[nodiscard]] bool may_steer_landing() const;
  [[nodiscard]] std::optional<std::string> refusal(Time now) const;

  models::AutopilotDialect dialect_;
  scenario::ParameterPolicy parameter_policy_;
  AutopilotLink link_;
  FlightSequence sequence_;
  std::optional<Time> mode_ordered_at_;  ///< stamp of the last command that may change the mode
  Time next_pose_{};
  std::optional<Time> heartbeat_reported_;
  std::optional<Time> battery_reported_;
  std::optional<Time> telemetry_reported_;
  bool lands_blind_ = false;  ///< the autopilot's current landing began without poses
  double settled_s_ = 0.0;    ///< s; time since the last gap in the poses
  Time motors_wanted_at_{};   ///< last time at which running motors were requested
};

}  // namespace vantage::drivers
