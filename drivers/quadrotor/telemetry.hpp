#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"
#include "wire/mavlink/frame.hpp"

namespace vantage::drivers {

/// Complete text message of an autopilot.
struct AutopilotText {
  Time time{};
  int severity = 7;  ///< severity from 0 (emergency) to 7 (debug)
  std::string text;
};

/// Latest reports of one autopilot. The age of a value is the age of its message; callers must
/// check the times.
class Telemetry {
 public:
  /// @param battery  if given, the charge is also estimated from the voltage
  explicit Telemetry(models::AutopilotDialect dialect,
                     const std::optional<scenario::BatterySpec>& battery = std::nullopt)
      : dialect_(dialect), battery_(battery) {}

  /// Processes a frame of the vehicle.
  void take(const wire::mavlink::Frame& frame, Time now);

  /// True if a HEARTBEAT was received within the last 2.5 s; otherwise at least two were missed.
  [[nodiscard]] bool is_connected(Time now) const;
  [[nodiscard]] bool is_armed() const { return is_armed_; }
  [[nodiscard]] std::uint32_t mode() const { return mode_; }
  [[nodiscard]] std::uint8_t autopilot() const { return autopilot_; }
  [[nodiscard]] std::optional<Time> heartbeat_time() const { return heartbeat_time_; }
  /// Returns the number of reconnections: heartbeats after a gap. The vehicle may have lost its
  /// settings.
  [[nodiscard]] std::int64_t reconnections() const { return reconnections_; }

  /// True if EXTENDED_SYS_STATE reports on ground. If it was not received, true while disarmed.
  [[nodiscard]] bool is_on_ground() const;
  /// Returns the lowest charge of all batteries reported in the last 10 s, in [0, 1]; nullopt if
  /// none is known. With a BatterySpec, the charge of a battery is the lower of the autopilot's
  /// value and the estimate from the voltage: ArduPilot assumes a full battery at each start.
  [[nodiscard]] std::optional<double> battery_share() const { return battery_share_; }
  /// Returns the time of the last message with a charge; nullopt before the first such message.
  [[nodiscard]] std::optional<Time> battery_time() const { return battery_time_; }
  [[nodiscard]] std::optional<std::uint16_t> estimator_flags(Time now) const;
  /// Returns the autopilot's position estimate in the world frame if it is at most 0.5 s old.
  [[nodiscard]] std::optional<Eigen::Vector3d> position_world_m(Time now) const;
  /// True if a finite attitude was received in the last 0.5 s.
  [[nodiscard]] bool has_attitude(Time now) const;
  /// Returns the angle between the body z axis and the vertical, rad, from the autopilot's attitude
  /// estimate.
  [[nodiscard]] double tilt_rad() const { return tilt_rad_; }
  /// Return the autopilot's estimates in the world frame; meaningless before the first message.
  [[nodiscard]] const Eigen::Vector3d& velocity_world_mps() const { return velocity_world_mps_; }
  [[nodiscard]] const Quaternion& world_from_body() const { return world_from_body_; }
  [[nodiscard]] double yaw_rate_radps() const { return yaw_rate_radps_; }
  /// True if the autopilot reports a failed motor or speed controller, or a loss of thrust. For PX4
  /// the last SYS_STATUS is used, for ArduPilot a text of the last 10 s.
  [[nodiscard]] bool has_motor_fault(Time now) const;
  /// True once the autopilot has confirmed its origin. A valid position does not imply an origin.
  [[nodiscard]] bool has_origin() const { return has_origin_; }
  /// Returns the arrival time of the last message of this kind.
  [[nodiscard]] std::optional<Time> received_at(std::uint32_t message_id) const;
  /// Returns the autopilot's clock minus the local clock, ns, from the exchange with the shortest
  /// round trip.
  [[nodiscard]] std::optional<std::int64_t> clock_offset_ns() const { return clock_offset_ns_; }

  /// Returns the newest text of severity warning or worse if it arrived within the last `age`.
  [[nodiscard]] std::optional<std::string> newest_warning(Time now, Duration age) const;

 private:
  void take_heartbeat(const wire::mavlink::Heartbeat& heartbeat, Time now);
  struct Battery {
    std::optional<double> share;
    /// charge from the voltage, smoothed because propeller loads lower the voltage briefly
    std::optional<double> rest_share;
    Time time{};  ///< time of the last message with a charge
  };
  /// @param source     battery id in BATTERY_STATUS, or kSystemBattery
  /// @param voltage_v  V; voltage of the whole battery; 0: not reported
  void take_battery(int source, std::int8_t remaining_percent, double voltage_v, Time now);
  void take_timesync(const wire::mavlink::Timesync& reply, Time now);
  void take_text(const wire::mavlink::Statustext& message, Time now);

  models::AutopilotDialect dialect_;
  std::map<std::uint32_t, Time> received_at_;  ///< arrival time of the last message, by message id
  std::optional<Time> heartbeat_time_;
  std::int64_t reconnections_ = 0;
  bool is_armed_ = false;
  std::uint32_t mode_ = 0;
  std::uint8_t autopilot_ = 0;
  std::uint8_t landed_state_ = 0;
  std::optional<scenario::BatterySpec> battery_;
  std::optional<double> battery_share_;
  std::map<int, Battery>
      batteries_;  ///< batteries by source; at most 256 battery ids and SYS_STATUS
  std::optional<Time> battery_time_;
  std::uint16_t estimator_flags_ = 0;
  bool are_motors_unhealthy_ = false;  ///< according to the last SYS_STATUS
  std::optional<Time> position_time_;  ///< time of the last finite position
  Eigen::Vector3d position_world_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps_ = Eigen::Vector3d::Zero();
  Quaternion world_from_body_ = Quaternion::Identity();
  double yaw_rate_radps_ = 0.0;
  double tilt_rad_ = 0.0;
  std::optional<Time> attitude_time_;
  bool has_origin_ = false;
  std::optional<std::int64_t> clock_offset_ns_;
  std::int64_t round_trip_best_ns_ = 0;
  std::deque<AutopilotText> texts_;
  std::uint16_t text_id_ = 0;  ///< id of the text that is arriving in pieces
};

}  // namespace vantage::drivers
