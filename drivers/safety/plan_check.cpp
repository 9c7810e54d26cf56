#include "drivers/safety/plan_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace vantage::drivers {
namespace {

constexpr double kSlack = 1e-6;     // tolerance for rounding in messages
constexpr double kStepMinS = 1e-3;  // s; minimum step, 2 mm at 2 m/s
constexpr double kFarM = 1e6;
constexpr double kBodyStandsMps = 0.1;

bool is_finite(const HeldPlan& plan) {
  bool finite = std::abs(plan.start.x_m) < kFarM && std::abs(plan.start.y_m) < kFarM &&
                std::isfinite(plan.start.yaw_rad) && std::abs(plan.height_m) < kFarM;
  double sum_s = 0.0;
  for (std::size_t i = 0; i < plan.count; ++i) {
    const models::PlanSegment& segment = plan.segments[i];
    finite = finite && std::isfinite(segment.control.speed_mps) &&
             std::isfinite(segment.control.yaw_rate_radps) && segment.duration_s >= 0.0 &&
             segment.brake_mps2 >= 0.0 && std::isfinite(segment.brake_mps2);
    sum_s += segment.duration_s;
  }
  return finite && sum_s <= models::kFlownDurationMax_s;  // false also for NaN and infinity
}

bool is_feasible(const HeldPlan& plan, const models::VehicleLimits& can, double lateral_max_mps2) {
  const double more = 1.0 + kSlack;
  double speed_before_mps = 0.0;
  for (std::size_t i = 0; i < plan.count; ++i) {
    const models::PlanSegment& segment = plan.segments[i];
    const double v = segment.control.speed_mps;
    const double w = segment.control.yaw_rate_radps;
    const bool within =
        std::abs(v) <= can.speed_max_mps * more && std::abs(w) <= can.yaw_rate_max_radps * more &&
        std::abs(v * w) <= lateral_max_mps2 * more && segment.brake_mps2 <= can.brake_mps2 * more &&
        (segment.brake_mps2 == 0.0 || std::abs(w) <= kSlack) &&
        std::abs(v - speed_before_mps) <= can.speed_max_mps * more;
    if (!within) {
      return false;
    }
    speed_before_mps = v;
  }
  return true;
}

bool ends_at_rest(const HeldPlan& plan) {
  if (plan.count == 0) {
    return true;
  }
  const models::PlanSegment& last = plan.segments[plan.count - 1];
  const double speed_mps = std::abs(last.control.speed_mps);
  const bool stops =
      last.brake_mps2 > 0.0 && speed_mps <= last.brake_mps2 * (last.duration_s + kSlack) + kSlack;
  return stops || (speed_mps <= kSlack && last.brake_mps2 == 0.0);
}

// Returns the signed distance to a rectangle, m; negative inside.
double signed_distance_m(const models::Rectangle& box, const Eigen::Vector2d& p_m) {
  const double out_x = std::max(box.min_m.x() - p_m.x(), p_m.x() - box.max_m.x());
  const double out_y = std::max(box.min_m.y() - p_m.y(), p_m.y() - box.max_m.y());
  return std::hypot(std::max(out_x, 0.0), std::max(out_y, 0.0)) +
         std::min(std::max(out_x, out_y), 0.0);
}

// Distances between the vehicle and all static obstacles and the fence.
struct Room {
  double fence_m;
  double obstacle_m;
};

Room room_at(const Setpoint& here, const SafetyLimits& limits) {
  const Eigen::Vector2d p_m = here.position_world_m.head<2>();
  return {fence_distance_m(limits.fence, p_m) - limits.vehicle.radius_m,
          obstacle_distance_m(limits.fence, p_m) - limits.vehicle.radius_m};
}

// Checks the rest of the plan against all static obstacles and the fence. Times count from `now`.
PlanVerdict check_room(const HeldPlan& plan, Time now, const SafetyLimits& limits, int& steps) {
  const double offset_s = to_seconds(now - plan.start_time);
  const double end_s = std::max(0.0, duration_s(plan) - offset_s);
  PlanWalk walk(plan);
  for (double t_s = 0.0; steps < kPathStepsMax; ++steps) {
    const Room room = room_at(walk.at(t_s + offset_s), limits);
    if (room.fence_m < -kSlack) {
      return PlanVerdict::kOutsideFence;
    }
    if (room.obstacle_m < -kSlack) {
      return PlanVerdict::kObstacle;
    }
    if (t_s >= end_s) {
      return PlanVerdict::kAccepted;
    }
    const double step_s = std::min(room.fence_m, room.obstacle_m) / limits.vehicle.speed_max_mps;
    t_s = std::min(end_s, t_s + std::max(step_s, kStepMinS));
  }
  return PlanVerdict::kTooCostly;
}

double apart_m(const Eigen::Vector3d& p_m, const Eigen::Vector3d& other_m, bool reaches_ground) {
  Eigen::Vector3d away_m = p_m - other_m;
  if (reaches_ground) {
    away_m.z() = std::max(0.0, away_m.z());
  }
  return away_m.norm();
}

// Checks the rest of the plan and its final hover against another body until that body has stopped
// as well.
PlanVerdict check_apart(const HeldPlan& plan, Time now, const SafetyLimits& limits,
                        const OtherCourse& other, int& steps) {
  const double offset_s = to_seconds(now - plan.start_time);
  const double own_end_s = std::max(0.0, duration_s(plan) - offset_s);
  const bool has_plan = other.plan != nullptr;
  const double other_offset_s = has_plan ? to_seconds(now - other.plan->start_time) : 0.0;
  const double other_mps = has_plan ? speed_max_mps(*other.plan, 0.0, models::kFlownDurationMax_s)
                                    : other.velocity_world_mps.norm();
  const bool walks = !has_plan && other_mps > kBodyStandsMps;
  const double other_end_s = has_plan ? duration_s(*other.plan) - other_offset_s
                             : walks  ? other.prediction_s
                                      : 0.0;
  const double end_s = walks ? other_end_s : std::max(own_end_s, other_end_s);
  PlanWalk walk(plan);
  std::optional<PlanWalk> others_walk;
  if (has_plan) {
    others_walk.emplace(*other.plan);
  }
  for (double t_s = 0.0; steps < kPathStepsMax; ++steps) {
    const Eigen::Vector3d other_m =
        has_plan ? others_walk->at(t_s + other_offset_s).position_world_m
        : walks  ? Eigen::Vector3d(other.position_world_m + t_s * other.velocity_world_mps)
                 : other.position_world_m;
    const double left_m =
        apart_m(walk.at(t_s + offset_s).position_world_m, other_m, other.reaches_ground) -
        limits.plan_separation_m;
    if (left_m < -kSlack) {
      return PlanVerdict::kTeammate;
    }
    if (t_s >= end_s) {
      return PlanVerdict::kAccepted;
    }
    const double closing_mps = (t_s <= own_end_s ? limits.vehicle.speed_max_mps : 0.0) +
                               (t_s <= other_end_s ? other_mps : 0.0);
    const double step_s = closing_mps > 0.0 ? left_m / closing_mps : end_s;
    t_s = std::min(end_s, t_s + std::max(step_s, kStepMinS));
  }
  return PlanVerdict::kTooCostly;
}

}  // namespace

const char* name_of(PlanVerdict verdict) {
  static constexpr std::array<const char*, kPlanVerdicts> kNames = {
      "accepted",     "wrong vehicle", "stale",    "too far ahead", "not finite",
      "infeasible",   "no hover",      "no lease", "not following", "discontinuous",
      "out of fence", "obstacle",      "teammate", "too costly"};
  return kNames[static_cast<std::size_t>(verdict)];
}

double obstacle_distance_m(const models::World& world, const Eigen::Vector2d& p_m) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const models::Obstacle& obstacle : world.obstacles) {
    least_m = std::min(least_m, signed_distance_m(obstacle.footprint, p_m));
  }
  return least_m;
}

double fence_distance_m(const models::World& world, const Eigen::Vector2d& p_m) {
  return -signed_distance_m(world.bounds, p_m);
}

PlanVerdict check_shape(const HeldPlan& plan, const SafetyLimits& limits) {
  return check_shape(plan, limits.vehicle, limits.lateral_max_mps2);
}

PlanVerdict check_shape(const HeldPlan& plan, const models::VehicleLimits& can,
                        double lateral_max_mps2) {
  if (!is_finite(plan)) {
    return PlanVerdict::kNotFinite;
  }
  if (!is_feasible(plan, can, lateral_max_mps2)) {
    return PlanVerdict::kInfeasible;
  }
  return ends_at_rest(plan) ? PlanVerdict::kAccepted : PlanVerdict::kNoHover;
}

PlanVerdict check_path(const HeldPlan& plan, Time now, const SafetyLimits& limits,
                       std::span<const OtherCourse> others, int* steps) {
  int taken = 0;
  PlanVerdict verdict = PlanVerdict::kOutsideFence;
  if (plan.height_m > 0.0 && plan.height_m < limits.fence.ceiling_m) {
    verdict = check_room(plan, now, limits, taken);
  }
  for (const OtherCourse& other : others) {
    if (verdict != PlanVerdict::kAccepted) {
      break;
    }
    verdict = check_apart(plan, now, limits, other, taken);
  }
  if (steps != nullptr) {
    *steps = taken;
  }
  return verdict;
}

}  // namespace vantage::drivers
