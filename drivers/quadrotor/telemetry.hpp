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

/// Text that an autopilot wrote, whole.
struct AutopilotText {
  Time time{};
  int severity = 7;  ///< 0 emergency … 7 debug
  std::string text;
};

/// What one autopilot says of itself. Everything is as old as its message: who uses it looks at
/// the times.
class Telemetry {
 public:
  /// @param battery  when its charge is to be known by its voltage
  explicit Telemetry(models::AutopilotDialect dialect,
                     const std::optional<scenario::BatterySpec>& battery = std::nullopt)
      : dialect_(dialect), battery_(battery) {}

  /// Takes a frame of the vehicle.
  void take(const wire::mavlink::Frame& frame, Time now);

  /// A HEARTBEAT within the last 2.5 s: two were missed otherwise.
  [[nodiscard]] bool is_connected(Time now) const;
  [[nodiscard]] bool is_armed() const { return is_armed_; }
  [[nodiscard]] std::uint32_t mode() const { return mode_; }
  [[nodiscard]] std::uint8_t autopilot() const { return autopilot_; }
  [[nodiscard]] std::optional<Time> heartbeat_time() const { return heartbeat_time_; }
  /// Heartbeats after a silence: the vehicle or its link was away, and may have forgotten.
  [[nodiscard]] std::int64_t reconnections() const { return reconnections_; }

  /// As EXTENDED_SYS_STATE says; true without one while disarmed.
  [[nodiscard]] bool is_on_ground() const;
  /// Returns the lowest charge of all batteries that were reported in the last 10 s, in [0, 1];
  /// nullopt before one is known. With a BatterySpec the charge of each is the lower of the
  /// autopilot's count and the voltage: ArduPilot counts from full at each start.
  [[nodiscard]] std::optional<double> battery_share() const { return battery_share_; }
  /// When a charge was reported last; a battery message without a charge does not count.
  [[nodiscard]] std::optional<Time> battery_time() const { return battery_time_; }
  [[nodiscard]] std::optional<std::uint16_t> estimator_flags(Time now) const;
  /// Its own estimate, world frame, if it is of the last half second.
  [[nodiscard]] std::optional<Eigen::Vector3d> position_world_m(Time now) const;
  /// True if an attitude in finite numbers came in the last half second.
  [[nodiscard]] bool has_attitude(Time now) const;
  /// Of its z axis from the vertical, by its own attitude.
  [[nodiscard]] double tilt_rad() const { return tilt_rad_; }
  /// Its own estimates, world frame; meaningless before they were heard.
  [[nodiscard]] const Eigen::Vector3d& velocity_world_mps() const { return velocity_world_mps_; }
  [[nodiscard]] const Quaternion& world_from_body() const { return world_from_body_; }
  [[nodiscard]] double yaw_rate_radps() const { return yaw_rate_radps_; }
  /// True if the autopilot reported a motor or its speed controller as failed, or a loss of thrust,
  /// and has not withdrawn it. PX4: in the last SYS_STATUS; ArduPilot: a text of the last 10 s.
  [[nodiscard]] bool has_motor_fault(Time now) const;
  /// It has said so; that it knows its place is no sign of it.
  [[nodiscard]] bool has_origin() const { return has_origin_; }
  /// When a message of this kind was last heard.
  [[nodiscard]] std::optional<Time> heard(std::uint32_t message_id) const;
  /// Its clock minus ours, ns; of the exchange with the shortest round trip so far.
  [[nodiscard]] std::optional<std::int64_t> clock_offset_ns() const { return clock_offset_ns_; }

  /// The newest text of warning or worse, if it came in the last `age`.
  [[nodiscard]] std::optional<std::string> newest_warning(Time now, Duration age) const;
  [[nodiscard]] const std::deque<AutopilotText>& texts() const { return texts_; }

 private:
  void take_heartbeat(const wire::mavlink::Heartbeat& heartbeat, Time now);
  struct Battery {
    std::optional<double> share;
    std::optional<double>
        rest_share;  ///< by voltage, smoothed: propellers pull it down for moments
    Time time{};     ///< of the last message with a charge
  };
  /// @param source     its id in BATTERY_STATUS, or kSystemBattery
  /// @param voltage_v  of the whole battery; 0: not reported
  void take_battery(int source, std::int8_t remaining_percent, double voltage_v, Time now);
  void take_timesync(const wire::mavlink::Timesync& reply, Time now);
  void take_text(const wire::mavlink::Statustext& message, Time now);

  models::AutopilotDialect dialect_;
  std::map<std::uint32_t, Time> heard_;  ///< by message id; only those that are understood
  std::optional<Time> heartbeat_time_;
  std::int64_t reconnections_ = 0;
  bool is_armed_ = false;
  std::uint32_t mode_ = 0;
  std::uint8_t autopilot_ = 0;
  std::uint8_t landed_state_ = 0;
  std::optional<scenario::BatterySpec> battery_;
  std::optional<double> battery_share_;
  std::map<int, Battery> batteries_;  ///< by source: at most 256 ids and SYS_STATUS
  std::optional<Time> battery_time_;
  std::uint16_t estimator_flags_ = 0;
  bool are_motors_unhealthy_ = false;  ///< by the last SYS_STATUS
  std::optional<Time> position_time_;  ///< of the last position in finite numbers
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
  std::uint16_t text_id_ = 0;  ///< of the text that is coming in pieces
};

}  // namespace vantage::drivers
