#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/time.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/safety/height_state.hpp"

namespace vantage::drivers {

/// Newest state reported by the autopilot; passed to the guard whenever a field changes.
struct AutopilotReport {
  bool armed = false;
  /// true: in the mode that accepts set-points, or this mode was not requested yet
  bool obeys = true;
  bool estimator_good = false;
  bool motor_failed = false;
  double tilt_rad = 0.0;
  bool has_position = false;
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();  ///< m; estimate of the autopilot
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  bool has_attitude = false;
  Quaternion world_from_body = Quaternion::Identity();  ///< estimate of the autopilot
  double yaw_rate_radps = 0.0;                          ///< rad/s; measured by the gyroscopes
  bool is_flown_by_hand = false;                        ///< a pilot controls the vehicle
  /// the autopilot is in the mode that accepts set-points
  bool is_in_our_mode = false;
  bool is_landing_itself = false;  ///< the autopilot is in its landing mode
};

/// Phase of the flight in which the motion of a vehicle is checked.
struct FlightPhase {
  bool is_taking_off = false;  ///< in the lift check, or in the climb that follows
  bool is_descending = false;  ///< descending at its landing spot
};

/// Messages of the autopilot, and the check that autopilot and mocap describe the same body: its
/// pose, its motion, its hover and its descent.
class AutopilotWatch {
 public:
  /// Stores a report. Refuses and counts a report with a number that is not finite.
  void on_report(const AutopilotReport& report, Time now);
  void on_heartbeat(Time now);
  /// Stores a battery level. Refuses and counts a value outside [0, 1].
  void on_battery(double share, Time now);

  [[nodiscard]] const AutopilotReport& report() const { return report_; }
  [[nodiscard]] double telemetry_age_s(Time now) const { return time_since_s(report_at_, now); }
  [[nodiscard]] double heartbeat_age_s(Time now) const { return time_since_s(heartbeat_at_, now); }
  [[nodiscard]] double battery_age_s(Time now) const { return time_since_s(battery_at_, now); }
  [[nodiscard]] bool has_heartbeat() const { return heartbeat_at_.has_value(); }
  [[nodiscard]] double battery_share() const { return battery_share_; }
  /// Returns the time since the last tick at which the estimator was reported as good, s.
  [[nodiscard]] double estimator_gap_s(Time now) const {
    return to_seconds(now - estimator_good_at_);
  }
  [[nodiscard]] std::int64_t refused() const { return refused_; }

  /// True if the autopilot's position may be used.
  [[nodiscard]] bool has_estimate(const GuardCore& core) const;
  /// Returns false if the motors are assumed to be off. While mocap shows the body flying, a report
  /// of disarmed motors is ignored, since it may be from another vehicle. Without a pose, several
  /// consecutive reports are required.
  [[nodiscard]] bool is_assumed_armed(const GuardCore& core, Time now) const;
  /// Fills the inputs from the report and from its differences to mocap.
  void update_inputs(GuardCore& core, const FlightPhase& phase, const HeightState& height,
                     Time now);

 private:
  [[nodiscard]] bool can_compare_motion(const GuardCore& core) const;
  void compare_poses(GuardCore& core, Time now) const;
  void compare_motion(GuardCore& core, Time now);
  void check_hover(GuardCore& core, bool is_taking_off, Time now);

  AutopilotReport report_;
  std::optional<Time> report_at_, heartbeat_at_, battery_at_, battery_changed_at_;
  Time estimator_good_at_{};
  int disarmed_beats_ = 0;  ///< number of consecutive heartbeats that report disarmed motors
  double battery_share_ = 1.0;
  std::int64_t refused_ = 0;

  // Horizontal motion, averaged with the time constant velocity_memory_s.
  Eigen::Vector2d moved_apart_m_ =
      Eigen::Vector2d::Zero();                            ///< m; autopilot's minus mocap's motion
  double moved_m_ = 0.0;                                  ///< m; length of the autopilot's motion
  Eigen::Vector2d compared_m_ = Eigen::Vector2d::Zero();  ///< m; position at the last comparison
  double hover_deviation_s_ = 0.0;  ///< s; duration of the deviation from the commanded hover
  /// m; maximum distance from the hover position since the vehicle last came nearer
  double farthest_off_m_ = 0.0;
};

}  // namespace vantage::drivers
