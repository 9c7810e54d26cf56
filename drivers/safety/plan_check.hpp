#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/safety/limits.hpp"
#include "models/plan/plan.hpp"

// The plan check of flight safety. It shares no code path with the search: motions are evaluated
// by their own closed form and swept by their own method over the obstacles themselves.

namespace vantage::drivers {

/// What became of a plan. The first that applies, in this order.
enum class [[nodiscard]] PlanVerdict{
    kAccepted,      kWrongVehicle,
    kStale,         ///< not newer than the one accepted, or starts too long ago
    kTooFarAhead,   ///< of now, or of one that has been accepted and has not begun
    kNotFinite,     ///< or a count, duration or deceleration that cannot be
    kInfeasible,    ///< faster, tighter or harder braking than the vehicle can
    kNoHover,       ///< does not end at rest
    kNoLease,       ///< another planner holds the lease
    kNotFollowing,  ///< the vehicle does not follow plans now
    kDiscontinuous, kOutsideFence, kObstacle,
    kTeammate,   ///< or any other body
    kTooCostly,  ///< to check: more than kWayStepsMax steps
};
inline constexpr std::size_t kPlanVerdicts = 14;
/// Steps of one check_way() at most, along the path and against each other body; some 10 ms.
inline constexpr int kWayStepsMax = 50'000;

/// As reasons and counters write it.
const char* name_of(PlanVerdict verdict);

/// A plan in a fixed space, so that holding one never allocates.
struct HeldPlan {
  static constexpr std::size_t kSegmentsMax = models::kFlownSegmentsMax;
  Time start_time{};
  Pose2 start;
  double height_m = 0.0;
  std::size_t count = 0;
  std::array<models::PlanSegment, kSegmentsMax> segments{};
};

/// A state on a plan.
struct PlanPoint {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_world_mps2 = Eigen::Vector3d::Zero();  ///< where a course knows it
  double yaw_rad = 0.0;
  double yaw_rate_radps = 0.0;
};

/// Copies a trajectory. False, and nothing usable, when it has too many segments.
bool hold_plan(const models::Trajectory& trajectory, HeldPlan& out);
double duration_s(const HeldPlan& plan);
/// The state `elapsed_s` after the start; the start at rest before it, the hover after the end.
PlanPoint point_at(const HeldPlan& plan, double elapsed_s);
/// The fastest that the plan moves within [from_s, to_s] after its start.
double speed_max_mps(const HeldPlan& plan, double from_s, double to_s);

/// The states on one plan at ascending times, as point_at() gives them; a state costs about as much
/// as one segment, however many the plan has. The plan must outlive it.
class PlanWalk {
 public:
  explicit PlanWalk(const HeldPlan& plan);
  /// @param elapsed_s  after the start; no less than at the call before
  PlanPoint at(double elapsed_s);

 private:
  const HeldPlan* plan_;
  std::size_t segment_ = 0;
  double begin_s_ = 0.0;  ///< of that segment
  PlanPoint begin_;       ///< the state there
};

/// Another body that the plan must keep away from: on its own plan, or where it is seen and
/// straight on from there.
struct OtherCourse {
  const HeldPlan* plan = nullptr;  ///< nullptr: at position_world_m
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();  ///< without a plan
  double goes_on_s = 0.0;       ///< so long; a body that moves is not looked at after it
  bool reaches_ground = false;  ///< all that is beneath it counts as well
};

/// kAccepted, kNotFinite, kInfeasible or kNoHover, from the plan alone.
PlanVerdict check_shape(const HeldPlan& plan, const SafetyLimits& limits);
/// Checks the plan of another vehicle by the limits of that vehicle.
PlanVerdict check_shape(const HeldPlan& plan, const models::VehicleLimits& can,
                        double lateral_max_mps2);
/// kAccepted, or the first that applies of kOutsideFence, kObstacle, kTeammate and kTooCostly, for
/// the rest of the plan from `now` on. Advances by as much as the distance left allows, so nothing
/// thinner than 2 mm is stepped over. `steps`, where given, becomes the number of steps taken.
PlanVerdict check_way(const HeldPlan& plan, Time now, const SafetyLimits& limits,
                      std::span<const OtherCourse> others, int* steps = nullptr);

/// Distance from `p_m` to the nearest obstacle, exactly; negative inside one. +∞ without any.
double obstacle_distance_m(const models::World& world, const Eigen::Vector2d& p_m);
/// Distance from `p_m` to the bounds from inside; negative outside.
double fence_distance_m(const models::World& world, const Eigen::Vector2d& p_m);

}  // namespace vantage::drivers
