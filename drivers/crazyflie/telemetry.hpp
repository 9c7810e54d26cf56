#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/time.hpp"
#include "wire/crtp/system.hpp"
#include "wire/crtp/tables.hpp"

namespace vantage::drivers {

/// Variable that the driver logs, with the type in which it is sent.
struct LoggedVariable {
  const char* name;
  wire::crtp::ValueType type;
  bool is_optional = false;  ///< the vehicle may not have it
};
inline constexpr std::uint8_t kStateBlock = 1;
inline constexpr std::uint8_t kHealthBlock = 2;
inline constexpr std::uint16_t kLogPeriodMs = 50;
/// Returns the variables of a log block, in the order of their values.
std::span<const LoggedVariable> logged_variables(std::uint8_t block);

/// Newest values that a Crazyflie has reported. The age of a value is the age of its message.
class CrazyflieTelemetry {
 public:
  static constexpr Duration kFresh = std::chrono::milliseconds(500);
  /// m; a larger standard deviation of the position shows that the vehicle receives no poses. It is
  /// 2.4 mm with poses and reaches this value 1.3 s after the last pose.
  static constexpr double kSigmaMaxM = 0.03;

  /// Processes the data of a log block.
  /// @param has_battery  the block contains the battery's voltage
  void take(const wire::crtp::LogData& data, bool has_battery, Time now);
  void take_info(std::uint16_t info, Time now) {
    info_ = info;
    info_at_ = now;
  }
  /// Forgets all values, because the vehicle was disconnected.
  void forget() { *this = {}; }

  [[nodiscard]] std::optional<Time> state_at() const { return state_at_; }
  [[nodiscard]] std::optional<Time> info_at() const { return info_at_; }
  [[nodiscard]] std::optional<Time> battery_at() const { return battery_at_; }
  [[nodiscard]] bool has_state(Time now) const { return state_at_ && now - *state_at_ <= kFresh; }
  [[nodiscard]] bool has_info(Time now) const { return info_at_ && now - *info_at_ <= kFresh; }
  /// True if all `bits` of the supervisor's state are set; false before the first report.
  [[nodiscard]] bool has(unsigned bits) const { return (info_ & bits) == bits; }
  [[nodiscard]] std::uint16_t info() const { return info_; }

  [[nodiscard]] const Eigen::Vector3d& position_world_m() const { return position_world_m_; }
  [[nodiscard]] const Eigen::Vector3d& velocity_world_mps() const { return velocity_world_mps_; }
  [[nodiscard]] const Quaternion& world_from_body() const { return world_from_body_; }
  [[nodiscard]] bool has_position(Time now) const {
    return has_state(now) && position_world_m_.allFinite() && velocity_world_mps_.allFinite();
  }
  /// True if the attitude may be used. The compressed attitude cannot represent NaN, so the
  /// position is checked: it is NaN whenever the attitude is.
  [[nodiscard]] bool has_attitude(Time now) const { return has_position(now); }
  [[nodiscard]] double yaw_rate_radps() const { return yaw_rate_radps_; }
  [[nodiscard]] double tilt_rad() const;
  /// Returns the largest standard deviation of a coordinate, m; infinity if it is not known.
  [[nodiscard]] double sigma_m() const { return sigma_m_; }
  /// True if the vehicle receives poses and has a finite estimate.
  [[nodiscard]] bool is_estimate_good(Time now) const {
    return has_position(now) && has_attitude(now) && has_info(now) && sigma_m_ <= kSigmaMaxM;
  }
  /// Returns the voltage, smoothed over about 2 s, because propeller loads lower it briefly, V.
  [[nodiscard]] double battery_v() const { return battery_v_; }

 private:
  std::optional<Time> state_at_, info_at_, battery_at_;
  Eigen::Vector3d position_world_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps_ = Eigen::Vector3d::Zero();
  Quaternion world_from_body_ = Quaternion::Identity();
  double yaw_rate_radps_ = 0.0;
  double sigma_m_ = std::numeric_limits<double>::infinity();
  double battery_v_ = 0.0;
  std::uint16_t info_ = 0;
};

}  // namespace vantage::drivers
