#pragma once

#include <Eigen/Core>

#include "core/time.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/plan_check.hpp"

namespace vantage::drivers {

/// Path from the stop command to standstill, in closed form, along the checked plan or straight.
/// The speed is constant for the reaction time, then decreases at the given deceleration.
class BrakingPath {
 public:
  BrakingPath() = default;
  /// Returns the path along `plan` from `elapsed_s` after the plan's start; positions are shifted
  /// by `offset_m`.
  static BrakingPath along(const HeldPlan& plan, double elapsed_s, double brake_mps2,
                           double reaction_s, const Eigen::Vector3d& offset_m);
  /// Returns the straight path from `position_m` with initial velocity `velocity_mps`.
  static BrakingPath straight(const Eigen::Vector3d& position_m,
                              const Eigen::Vector3d& velocity_mps, double yaw_rad,
                              double brake_mps2, double reaction_s);

  /// Returns the state `t_s` after the start of the path; the vehicle is stationary from
  /// duration_s() on.
  [[nodiscard]] Setpoint at(double t_s) const;
  [[nodiscard]] double duration_s() const { return reaction_s_ + brake_s_; }

 private:
  bool is_along_ = false;
  HeldPlan plan_;
  double elapsed_s_ = 0.0;
  Eigen::Vector3d offset_m_ = Eigen::Vector3d::Zero();
  Setpoint start_;
  double reaction_s_ = 0.0;
  double brake_s_ = 0.0;
};

/// Commanded horizontal motion of one vehicle: a plan and its successor, a stop with the hover
/// after it, or a shift from one hover to another. The course contains no heights.
///
/// The speed of a plan changes instantaneously, but a vehicle's cannot. The course therefore
/// commands the mean of the planned positions within ± `half_window_s`. The course begins to slow
/// before the plan does. Its velocity and acceleration are differences of planned positions: a stop
/// from speed v becomes a deceleration of v / (2 half_window_s). The mean deviates from the plan by
/// at most v half_window_s / 4 at a change of speed, and scales a circle's radius by sin(ω
/// half_window_s)/(ω half_window_s).
///
/// A plan is usually flown only for one round: the next plan arrives shortly before the end of the
/// round and replaces the rest. Until the next plan has arrived or is due, the course extrapolates
/// straight from the end of the round. Otherwise the course could, 0.35 s before this end, begin a
/// turn that the next plan reverses.
class Course {
 public:
  /// @param half_window_s  s; half the averaging window; 0: no averaging
  /// @param round_s  s; time after which the next plan replaces a plan; 0: plans are flown to their
  /// end
  explicit Course(double half_window_s, double round_s = 0.0)
      : half_window_s_(half_window_s), round_s_(round_s) {}

  /// Hovers at `position_m`.
  void hover(const Eigen::Vector3d& position_m, double yaw_rad, Time now);
  /// Follows a checked plan from its start time on.
  void follow(const HeldPlan& plan, Time now);
  /// Drops the next plan if it has not begun.
  void forget_next() { has_next_ = false; }
  /// Stops along `path` and drops all plans.
  void stop(const BrakingPath& path, Time now);
  /// Moves the hover after a stop to `to_m` at `speed_mps`; the motion starts and ends at zero
  /// speed.
  void shift(const Eigen::Vector3d& to_m, double speed_mps, Time now);
  /// Advances by `dt_s`. The time within the plan advances by `rate` · `dt_s`, with rate in [0, 1].
  void advance(Time now, double dt_s, double rate);

  [[nodiscard]] Setpoint at(Time time) const { return smoothed_at(time, lag_s_); }
  /// Returns the commanded state without the slow-down by `rate`.
  [[nodiscard]] Setpoint on_time(Time time) const { return smoothed_at(time, 0.0); }
  /// Returns the planned state, without averaging.
  [[nodiscard]] Setpoint planned_at(Time time) const { return planned_at(time, lag_s_); }
  /// True while the course follows a plan that has not reached its hover.
  [[nodiscard]] bool has_plan(Time now) const;
  /// True if the course hovers and any stop or shift is complete.
  [[nodiscard]] bool is_hovering(Time now) const;
  [[nodiscard]] bool is_on_plan() const { return mode_ == Mode::kPlan; }
  /// Fills the fields of `inputs` that describe the current plan.
  void report(Time now, SafetyInputs& inputs) const {
    inputs.has_plan = is_on_plan();
    inputs.plan_ended = !has_plan(now);
  }
  [[nodiscard]] const HeldPlan& plan() const { return plan_; }
  [[nodiscard]] double elapsed_s(Time now) const;
  [[nodiscard]] bool has_next() const { return has_next_; }

 private:
  enum class Mode { kHover, kPlan, kBrake, kShift };
  void begin(const HeldPlan& plan);
  [[nodiscard]] Setpoint planned_at(Time time, double lag_s) const;
  [[nodiscard]] Setpoint smoothed_at(Time time, double lag_s) const;

  [[nodiscard]] Setpoint on_plan(double elapsed_s) const;

  double half_window_s_;
  double round_s_;
  Time now_{};  ///< time of the last advance()
  Mode mode_ = Mode::kHover;
  Time begin_{};
  Setpoint from_;  ///< hover, or start of the shift (kHover, kShift)
  Eigen::Vector3d to_m_ = Eigen::Vector3d::Zero();
  double shift_mps_ = 0.0;
  BrakingPath path_;
  HeldPlan plan_;
  double lag_s_ = 0.0;
  bool has_next_ = false;
  HeldPlan next_;
  bool has_past_ = false;
  HeldPlan past_;  ///< plan flown before plan_, without a stop between them
  double past_lag_s_ = 0.0;
};

}  // namespace vantage::drivers
