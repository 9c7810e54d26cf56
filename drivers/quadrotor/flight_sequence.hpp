#pragma once

#include <optional>
#include <string>

#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"

namespace vantage::drivers {

/// What is wanted of a vehicle.
enum class FlightGoal {
  kRest,  ///< on the ground, motors off
  kArm,   ///< on the ground, motors on
  kFly,   ///< in the air, following set-points
  kLand,
  kKill,  ///< motors off at once, wherever it is
};

/// The steps from the ground into the air and back: which command is due, and whether set-points
/// are. The autopilot's own heartbeat is the truth; acknowledgements only end waiting.
///
/// It takes the mode once for each goal. When the autopilot leaves the mode later (a pilot's
/// switch, a failsafe), that is reported and not fought. From a pilot who flies by hand no goal
/// takes it, but an operator (retake_mode()). Motors that stop by themselves are not started again.
class FlightSequence {
 public:
  explicit FlightSequence(models::AutopilotDialect dialect)
      : traits_(traits_of(dialect)), dialect_(dialect) {}

  /// A goal that is set already goes on.
  void set_goal(FlightGoal goal);
  /// Takes the mode once more, because an operator asks for it.
  void retake_mode() { has_mode_ = is_mode_lost_ = was_ours_ = false; }
  [[nodiscard]] FlightGoal goal() const { return goal_; }

  struct Situation {
    bool may_arm = false;            ///< every precondition holds
    double take_off_height_m = 1.0;  ///< above where it stands
    bool is_low = false;             ///< it has not lifted, seen from outside
    double height_error_m = 0.0;     ///< of the body to the height it climbs to, ≥ 0
    bool is_landing = false;         ///< a climb under way is not waited for
    bool is_flying = false;  ///< flight safety knows that it flies, whatever its heartbeat says
    Time now{};
  };
  /// Has the due command sent. Returns whether set-points are to be streamed now.
  bool step(AutopilotLink& link, const Situation& situation);

  /// The height has been reached since take-off.
  [[nodiscard]] bool has_climbed() const { return has_climbed_; }
  /// The autopilot left the mode that the goal needs, by itself or by a pilot.
  [[nodiscard]] bool is_mode_lost() const { return is_mode_lost_; }
  /// The motors stopped after they had run: the goal has come to its end.
  [[nodiscard]] bool is_over() const { return is_over_; }
  /// What it is waiting for, in words; nullopt when the goal is reached.
  [[nodiscard]] std::optional<std::string> waiting_for() const { return waiting_for_; }

 private:
  bool rest(AutopilotLink& link, Time now);
  bool prepare(AutopilotLink& link, const Situation& situation);
  bool fly(AutopilotLink& link, const Situation& situation);
  bool land(AutopilotLink& link, Time now, bool is_armed);
  void kill(AutopilotLink& link, Time now);
  void disarm_on_ground(AutopilotLink& link, Time now, Duration after);
  void come_into_mode();
  [[nodiscard]] bool is_pilots(std::uint32_t mode) const;

  const DialectTraits& traits_;
  models::AutopilotDialect dialect_;
  FlightGoal goal_ = FlightGoal::kRest;
  std::optional<Time> streaming_since_;
  std::optional<Time> on_ground_since_;
  std::optional<Time> left_since_;  ///< armed in the air, and nobody's
  std::optional<Time> kill_since_;
  bool was_armed_ = false;
  bool has_climbed_ = false;
  bool has_mode_ = false;  ///< that of the goal
  bool was_ours_ = false;  ///< that of some goal since it rested, or an operator asked for it
  bool is_mode_lost_ = false;
  bool is_over_ = false;
  std::optional<std::string> waiting_for_;
};

}  // namespace vantage::drivers
