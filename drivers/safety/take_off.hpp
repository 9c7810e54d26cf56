#pragma once

#include <span>
#include <string>

#include "core/time.hpp"
#include "drivers/safety/autopilot_watch.hpp"
#include "drivers/safety/guard_core.hpp"
#include "drivers/safety/height_state.hpp"
#include "drivers/safety/lift.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Take-off of one flying vehicle: its turn among the vehicles, the first lift, and the climb to
/// the flight height.
class TakeOff {
 public:
  TakeOff(const scenario::Scenario& scenario, const std::string& robot) : queue_(scenario, robot) {}

  [[nodiscard]] LiftQueue& queue() { return queue_; }
  /// Records that the vehicle was found in the air: its first flight has begun.
  void on_found_flying() { has_flown_ = true; }
  /// Begins the first lift from the current pose.
  void begin(GuardCore& core, HeightState& height, Time now);
  /// Ends lift and climb, because the vehicle lands or is on the ground.
  void end();
  /// Advances the lift or the climb, and sets the goal of `height`.
  void step(GuardCore& core, HeightState& height, Time now);
  /// True if the climb waits for another vehicle, which climbs first.
  [[nodiscard]] bool is_waiting(GuardCore& core, const HeightState& height, Time now);
  /// Fills the inputs about the take-offs of this vehicle and of others.
  void update_inputs(GuardCore& core, const AutopilotReport& report,
                     std::span<const OtherBody> bodies, Time now);

  [[nodiscard]] bool is_lifting() const { return lift_.is_under_way(); }
  /// True from the start of the lift to the end of the climb; the autopilot may choose the climb
  /// rate.
  [[nodiscard]] bool is_climbing() const { return is_climbing_; }
  /// Returns the distance of the height `at_m` from the range between ground and goal, m.
  [[nodiscard]] double height_error_m(double at_m, double goal_m) const;

 private:
  void compare_start(GuardCore& core) const;
  void compare_lift(GuardCore& core, const AutopilotReport& report, Time now) const;

  LiftQueue queue_;
  Lift lift_;
  bool had_motors_ = false;  ///< motor state at the last tick
  /// true: the first lift was completed, or the vehicle was found in the air
  bool has_flown_ = false;
  double unarmed_height_m_ = 0.0;  ///< m; height on the ground before the motors started
  double climb_from_m_ = 0.0;
  Time climb_since_{};
  bool is_climbing_ = false;
};

}  // namespace vantage::drivers
