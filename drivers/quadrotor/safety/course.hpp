#pragma once

#include <Eigen/Core>

#include "core/time.hpp"
#include "drivers/quadrotor/safety/plan_check.hpp"

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
class Course {
 public:
  /// Stands at a place.
  void stand(const Eigen::Vector3d& position_m, double yaw_rad, Time now);
  /// Puts a checked plan on the course, from its start time on.
  void follow(const HeldPlan& plan, Time now);
  /// Stops from what it is doing, and forgets every plan.
  void stop(const BrakeWay& way, Time now);
  /// After a stop: moves its hover to `to_m` at `speed_mps`.
  void shift(const Eigen::Vector3d& to_m, double speed_mps, Time now);
  /// Time goes on by `dt_s`; the plan's own clock at `rate` of it, in [0, 1].
  void advance(Time now, double dt_s, double rate);

  [[nodiscard]] PlanPoint at(Time time) const;
  /// The same as if the plan's clock had never been slowed.
  [[nodiscard]] PlanPoint on_time(Time time) const;
  /// True while a plan is being flown that has not come to its hover.
  [[nodiscard]] bool has_plan(Time now) const;
  /// A stop or shift is over.
  [[nodiscard]] bool is_standing(Time now) const;
  [[nodiscard]] bool is_on_plan() const { return mode_ == Mode::kPlan; }
  [[nodiscard]] const HeldPlan& plan() const { return plan_; }
  [[nodiscard]] double elapsed_s(Time now) const;
  [[nodiscard]] bool has_next() const { return has_next_; }

 private:
  enum class Mode { kStand, kPlan, kBrake, kShift };
  void begin(const HeldPlan& plan);

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
};

}  // namespace vantage::drivers
