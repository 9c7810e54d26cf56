#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "drivers/rover/link.hpp"
#include "drivers/rover/rules.hpp"
#include "drivers/rover/waypoint_path.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/vehicle/driver_end.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

using RoverMessage = std::array<std::uint8_t, wire::rover::kCommandBytes>;

/// Driver of one rover. It receives all messages, checks them, and computes at each tick the
/// command for the rover. Pure: time, messages and bytes are passed in, bytes are returned.
///
/// `now` is the receiver's monotonic time, converted to the stack's clock; it must not decrease.
/// Call tick() at 50 Hz or more: the rover stops 0.2 s after the last command. In FOLLOW it steers
/// back to the plan (steer()). In other states it brakes at the vehicle's deceleration on its
/// present circle, which requires no pose. Only the constructor, status() and counters() allocate.
class RoverDriver {
 public:
  /// @param session  random number, new at each start
  /// @throws UsageError for an unknown robot, one that is not a rover, or invalid limits.
  RoverDriver(const scenario::Scenario& scenario, const std::string& robot,
              const SafetyLimits& limits, std::uint32_t session);

  /// @param pose_sigma_m  see GuardCore::on_mocap()
  void on_mocap(const models::MocapFrame& frame, Time now, double pose_sigma_m = 0.0);
  /// Processes a plan of any robot: checks this rover's plan, stores a teammate's plan.
  PlanVerdict on_plan(const models::RobotPlan& plan, Time now);
  CommandVerdict on_command(const models::OperatorCommand& command, Time now);
  void on_map(bool is_same) { core_.on_map(is_same); }
  /// Ends the driver: stops the rover and prevents arming.
  void end(bool /*is_hurried*/) { core_.on_end_request(); }
  [[nodiscard]] EndFacts end_facts(Time now) const;
  void on_other_version(Time now) { core_.on_other_version(now); }
  /// Reports the time that the driver's thread waited for a processor within the last second, s.
  void on_processor_wait(double wait_s) { core_.on_processor_wait(wait_s); }
  /// Drives through way points instead of along a planner's plan. The motion begins at the rover's
  /// present position half a second from now. It is checked like a plan, and refused while a
  /// planner holds the lease.
  PlanVerdict drive_through(std::span<const Waypoint> waypoints, Time now);
  /// Processes one datagram. Returns true if this rover sent it.
  bool receive(std::span<const std::uint8_t> datagram, Time now);

  /// Returns the command to send.
  RoverMessage tick(Time now);
  /// Returns true once after the state or the reasons have changed.
  [[nodiscard]] bool take_changed() { return std::exchange(has_changed_, false); }

  [[nodiscard]] models::FlightState state() const { return core_.state(); }
  /// Returns the conditions that act or forbid arming, by index into rover_conditions().
  [[nodiscard]] const Reasons& reasons() const { return core_.reasons(); }
  /// Returns the inputs of the last tick.
  [[nodiscard]] const SafetyInputs& inputs() const { return core_.inputs(); }
  [[nodiscard]] const Course& course() const { return core_.course(); }
  [[nodiscard]] const models::UnicycleControl& control() const { return control_; }
  /// Returns the status for VEHICLE_R.
  [[nodiscard]] models::VehicleStatus status(Time now) const;
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  [[nodiscard]] bool has_recent_pose(Time now) const;
  [[nodiscard]] Pose2 world_from_body(Time now) const;
  [[nodiscard]] RoverFacts facts(Time now) const;
  PlanVerdict take(const models::RobotPlan& plan, Time now);
  void update_inputs(Time now);
  void keep_course(models::FlightState before, Time now);
  void drive(Time now, double dt_s);
  [[nodiscard]] std::uint32_t flags() const;

  GuardCore core_;
  RoverLink link_;
  models::UnicycleControl control_;  ///< last command to the rover
  std::int64_t run_id_;              ///< run id of the plans made by drive_through()
  std::int64_t plans_made_ = 0;
  Time release_since_{};
  bool has_changed_ = true;
};

}  // namespace vantage::drivers
