#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "drivers/safety/guard.hpp"
#include "drivers/vehicle/body_tracker.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Flight safety and pose tracking of one flying vehicle: the part that the drivers of all flying
/// vehicles share. It judges mocap frames and computes the orders; the derived driver sends them to
/// the vehicle.
class GuardedFlight {
 public:
  /// Minimum time between set-points. After this time the next set-point is sent when a pose
  /// arrives, so that it is computed from a new pose. Without poses, set-points are sent
  /// periodically.
  static constexpr Duration kSetpointSpacing{15'000};
  static constexpr Duration kSetpointPeriod{20'000};  ///< 50 Hz
  static constexpr Duration kPoseGrace{3'000};  ///< maximum wait for a pose after kSetpointPeriod

  /// Processes a plan of this vehicle or of a teammate.
  void on_plan(const models::RobotPlan& plan, Time now);
  void on_teammate_status(const models::VehicleStatus& status, Time now) {
    guard_.on_teammate_status(status, now);
  }
  /// Reports whether the scenario announced by other processes equals this driver's scenario.
  void on_map(bool is_same) { guard_.on_map(is_same); }
  /// Reports a message of an unknown type, perhaps from another version of this program.
  void on_other_version(Time now) { guard_.on_other_version(now); }
  /// Reports the time that the driver's thread waited for a processor within the last second, s.
  void on_processor_wait(double wait_s) { guard_.on_processor_wait(wait_s); }
  /// Returns true once after the state or the reasons have changed.
  [[nodiscard]] bool take_changed() { return std::exchange(has_changed_, false); }

 protected:
  /// @throws UsageError for a robot that is not in the scenario.
  GuardedFlight(const scenario::Scenario& scenario, const std::string& robot,
                const SafetyLimits& limits);
  ~GuardedFlight() = default;
  GuardedFlight(const GuardedFlight&) = default;
  GuardedFlight& operator=(const GuardedFlight&) = default;

  /// Judges and counts a mocap frame. Returns true if it contains a new acceptable pose of this
  /// vehicle, which is then the state of `tracker_`.
  [[nodiscard]] bool accept_pose(const models::MocapFrame& frame, Time now);
  /// True if a set-point may be sent now; see kSetpointSpacing.
  [[nodiscard]] bool may_send_setpoint(Time now) const;
  /// Computes the orders for `now` and the time of the next set-point. Returns the time since the
  /// last set-point, s.
  double update_orders(Time now);
  /// Lands the vehicle and prevents arming. If `is_hurried`, the vehicle's own landing is used.
  void request_end(bool is_hurried);
  /// Returns the newest state if it is at most 0.1 s old, so that it may correct a set-point.
  [[nodiscard]] std::optional<BodyState> seen_body(Time now) const;
  /// True if the body is less than `height_m` above the ground. An unknown ground height is assumed
  /// to be 0.
  [[nodiscard]] bool is_below(double height_m) const;
  /// Appends the counters of flight safety, and the counters of poses with names that begin with
  /// `prefix`.
  void append_counters(std::vector<models::NamedCount>& counters, std::string_view prefix) const;

  FlightGuard guard_;
  BodyTracker tracker_;
  models::VehicleLimits vehicle_;
  GuardOutput orders_;
  /// m; last height of the body on the ground with the motors off, measured by mocap
  std::optional<double> ground_m_;
  Time next_setpoint_{};
  bool is_hurried_ = false;  ///< the driver ends without waiting for a steered landing

 private:
  std::string robot_;
  Time last_setpoint_{};
  bool has_changed_ = false;
  std::int64_t poses_refused_ = 0;
  std::int64_t poses_unseen_ = 0;
};

}  // namespace vantage::drivers
