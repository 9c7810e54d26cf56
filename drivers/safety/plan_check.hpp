#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/safety/limits.hpp"
#include "drivers/safety/setpoint.hpp"
#include "models/plan/plan.hpp"

// Plan check of flight safety. It shares no code with the planner: it has separate functions that
// evaluate motions and check them against obstacles.

namespace vantage::drivers {

/// Result of the check of a plan: the first value that applies, in this order.
enum class [[nodiscard]] PlanVerdict{
    kAccepted,      kWrongVehicle,
    kStale,         ///< not newer than the last accepted plan, or started too long ago
    kTooFarAhead,   ///< starts too long after now, or after an accepted plan that has not begun
    kNotFinite,     ///< a number is not finite, or a count, duration or deceleration is impossible
    kInfeasible,    ///< beyond the vehicle's speed, turn rate or braking
    kNoHover,       ///< the plan does not end stationary
    kNoLease,       ///< another planner holds the lease
    kNotFollowing,  ///< the vehicle does not accept plans now
    kDiscontinuous, kOutsideFence, kObstacle,
    kTeammate,   ///< too close to a teammate or any other body
    kTooCostly,  ///< needs more than kPathStepsMax steps to check
};
inline constexpr std::size_t kPlanVerdicts = 14;
/// Maximum number of steps of one check_path(), including those against other bodies; about 10 ms.
inline constexpr int kPathStepsMax = 50'000;

/// Returns the name used in reasons and counters.
const char* name_of(PlanVerdict verdict);

/// Plan of fixed size, so that copies do not allocate memory.
struct HeldPlan {
  static constexpr std::size_t kSegmentsMax = models::kFlownSegmentsMax;
  Time start_time{};
  Pose2 start;
  double height_m = 0.0;
  std::size_t count = 0;
  std::array<models::PlanSegment, kSegmentsMax> segments{};
};

/// Copies a trajectory. Returns false and leaves `out` unchanged if it has too many segments.
bool hold_plan(const models::Trajectory& trajectory, HeldPlan& out);
double duration_s(const HeldPlan& plan);
/// Returns the state `elapsed_s` after the start of the plan. Before the start it is the stationary
/// start state; after the end it is the hover.
Setpoint point_at(const HeldPlan& plan, double elapsed_s);
/// Returns the maximum speed of the plan within [from_s, to_s] after its start, m/s.
double speed_max_mps(const HeldPlan& plan, double from_s, double to_s);

/// Iterator over the states of one plan at ascending times, with the results of point_at(). Its
/// computing time per state is independent of the number of segments. The plan must outlive the
/// iterator.
class PlanWalk {
 public:
  explicit PlanWalk(const HeldPlan& plan);
  /// @param elapsed_s  s; time after the start; not less than in the previous call
  Setpoint at(double elapsed_s);

 private:
  const HeldPlan* plan_;
  std::size_t segment_ = 0;
  double begin_s_ = 0.0;  ///< s; start of that segment
  Setpoint begin_;        ///< state at the start of that segment
};

/// Predicted course of another body: along its plan, or straight from its position.
struct OtherCourse {
  const HeldPlan* plan = nullptr;  ///< plan of the body; nullptr: use position_world_m
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();  ///< m/s; used without a plan
  double prediction_s = 0.0;    ///< s; a moving body is predicted this long, then ignored
  bool reaches_ground = false;  ///< the space below the body counts as occupied
};

/// Checks the plan without its surroundings. Returns kAccepted, kNotFinite, kInfeasible or
/// kNoHover.
PlanVerdict check_shape(const HeldPlan& plan, const SafetyLimits& limits);
/// Checks the plan of another vehicle against that vehicle's limits.
PlanVerdict check_shape(const HeldPlan& plan, const models::VehicleLimits& can,
                        double lateral_max_mps2);
/// Checks the rest of the plan from `now` on. Returns kAccepted, or the first of kOutsideFence,
/// kObstacle, kTeammate and kTooCostly that applies. Steps are as long as the remaining distance
/// allows, but at least 1 ms: at 2 m/s a violation along less than 2 mm may be missed. `steps`, if
/// given, receives the number of steps.
PlanVerdict check_path(const HeldPlan& plan, Time now, const SafetyLimits& limits,
                       std::span<const OtherCourse> others, int* steps = nullptr);

/// Returns the exact signed distance from `p_m` to the nearest obstacle, m; negative inside, +∞
/// without obstacles.
double obstacle_distance_m(const models::World& world, const Eigen::Vector2d& p_m);
/// Returns the distance from `p_m` to the bounds, m; negative outside.
double fence_distance_m(const models::World& world, const Eigen::Vector2d& p_m);

}  // namespace vantage::drivers
