#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/safety/authority.hpp"
#include "drivers/safety/course.hpp"
#include "drivers/safety/fleet.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/ladder.hpp"
#include "drivers/safety/limits.hpp"
#include "drivers/safety/mocap_source.hpp"
#include "drivers/safety/plan_gate.hpp"
#include "drivers/safety/pose_monitor.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/mocap_clock.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

inline constexpr double kPredictS = 0.1;   ///< s; longest extrapolation of this vehicle's pose
inline constexpr double kMovingMps = 0.1;  ///< m/s; a vehicle with a faster command is moving

/// Result of an operator command.
enum class [[nodiscard]] CommandVerdict{
    kObeyed,  ///< obeyed, or pending until it can be obeyed; the status shows which
    kOtherRobot,
    /// sent by a station not in charge, which may only send hold, land and emergency stop
    kNotInCharge,
    kRefused,  ///< not possible in this state
};

/// Properties that differ between vehicle types.
struct VehicleTraits {
  std::span<const Condition> conditions;  ///< table of the vehicle type
  /// True: the vehicle is on its course if its 3D position agrees, and it continues its plan for
  /// pose_age_land_s without a pose. False: the vehicle has no height control, and it continues its
  /// plan for pose_age_hold_s without a pose.
  bool flies = true;
};

/// State and functions that the guards of all vehicle types share: trusted sources, own pose,
/// course, braking path, admission of plans, other bodies, pending commands and status. At each
/// tick the guard of a vehicle type advances course(), calls update_common_inputs(), fills the
/// other inputs(), sets the result of its ladder, and calls end_tick().
///
/// Times are those of FlightGuard. Only the constructor, status() and count() allocate.
class GuardCore {
 public:
  GuardCore(const scenario::Scenario& scenario, const std::string& robot,
            const SafetyLimits& limits, const VehicleTraits& traits, const Course& course)
      : name_(robot),
        limits_(limits),
        traits_(traits),
        fleet_(scenario, robot),
        plans_(robot),
        course_(course) {}

  /// Processes a mocap frame. Returns false for a publisher that is not accepted (MocapSource).
  /// While the vehicle `is_armed`, even on the ground, a new publisher is accepted only if its pose
  /// of the vehicle agrees with the predicted pose.
  /// @param pose_sigma_m  1σ of the vehicle's pose if motion capture does not see the vehicle and
  ///                      `frame` contains an estimate instead (POSE_R); 0: motion capture. The
  ///                      estimate is ignored without moves_by_estimate
  [[nodiscard]] bool on_mocap(const models::MocapFrame& frame, BodyContext context, bool is_armed,
                              Time now, double pose_sigma_m = 0.0);
  /// Checks a plan for this vehicle at `height_m`. The course follows the plan if it is accepted.
  PlanVerdict on_plan(const models::RobotPlan& plan, bool may_take, double height_m, Time now);
  void on_teammate_plan(const models::RobotPlan& plan, Time now) {
    (void)fleet_.on_plan(plan, limits_, now);  // the fleet counts refusals
  }
  void on_teammate_status(const std::string& robot, Time now) { fleet_.on_status(robot, now); }
  void on_map(bool is_same) { map_differs_ = !is_same; }
  void on_processor_wait(double wait_s) { processor_wait_s_ = wait_s; }
  void on_end_request() { is_ending_ = true; }
  void on_other_version(Time now) { other_version_at_ = now; }

  /// True if the sender of `command` may send it now; counts refusals.
  [[nodiscard]] bool admits(const models::OperatorCommand& command, Time now);
  [[nodiscard]] bool is_ours(const models::OperatorCommand& command) const {
    return command.robot.empty() || command.robot == name_;
  }
  /// Executes an admitted command if it needs no check of the vehicle's state; otherwise returns
  /// nullopt.
  std::optional<CommandVerdict> execute_if_stateless(const models::OperatorCommand& command);
  /// Stores `action` for the next tick. Of several commands within one tick, the safest is stored.
  CommandVerdict request_action(models::OperatorAction action);
  CommandVerdict refuse() {
    ++commands_refused_;
    return CommandVerdict::kRefused;
  }

  /// Returns the time since the last tick, s; 0 at the first.
  [[nodiscard]] double dt_s(Time now) const {
    return has_ticked_ ? std::max(0.0, to_seconds(now - last_tick_)) : 0.0;
  }
  /// Fills the inputs that all vehicle types share. An age is the time since the last message, or
  /// kNever without one.
  void update_common_inputs(Time now);
  /// Measures the distances to fence, obstacles and `bodies`, once a pose was accepted.
  void update_surroundings(std::span<const OtherBody> bodies, Time now);
  void set_ladder(const LadderState& ladder) { ladder_ = ladder; }
  /// Returns the conditions that act; when idle, those that forbid arming.
  [[nodiscard]] Reasons acting_conditions() const;
  /// Ends the tick: stores its reasons for the status, and clears the commands that it has
  /// processed. Returns true if the reasons differ from those of the last tick.
  [[nodiscard]] bool end_tick(const Reasons& reasons, Time now);

  /// True if the vehicle follows plans, or waits only for a plan.
  [[nodiscard]] bool may_take_plans() const;
  /// Returns the path on which the vehicle brakes after `reaction_s`. The path follows the plan if
  /// the vehicle keeps to it, and is straight at the measured velocity otherwise.
  [[nodiscard]] BrakingPath braking_path(Time now, double reaction_s) const;

  [[nodiscard]] const SafetyLimits& limits() const { return limits_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const PoseMonitor& pose() const { return pose_; }
  /// Returns the position extrapolated to `now`, at most by kPredictS.
  [[nodiscard]] Eigen::Vector3d position_m(Time now) const {
    return pose_.predict_m(now, kPredictS);
  }
  /// Returns the verdict about this vehicle's pose in the last accepted frame.
  [[nodiscard]] PoseVerdict pose_verdict() const { return pose_verdict_; }
  /// Returns the capture time of the last accepted frame, by the local clock.
  [[nodiscard]] Time captured() const { return clock_.captured(); }
  [[nodiscard]] Course& course() { return course_; }
  [[nodiscard]] const Course& course() const { return course_; }
  /// Returns the other bodies, extrapolated to `now`. Valid until the next call.
  [[nodiscard]] std::span<const OtherBody> bodies(Time now) { return fleet_.bodies(now, limits_); }
  [[nodiscard]] const LadderState& ladder() const { return ladder_; }
  [[nodiscard]] models::FlightState state() const { return ladder_.state; }
  [[nodiscard]] SafetyInputs& inputs() { return in_; }
  [[nodiscard]] const SafetyInputs& inputs() const { return in_; }
  /// Returns the reasons at the last tick.
  [[nodiscard]] const Reasons& reasons() const { return reasons_; }

  /// Returns the status for VEHICLE_R with the commanded position on the course; `details` follow
  /// the names of the reasons. The caller sets the height.
  [[nodiscard]] models::VehicleStatus status(Time now,
                                             const std::vector<std::string>& details) const;
  void count(std::vector<models::NamedCount>& out) const;

 private:
  [[nodiscard]] bool keeps_to_course(Time now) const;
  [[nodiscard]] bool has_planned_speed(Time now) const;

  std::string name_;
  SafetyLimits limits_;
  VehicleTraits traits_;
  Fleet fleet_;
  PoseMonitor pose_;
  MocapSource source_;
  models::MocapClock clock_;
  PlanGate plans_;
  OperatorAuthority authority_;
  Course course_;
  LadderState ladder_;
  SafetyInputs in_;
  Reasons reasons_;
  Time last_tick_{};
  bool has_ticked_ = false;
  bool map_differs_ = false;
  double processor_wait_s_ = 0.0;  ///< s; value of the last report
  std::optional<Time> other_version_at_;
  bool emergency_stop_ = false;
  bool is_ending_ = false;  ///< the driver received a request to end
  std::optional<models::OperatorAction> request_;
  std::array<std::int64_t, kPoseVerdicts> pose_counts_{};
  PoseVerdict pose_verdict_ = PoseVerdict::kAbsent;
  double pose_sigma_m_ = 0.0;  ///< m; 1σ of the last accepted pose; 0: from motion capture
  std::int64_t estimates_used_ = 0;
  std::int64_t estimates_refused_ = 0;
  std::int64_t clocks_set_ = 0;
  std::int64_t commands_refused_ = 0;
};

}  // namespace vantage::drivers
