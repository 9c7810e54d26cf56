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

inline constexpr double kPredictS = 0.1;  ///< how far the own pose is carried on

/// What became of a command.
enum class [[nodiscard]] CommandVerdict{
    kObeyed,  ///< or waits until it can be: see the status
    kNotForUs,
    kNotInCharge,  ///< another station is; only hold, land and emergency stop are taken from this
                   ///< one
    kRefused,      ///< it makes no sense in this state
};

/// What the guard of every vehicle has in common, whatever moves it: whom it believes, where it is,
/// what it follows, who is around it, what it was told. A vehicle's own guard says what that means
/// for its state: it asks this, steps its ladder, and ends its tick here.
///
/// Times as FlightGuard's. Nothing but the constructor and count() allocates.
struct GuardCore {
  GuardCore(const scenario::Scenario& scenario, const std::string& robot, const SafetyLimits& given,
            const Course& own_course)
      : name(robot), limits(given), fleet(scenario, robot), plans(robot), course(own_course) {}

  /// False for a frame of a publisher that is not believed (MocapSource). One that takes over while
  /// the vehicle `is_armed` must show it where it is, as if it were in the air.
  [[nodiscard]] bool on_mocap(const models::MocapFrame& frame, BodyContext context, bool is_armed,
                              Time now);
  /// A plan for this vehicle at `height_m`; followed when it passes.
  PlanVerdict on_plan(const models::RobotPlan& plan, bool may_take, double height_m, Time now);
  void on_teammate_plan(const models::RobotPlan& plan, Time now) {
    (void)fleet.on_plan(plan, limits, now);  // counted there
  }

  /// Whether its station may say it now.
  [[nodiscard]] bool admits(const models::OperatorCommand& command, Time now);
  [[nodiscard]] bool is_ours(const models::OperatorCommand& command) const {
    return command.robot.empty() || command.robot == name;
  }
  /// Of one that is admitted: what needs no look at the vehicle's state. nullopt: the state
  /// decides.
  std::optional<CommandVerdict> obey_at_once(const models::OperatorCommand& command);
  /// Keeps it for the next tick. Of several commands within one tick the safest counts.
  CommandVerdict ask(models::OperatorAction action);
  CommandVerdict refuse() {
    ++commands_refused;
    return CommandVerdict::kRefused;
  }

  [[nodiscard]] double dt_s(Time now) const {
    return has_ticked ? std::max(0.0, to_seconds(now - last_tick)) : 0.0;
  }
  /// Fills of `in` what is the same for every vehicle; the ages are of what was heard, or kNever.
  void look(Time now);
  /// What was told has been answered.
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
  Reasons reasons;  ///< of the last tick
  Time last_tick{};
  bool has_ticked = false;
  bool map_differs = false;
  double processor_wait_s = 0.0;  ///< as last reported
  std::optional<Time> other_version_at;
  bool emergency_stop = false;
  bool is_ending = false;  ///< the driver was asked to end
  std::optional<models::OperatorAction> request;
  std::array<std::int64_t, kPoseVerdicts> pose_counts{};
  PoseVerdict pose_verdict = PoseVerdict::kAbsent;  ///< of the last frame believed
  std::int64_t clocks_set = 0, commands_refused = 0;
};

}  // namespace vantage::drivers
