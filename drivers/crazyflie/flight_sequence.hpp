#pragma once

#include <optional>
#include <string>

#include "core/time.hpp"
#include "drivers/crazyflie/link.hpp"

namespace vantage::drivers {

/// Goal of a Crazyflie.
enum class CrazyflieGoal {
  kGrounded,  ///< on the ground, motors off
  kArm,       ///< on the ground, ready to take off
  kFly,       ///< in the air, following set-points
  kLand,      ///< landing by the vehicle's high-level commander
  kKill,      ///< motors off immediately
};

/// State machine for arming, flight, landing and stop of a Crazyflie. It sends set-points and
/// commands in an order that neither locks the vehicle's motors nor stops them in the air:
///   - no set-point before the motors may run, and from then on one at each step of kFly
///   - before arming: the message "set-points end", because an old set-point locks the motors
///   - to land: set-points stop, then the command to land, then the message "set-points end"
/// A vehicle that is found flying on set-points lands, because its driver has ended.
class CrazyflieSequence {
 public:
  struct Situation {
    bool may_arm = false;  ///< all preconditions are met
    bool is_low = false;   ///< mocap shows the body on the ground
    bool is_seen = false;  ///< `height_m` is measured by mocap
    double height_m = 0.0;
    double ground_m = 0.0;  ///< m; height of the body on the ground
    double yaw_rad = 0.0;
    Time now{};
  };

  /// Sets the goal; no effect if it is unchanged.
  void set_goal(CrazyflieGoal goal);
  [[nodiscard]] CrazyflieGoal goal() const { return goal_; }
  /// Sends the due commands. Returns true if a set-point must be sent now.
  bool step(CrazyflieLink& link, const Situation& situation);

  /// True if the motors run or may start at the next set-point.
  [[nodiscard]] bool is_armed(const CrazyflieTelemetry& telemetry) const;
  /// True if the driver's set-points move the vehicle.
  [[nodiscard]] bool has_control(const CrazyflieTelemetry& telemetry) const;
  /// Returns a text that names the awaited event; nullopt if the goal is reached.
  [[nodiscard]] const std::optional<std::string>& waiting_for() const { return waiting_for_; }

 private:
  bool stay_grounded(CrazyflieLink& link, const Situation& situation);
  void arm(CrazyflieLink& link, const Situation& situation);
  bool fly(CrazyflieLink& link, const Situation& situation);
  void land(CrazyflieLink& link, const Situation& situation);
  void hand_over(CrazyflieLink& link, const Situation& situation);
  void kill(CrazyflieLink& link, Time now);
  [[nodiscard]] bool is_due(Time now, Duration period);

  CrazyflieGoal goal_ = CrazyflieGoal::kGrounded;
  Time last_sent_{};
  bool is_released_ = false;  ///< goal kArm or kFly: the vehicle may run its motors
  bool is_over_ = false;      ///< the motors have run and stopped: the goal has ended
  bool was_flying_ = false;   ///< the vehicle has reported flying since kGrounded
  std::optional<Time> landing_since_;
  bool is_landing_accepted_ = false;
  std::optional<std::string> waiting_for_;
};

}  // namespace vantage::drivers
