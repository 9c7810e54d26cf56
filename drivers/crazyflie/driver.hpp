#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/crazyflie/flight_sequence.hpp"
#include "drivers/crazyflie/link.hpp"
#include "drivers/vehicle/driver_end.hpp"
#include "drivers/vehicle/guarded_flight.hpp"
#include "drivers/vehicle/steering.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Driver of one Crazyflie, without input and output: received messages are passed in with their
/// arrival time, and packets to send are fetched by the caller. Flight safety (FlightGuard)
/// computes the set-points, which the driver sends as full states.
///
/// The same sequence of calls gives the same bytes.
class CrazyflieDriver : public GuardedFlight {
 public:
  static constexpr Duration kPosePeriod{40'000};  ///< 25 Hz; minimum time between sent poses

  /// @throws UsageError for a robot that is not in the scenario or has no `crazyflie`.
  CrazyflieDriver(const scenario::Scenario& scenario, const std::string& robot,
                  const SafetyLimits& limits, const std::shared_ptr<TableCache>& cache);

  /// Processes the bytes of one packet from the vehicle. Returns false if they are not a packet.
  bool receive(std::span<const std::uint8_t> bytes, Time now);
  /// Checks a mocap frame, and sends the vehicle its pose.
  void on_mocap(const models::MocapFrame& frame, Time now);
  void on_command(const models::OperatorCommand& command, Time now);
  /// Ends the driver: lands the vehicle and prevents arming. If `is_hurried`, the vehicle's own
  /// landing is used from now on.
  void end(bool is_hurried) { request_end(is_hurried); }
  [[nodiscard]] EndFacts end_facts(Time now) const;
  /// Performs all pending work. Call it about every 5 ms; set-points are sent at 50 Hz.
  void tick(Time now);

  [[nodiscard]] std::vector<wire::crtp::Encoded> take_output() { return link_.take_output(); }
  /// Returns the status for VEHICLE_R. Its reasons also state why the vehicle cannot be used.
  [[nodiscard]] models::VehicleStatus status(Time now) const;
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  [[nodiscard]] const CrazyflieTelemetry& telemetry() const { return link_.telemetry(); }
  [[nodiscard]] const SafetyInputs& inputs() const { return guard_.inputs(); }

 private:
  void report_vehicle(Time now);
  void report_battery(Time now);
  void fly(Time now);
  void send_setpoint(const Setpoint& setpoint);
  [[nodiscard]] CrazyflieGoal goal(const GuardOutput& out) const;

  scenario::CrazyflieSpec spec_;
  CrazyflieLink link_;
  CrazyflieSequence sequence_;
  Time next_pose_{};
  std::optional<Time> sent_pose_;
  std::optional<Time> info_reported_, state_reported_, battery_reported_;
  double flown_s_ = 0.0;  ///< s; time with running motors, for a vehicle without a battery sensor
};

}  // namespace vantage::drivers
