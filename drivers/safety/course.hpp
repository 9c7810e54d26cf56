#pragma once

#include <Eigen/Core>

#include "core/time.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/plan_check.hpp"

namespace vantage::drivers {

/// The way from being told to stop to standing still, as a closed form of time: flown on for the
/// reaction time, then slowed at the brake's deceleration, along the checked plan or straight.
class BrakeWay {
 public:
  BrakeWay() = default;
  /// Along `plan` from `elapsed_s` after its start; places shifted by `offset_m`.
  static BrakeWay along(const HeldPlan& plan, double elapsed_s, double brake_mps2,
                        double reaction_s, const Eigen::Vector3d& offset_m);
  /// Straight on from `position_m` at `velocity_mps`.
  static BrakeWay straight(const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_mps,
                           double yaw_rad, double brake_mps2, double reaction_s);

  /// `t_s` after it began; at rest from duration_s() on.
  [[nodiscard]] PlanPoint at(double t_s) const;
  [[nodiscard]] double duration_s() const { return reaction_s_ + brake_s_; }

 private:
  bool is_along_ = false;
  HeldPlan plan_;
  double elapsed_s_ = 0.0;
  Eigen::Vector3d offset_m_ = Eigen::Vector3d::Zero();
  PlanPoint start_;
  double reaction_s_ = 0.0;
  double brake_s_ = 0.0;
};

/// What one vehicle is asked to fly in the plane: a plan and the one to follow it, or a stop and
/// the hover after it, or a shift from one hover to the next. Heights are not its business.
///
/// Plans change their speed at once, which nothing that flies can do. What is asked is therefore
/// the mean of the planned places within `half_window_s` before and after: it begins to slow before
/// the plan does, its velocity and acceleration are differences of planned places, and the speed v
/// changes within the window, at v / (2 half_window_s). It cuts a corner of speeds by at most
/// v half_window_s / 4, and a circle's radius by the factor sin(ω half_window_s)/(ω half_window_s).
///
/// What a plan says beyond its round will most likely be taken back by the next one, which comes at
/// the last moment: until that has come or should have, the way is taken to go straight on from
/// there. Without it a turn that the next plan turns round was begun 0.35 s too soon.
class Course {
 public:
  /// @param round_s  after which the next plan takes over; 0: plans are believed to their end
  explicit Course(double half_window_s, double round_s = 0.0)
      : half_window_s_(half_window_s), round_s_(round_s) {}

  /// Stands at a place.
  void stand(const Eigen::Vector3d& position_m, double yaw_rad, Time now);
  /// Puts a checked plan on the course, from its start time on.
  void follow(const HeldPlan& plan, Time now);
  /// Forgets a plan that has not begun.
  void forget_next() { has_next_ = false; }
  /// Stops from what it is doing, and forgets every plan.
  void stop(const BrakeWay& way, Time now);
  /// After a stop: moves its hover to `to_m` at `speed_mps`, from rest to rest.
  void shift(const Eigen::Vector3d& to_m, double speed_mps, Time now);
  /// Time goes on by `dt_s`; the plan's own clock at `rate` of it, in [0, 1].
  void advance(Time now, double dt_s, double rate);

  [[nodiscard]] PlanPoint at(Time time) const { return smoothed_at(time, lag_s_); }
  /// The same as if the plan's clock had never been slowed.
  [[nodiscard]] PlanPoint on_time(Time time) const { return smoothed_at(time, 0.0); }
  /// What the plan itself says, with its jumps.
  [[nodiscard]] PlanPoint planned_at(Time time) const { return planned_at(time, lag_s_); }
  /// True while a plan is being flown that has not come to its hover.
  [[nodiscard]] bool has_plan(Time now) const;
  /// A stop or shift is over.
  [[nodiscard]] bool is_standing(Time now) const;
  [[nodiscard]] bool is_on_plan() const { return mode_ == Mode::kPlan; }
  /// Fills what `inputs` says of a plan on the course.
  void report(Time now, SafetyInputs& inputs) const {
    inputs.has_plan = is_on_plan();
    inputs.plan_ended = !has_plan(now);
  }
  [[nodiscard]] const HeldPlan& plan() const { return plan_; }
  [[nodiscard]] double elapsed_s(Time now) const;
  [[nodiscard]] bool has_next() const { return has_next_; }

 private:
  enum class Mode { kStand, kPlan, kBrake, kShift };
  void begin(const HeldPlan& plan);
  [[nodiscard]] PlanPoint planned_at(Time time, double lag_s) const;
  [[nodiscard]] PlanPoint smoothed_at(Time time, double lag_s) const;

  [[nodiscard]] PlanPoint on_plan(double elapsed_s) const;

  double half_window_s_;
  double round_s_;
  Time now_{};  ///< of the last advance()
  Mode mode_ = Mode::kStand;
  Time begin_{};
  PlanPoint from_;  ///< of kStand and kShift
  Eigen::Vector3d to_m_ = Eigen::Vector3d::Zero();
  double shift_mps_ = 0.0;
  BrakeWay way_;
  HeldPlan plan_;
  double lag_s_ = 0.0;
  bool has_next_ = false;
  HeldPlan next_;
  bool has_past_ = false;
  HeldPlan past_;  ///< flown before plan_, with no stop between
  double past_lag_s_ = 0.0;
};

}  // namespace vantage::drivers
