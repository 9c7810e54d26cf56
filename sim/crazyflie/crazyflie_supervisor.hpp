#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace vantage::sim {

/// State of the vehicle that the supervisor judges.
struct SupervisedFacts {
  bool are_motors_running = false;
  double tilt_rad = 0.0;
  /// s; age of the low-level set-point; absent if the high-level commander has control
  std::optional<double> setpoint_age_s;
};

/// Supervisor of an emulated Crazyflie: arming, flight state, locking and crashes. Its times are
/// those measured with firmware 2026.08; it runs at 25 Hz.
class CrazyflieSupervisor {
 public:
  static constexpr double kLevelsS = 0.5;  ///< s; set-point age from which the vehicle flies level
  static constexpr double kLocksS = 2.0;   ///< s; set-point age at which the motors stop

  /// @param arms_itself  true for vehicles with brushed motors
  explicit CrazyflieSupervisor(bool arms_itself)
      : arms_itself_(arms_itself), is_armed_(arms_itself) {}

  /// Arms or disarms the vehicle. Returns true if the command was accepted.
  bool arm(bool is_to_arm, Time now);
  bool recover();
  void stop(Time now);
  void feed_watchdog(Time now) { watchdog_ = now; }

  /// Advances to `now`. Call it at each control step.
  void step(const SupervisedFacts& facts, Time now);

  [[nodiscard]] bool may_run_motors() const {
    return is_armed_ && can_fly_ && !stopped_at_ && !is_locked_ && !is_crashed_;
  }
  [[nodiscard]] bool can_fly() const { return can_fly_; }
  [[nodiscard]] bool is_flying() const { return is_flying_; }
  [[nodiscard]] bool is_locked() const { return is_locked_; }
  /// Returns the bits of wire::crtp::info, except the bits of the high-level commander.
  [[nodiscard]] std::uint16_t bits() const;

 private:
  static constexpr Duration kPeriod{40'000};
  void judge(const SupervisedFacts& facts, Time now);

  bool arms_itself_;
  bool is_armed_;
  bool can_fly_ = false;
  bool is_flying_ = false;
  bool is_tumbled_ = false;
  bool is_locked_ = false;
  bool is_crashed_ = false;
  Time next_{};
  std::optional<Time> thrust_at_;  ///< last time with running motors
  std::optional<Time> armed_at_;
  std::optional<Time> landed_at_;
  std::optional<Time> over_at_;    ///< time since which the vehicle is upside down
  std::optional<Time> tilted_at_;  ///< time since which the vehicle is tilted by more than 60°
  std::optional<Time> upright_at_;
  std::optional<Time> stopped_at_;  ///< time of the emergency stop
  std::optional<Time> watchdog_;
};

}  // namespace vantage::sim
