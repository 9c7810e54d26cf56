#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
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

inline constexpr double kPredictS = 0.1;  ///< s; longest extrapolation of this vehicle's pose

/// Result of an operator command.
enum class [[nodiscard]] CommandVerdict{
    kObeyed,  ///< obeyed, or pending until it can be obeyed; the status shows which
    kOtherRobot,
    kNotInCharge,  ///< sent by a station not in charge, which may only send hold, land and
                   ///< emergency stop
    kRefused,      ///< not possible in this state
};

/// State and functions that the guards of all vehicle types share: trusted sources, own pose,
/// course, other bodies and pending commands. The guard of a vehicle type calls
/// update_common_inputs(), steps its own ladder, and calls end_tick().
///
/// Times are those of FlightGuard. Only the constructor and count() allocate.
struct GuardCore {
  GuardCore(const scenario::Scenario& scenario, const std::string& robot, const SafetyLimits& given,
            const Course& own_course)
      : name(robot), limits(given), fleet(scenario, robot), plans(robot), course(own_course) {}

  /// Processes a mocap frame. Returns false for a publisher that is not accepted (MocapSource).
  /// While the vehicle `is_armed`, a new publisher is accepted only if its pose of the vehicle
  /// agrees with the predicted pose, as in the air.
  [[nodiscard]] bool on_mocap(const models::MocapFrame& frame, BodyContext context, bool is_armed,
                              Time now);
  /// Checks a plan for this vehicle at `height_m`. The course follows the plan if it is accepted.
  PlanVerdict on_plan(const models::RobotPlan& plan, bool may_take, double height_m, Time now);
  void on_teammate_plan(const models::RobotPlan& plan, Time now) {
    (void)fleet.on_plan(plan, limits, now);  // the fleet counts refusals
  }

  /// True if the sender of `command` may send it now; counts refusals.
  [[nodiscard]] bool admits(const models::OperatorCommand& command, Time now);
  [[nodiscard]] bool is_ours(const models::OperatorCommand& command) const {
    return command.robot.empty() || command.robot == name;
  }
  /// Executes an admitted command if it needs no check of the vehicle's state; otherwise returns
  /// nullopt.
  std::optional<CommandVerdict> execute_if_stateless(const models::OperatorCommand& command);
  /// Stores `action` for the next tick. Of several commands within one tick, the safest is stored.
  CommandVerdict request_action(models::OperatorAction action);
  CommandVerdict refuse() {
    ++commands_refused;
    return CommandVerdict::kRefused;
  }

  [[nodiscard]] double dt_s(Time now) const {
    return has_ticked ? std::max(0.0, to_seconds(now - last_tick)) : 0.0;
  }
  /// Fills the fields of `in` that all vehicle types share. An age is the time since the last
  /// message, or kNever without one.
  void update_common_inputs(Time now);
  /// Ends the tick: clears the commands that it has processed.
  void end_tick(Time now);
  void count(std::vector<models::NamedCount>& out) const;

  std::string name;
  SafetyLimits limits;
  Fleet fleet;
  PoseMonitor pose;
  MocapSource source;
  models::MocapClock clock;
  PlanGate plans;
  OperatorAuthority authority;
  Course course;
  LadderState ladder;
  SafetyInputs in;
  Reasons reasons;  ///< reasons at the last tick
  Time last_tick{};
  bool has_ticked = false;
  bool map_differs = false;
  double processor_wait_s = 0.0;  ///< s; value of the last report
  std::optional<Time> other_version_at;
  bool emergency_stop = false;
  bool is_ending = false;  ///< the driver was requested to end
  std::optional<models::OperatorAction> request;
  std::array<std::int64_t, kPoseVerdicts> pose_counts{};
  PoseVerdict pose_verdict = PoseVerdict::kAbsent;  ///< verdict on this vehicle's pose in the last
                                                    ///< accepted frame
  std::int64_t clocks_set = 0, commands_refused = 0;
};

}  // namespace vantage::drivers
