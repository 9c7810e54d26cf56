#pragma once

#include <optional>
#include <string>

#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"

namespace vantage::drivers {

/// Goal of a vehicle.
enum class FlightGoal {
  kGrounded,  ///< on the ground, motors off
  kArm,       ///< on the ground, motors on
  kFly,       ///< in the air, following set-points
  kLand,
  kKill,  ///< motors off immediately, in any state
};

/// State machine for arming, take-off, flight and landing. It decides which command is due and
/// whether set-points are sent. Its state follows the autopilot's heartbeat; acknowledgements only
/// end the repetition of commands.
///
/// It requests the autopilot's mode once for each goal. If the autopilot leaves the mode later (a
/// pilot's switch, a failsafe), the loss is reported and not reversed. Only an operator can take
/// control from a pilot (retake_mode()). Motors that the autopilot stopped are not started again.
class FlightSequence {
 public:
  explicit FlightSequence(models::AutopilotDialect dialect)
      : traits_(traits_of(dialect)), dialect_(dialect) {}

  /// Sets the goal; no effect if the goal is unchanged.
  void set_goal(FlightGoal goal);
  /// Requests the mode once more, after an operator's command.
  void retake_mode() { has_mode_ = is_mode_lost_ = had_mode_ = false; }
  [[nodiscard]] FlightGoal goal() const { return goal_; }

  struct Situation {
    bool may_arm = false;            ///< all preconditions are met
    double take_off_height_m = 1.0;  ///< m; height above the ground position
    bool is_low = false;             ///< according to mocap, the vehicle has not lifted off
    /// m, ≥ 0; distance of the body from the goal height of the climb
    double height_error_m = 0.0;
    bool is_landing = false;  ///< landing: the sequence does not wait for a climb
    /// the vehicle is flying according to flight safety, regardless of its heartbeat
    bool is_flying = false;
    Time now{};
  };
  /// Sends the due command. Returns true if set-points are to be sent now.
  bool step(AutopilotLink& link, const Situation& situation);

  /// True if the goal height was reached since take-off.
  [[nodiscard]] bool has_climbed() const { return has_climbed_; }
  /// True if the autopilot left the mode that the goal requires, for example by a failsafe or a
  /// pilot's switch.
  [[nodiscard]] bool is_mode_lost() const { return is_mode_lost_; }
  /// Returns a text that names the awaited event; nullopt if the goal is reached.
  [[nodiscard]] std::optional<std::string> waiting_for() const { return waiting_for_; }

 private:
  bool stay_grounded(AutopilotLink& link, Time now);
  bool prepare(AutopilotLink& link, const Situation& situation);
  bool fly(AutopilotLink& link, const Situation& situation);
  bool land(AutopilotLink& link, Time now, bool is_armed);
  void kill(AutopilotLink& link, Time now);
  void disarm_on_ground(AutopilotLink& link, Time now, Duration after);
  void come_into_mode();
  [[nodiscard]] bool is_pilots(std::uint32_t mode) const;

  const DialectTraits& traits_;
  models::AutopilotDialect dialect_;
  FlightGoal goal_ = FlightGoal::kGrounded;
  std::optional<Time> streaming_since_;
  std::optional<Time> on_ground_since_;
  std::optional<Time> left_since_;  ///< start of an armed flight that this driver has not commanded
  std::optional<Time> kill_since_;
  bool was_armed_ = false;
  bool has_climbed_ = false;
  bool has_mode_ = false;  ///< true: the mode that the goal requires was reached
  /// true: the mode of any goal was reached since kGrounded or retake_mode()
  bool had_mode_ = false;
  bool is_mode_lost_ = false;
  bool is_over_ = false;  ///< the motors have run and stopped: the goal has ended
  std::optional<std::string> waiting_for_;
};

}  // namespace vantage::drivers
