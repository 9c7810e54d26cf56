#include "drivers/safety/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angle.hpp"
#include "models/world/world.hpp"

namespace vantage::drivers {
namespace {

constexpr int kSamples = 16;     // samples along the braking path
constexpr double kLevelM = 0.3;  // m; heights that differ by less count as equal
constexpr double kStandsMps = 0.1;
constexpr double kMovesOffS = 1.0;  // s; approximate time to move away from a hover
constexpr double kFenceSpareM = 0.1;
constexpr double kObstacleSpareM = 0.05;
constexpr double kHoverSpareM = 0.05;  // m; clearance of a new position beyond hover_clearance_m
constexpr double kBelowSpareM = 0.1;   // m; clearance of a new position beyond landing_clearance_m

bool is_robot(const OtherBody& body) { return body.robot >= 0; }

Eigen::Vector3d level(const Eigen::Vector3d& v) { return {v.x(), v.y(), 0.0}; }

double unseen_s(const OtherBody& body, const SafetyLimits& limits) {
  return std::max(0.0, body.age_s - limits.pose_age_hold_s);
}

// Returns the uncertainty radius of a body around its extrapolated position, m. A robot without
// poses stops; any other moving body may continue for a second.
double strayed_m(const OtherBody& body, const SafetyLimits& limits) {
  constexpr double kExtrapolationMaxS = 1.0;
  const double growth_mps = std::max(limits.other_pose_growth_mps, body.last_speed_mps);
  const double most_m =
      std::max(limits.other_pose_growth_max_m, kExtrapolationMaxS * body.last_speed_mps);
  return std::min(most_m, growth_mps * unseen_s(body, limits));
}

// Returns the distance to subtract for a body, m: its uncertainty radius and its excess radius.
double tube_m(const OtherBody& body, const SafetyLimits& limits) {
  return strayed_m(body, limits) + body.excess_radius_m;
}

// Returns a lower bound of the distance between a vehicle that moves from `from_m` to `to_m` and a
// moving body that reaches down to the ground, m. In the same time, the body moves from
// `body_from_m` to `body_to_m`, and may be `strayed_m` off that path; the space below its markers
// is occupied. Horizontal and vertical distance are minimized separately.
double distance_to_standing_m(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                              const Eigen::Vector3d& body_from_m, const Eigen::Vector3d& body_to_m,
                              double strayed_m) {
  const double horizontal_m =
      models::closest_approach_m(level(from_m), level(to_m), level(body_from_m), level(body_to_m));
  const double top_m = std::max(body_from_m.z(), body_to_m.z());
  const double above_m = std::max(0.0, std::min(from_m.z(), to_m.z()) - top_m);
  return std::hypot(std::max(0.0, horizontal_m - strayed_m), above_m);
}

double fence_edge_m(const Eigen::Vector3d& p_m, const SafetyLimits& limits) {
  return std::min(fence_distance_m(limits.fence, p_m.head<2>()) - limits.vehicle.radius_m,
                  limits.fence.ceiling_m - p_m.z());
}

double obstacle_edge_m(const Eigen::Vector3d& p_m, const SafetyLimits& limits) {
  return obstacle_distance_m(limits.fence, p_m.head<2>()) - limits.vehicle.radius_m;
}

// Returns the minimum distance of the centres while this vehicle brakes along `path` and a robot
// brakes straight from `velocity_mps`, m.
double closest_stop_m(const BrakingPath& path, const OtherBody& body,
                      const Eigen::Vector3d& velocity_mps, const SafetyLimits& limits) {
  const double brake_mps2 = body.brake_mps2 > 0.0 ? body.brake_mps2 : limits.vehicle.brake_mps2;
  const BrakingPath theirs = BrakingPath::straight(body.position_world_m, velocity_mps, 0.0,
                                                   brake_mps2, limits.reaction_s);
  const double end_s = std::max(path.duration_s(), theirs.duration_s());
  double least_m = (path.at(0.0).position_world_m - body.position_world_m).norm();
  for (int i = 0; i < kSamples; ++i) {
    const double t0_s = end_s * i / kSamples;
    const double t1_s = end_s * (i + 1) / kSamples;
    least_m =
        std::min(least_m, models::closest_approach_m(
                              path.at(t0_s).position_world_m, path.at(t1_s).position_world_m,
                              theirs.at(t0_s).position_world_m, theirs.at(t1_s).position_world_m));
  }
  return least_m;
}

// Returns the minimum centre distance to a body that keeps its velocity, until this vehicle has
// stopped along `path`, m. The body may leave its straight path. While not seen, the body may move
// in any direction at its last speed.
double closest_walk_m(const BrakingPath& path, const OtherBody& body, const SafetyLimits& limits) {
  const bool is_seen = unseen_s(body, limits) <= 0.0;
  const double strays_mps = is_seen ? 0.0 : body.last_speed_mps;
  double least_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSamples; ++i) {
    const double t0_s = path.duration_s() * i / kSamples;
    const double t1_s = path.duration_s() * (i + 1) / kSamples;
    const double off_m =
        strayed_m(body, limits) + strays_mps * t1_s + 0.5 * limits.other_turn_mps2 * t1_s * t1_s;
    least_m = std::min(least_m, distance_to_standing_m(
                                    path.at(t0_s).position_world_m, path.at(t1_s).position_world_m,
                                    body.position_world_m + t0_s * body.velocity_world_mps,
                                    body.position_world_m + t1_s * body.velocity_world_mps, off_m));
  }
  return least_m - body.excess_radius_m;
}

Eigen::Vector3d inside(const Eigen::Vector3d& p_m, const SafetyLimits& limits) {
  const double margin_m = limits.vehicle.radius_m + kFenceSpareM;
  const models::Rectangle& bounds = limits.fence.bounds;
  Eigen::Vector3d out = p_m;
  for (int axis = 0; axis < 2; ++axis) {
    const double low_m = bounds.min_m(axis) + margin_m;
    const double high_m = bounds.max_m(axis) - margin_m;
    out(axis) = low_m < high_m ? std::clamp(p_m(axis), low_m, high_m) : 0.5 * (low_m + high_m);
  }
  return out;
}

bool is_standing_robot(const OtherBody& body) {
  return is_robot(body) && level(body.velocity_world_mps).norm() < kStandsMps;
}

// Returns the predicted position of a body after `t_s`, for a landing. A robot is assumed to keep
// its position.
Eigen::Vector3d carried_on_m(const OtherBody& body, double t_s) {
  return is_robot(body) ? body.position_world_m
                        : Eigen::Vector3d(body.position_world_m + t_s * body.velocity_world_mps);
}

// True if the body's distance to the straight path, flown at kShiftMps, would be below `apart_m`
// and below its present distance. The distance is horizontal for robots, since they may land as
// well, and for bodies that are not below the vehicle.
bool meets(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, const OtherBody& body,
           double apart_m) {
  const bool is_below = body.position_world_m.z() < std::min(from_m.z(), to_m.z()) - kLevelM;
  const bool is_column = is_robot(body) || !is_below;
  const auto seen = [&](const Eigen::Vector3d& p_m) { return is_column ? level(p_m) : p_m; };
  const Eigen::Vector3d q_m = seen(body.position_world_m);
  const Eigen::Vector3d then_m = seen(carried_on_m(body, (to_m - from_m).norm() / kShiftMps));
  const double now_m = (seen(from_m) - q_m).norm();
  const double least_m = models::closest_approach_m(seen(from_m), seen(to_m), q_m, then_m);
  return least_m < std::min(now_m, apart_m + body.excess_radius_m) - 1e-9;
}

bool is_path_clear(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                   std::span<const OtherBody> others, const SafetyLimits& limits) {
  // A vehicle that already hovers closer to an obstacle than kObstacleSpareM may still move away.
  const double path_spare_m = std::min(kObstacleSpareM, obstacle_edge_m(from_m, limits));
  for (int i = 0; i <= kSamples; ++i) {
    const Eigen::Vector3d p_m = from_m + (to_m - from_m) * (static_cast<double>(i) / kSamples);
    if (obstacle_edge_m(p_m, limits) < (i < kSamples ? path_spare_m : kObstacleSpareM)) {
      return false;
    }
  }
  return std::none_of(others.begin(), others.end(), [&](const OtherBody& body) {
    return meets(
        from_m, to_m, body,
        is_robot(body) ? limits.landing_clearance_m + kBelowSpareM : limits.separation_hold_m);
  });
}

}  // namespace

Surroundings compute_surroundings(const Eigen::Vector3d& position_m, const BrakingPath& path,
                                  std::span<const OtherBody> others, const SafetyLimits& limits) {
  Surroundings out;
  out.fence_centre_m = std::min(fence_distance_m(limits.fence, position_m.head<2>()),
                                limits.fence.ceiling_m - position_m.z());
  out.fence_now_m = fence_edge_m(position_m, limits);
  for (int i = 0; i <= kSamples; ++i) {
    const double t_s = path.duration_s() * i / kSamples;
    const Eigen::Vector3d p_m = path.at(t_s).position_world_m;
    out.fence_stop_m = std::min(out.fence_stop_m, fence_edge_m(p_m, limits));
    out.obstacle_stop_m = std::min(out.obstacle_stop_m, obstacle_edge_m(p_m, limits));
  }
  for (const OtherBody& body : others) {
    const double less_m = tube_m(body, limits);
    const Eigen::Vector3d& there_m = body.position_world_m;
    const double apart_m = is_robot(body)
                               ? (position_m - there_m).norm() - less_m
                               : distance_to_standing_m(position_m, position_m, there_m, there_m,
                                                        strayed_m(body, limits)) -
                                     body.excess_radius_m;
    out.separation_now_m = std::min(out.separation_now_m, apart_m);
    double least_m = apart_m;
    if (!is_robot(body)) {
      least_m = std::min(least_m, closest_walk_m(path, body, limits));
    } else {
      least_m =
          std::min(least_m, closest_stop_m(path, body, body.velocity_world_mps, limits) - less_m);
      if (body.planned_world_mps != body.velocity_world_mps) {
        least_m =
            std::min(least_m, closest_stop_m(path, body, body.planned_world_mps, limits) - less_m);
      }
    }
    const bool is_as_near = least_m == out.separation_stop_m;
    if (least_m < out.separation_stop_m || (is_as_near && body.has_priority)) {
      out.separation_stop_m = least_m;
      out.yields = body.has_priority;
    }
  }
  return out;
}

double predicted_distance_m(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                            double prediction_s) {
  double least_m = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d here_m = level(position_m);
  for (const OtherBody& body : others) {
    const Eigen::Vector3d velocity_mps = level(body.velocity_world_mps);
    if (is_standing_robot(body)) {
      continue;
    }
    const Eigen::Vector3d from_m = level(body.position_world_m);
    least_m = std::min(least_m, models::closest_approach_m(here_m, here_m, from_m,
                                                           from_m + prediction_s * velocity_mps) -
                                    body.excess_radius_m);
  }
  return least_m;
}

bool is_occupied_below(const Eigen::Vector3d& position_m, std::span<const OtherBody> others,
                       const SafetyLimits& limits, double spare_m, double prediction_s) {
  const double until_down_s = std::max(0.0, position_m.z()) / limits.low_descent_mps;
  return std::any_of(others.begin(), others.end(), [&](const OtherBody& body) {
    const double above_m = position_m.z() - body.position_world_m.z();
    const bool is_below =
        !is_robot(body) || above_m > kLevelM || (above_m > -kLevelM && body.has_priority);
    const double needed_m = limits.landing_clearance_m + tube_m(body, limits) + spare_m;
    const Eigen::Vector3d here_m = level(position_m);
    return is_below &&
           models::closest_approach_m(
               here_m, here_m, level(body.position_world_m),
               level(carried_on_m(body, std::min(prediction_s, until_down_s)))) < needed_m;
  });
}

bool is_path_blocked(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                     std::span<const OtherBody> others, const SafetyLimits& limits) {
  return std::any_of(others.begin(), others.end(), [&](const OtherBody& body) {
    return (body.has_priority || is_standing_robot(body)) &&
           meets(from_m, to_m, body, limits.separation_hold_m);
  });
}

Eigen::Vector3d landing_spot(const Eigen::Vector3d& hover_m, std::span<const OtherBody> others,
                             const SafetyLimits& limits) {
  constexpr int kRings = 6;
  constexpr int kBearings = 12;
  const Eigen::Vector3d home_m = inside(hover_m, limits);
  const auto is_free = [&](const Eigen::Vector3d& spot_m) {
    return !is_occupied_below(spot_m, others, limits, kBelowSpareM, limits.landing_prediction_s) &&
           is_path_clear(hover_m, spot_m, others, limits);
  };
  if (is_free(home_m)) {
    return home_m;
  }
  // A moving vehicle deviates from its path, so spots with additional clearance are tried first.
  const double roomy_m = limits.hover_clearance_m + kHoverSpareM;
  for (const bool is_roomy : {true, false}) {
    for (int ring = 1; ring <= kRings; ++ring) {
      for (int bearing = 0; bearing < kBearings; ++bearing) {
        const double angle_rad = 2.0 * kPi * bearing / kBearings;
        const Eigen::Vector3d spot_m =
            home_m + 0.25 * ring * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
        const double edge_m =
            std::min(fence_edge_m(spot_m, limits), obstacle_edge_m(spot_m, limits));
        if (inside(spot_m, limits) == spot_m && (!is_roomy || edge_m >= roomy_m) &&
            is_free(spot_m)) {
          return spot_m;
        }
      }
    }
  }
  return home_m;
}

bool is_climb_blocked(const Eigen::Vector3d& position_m, double goal_m,
                      std::span<const OtherBody> others, const SafetyLimits& limits) {
  constexpr double kPredictionS = 2.0;
  constexpr double kRoomM = 0.25;  // m; allowance for a turn of the other body during this time
  return std::any_of(others.begin(), others.end(), [&](const OtherBody& body) {
    const double z_m = body.position_world_m.z();
    const bool is_in_climb_range =
        body.robot >= 0 && z_m > position_m.z() && z_m < goal_m + limits.separation_hold_m;
    const Eigen::Vector3d flat(1.0, 1.0, 0.0);
    const Eigen::Vector3d here_m = position_m.cwiseProduct(flat);
    const Eigen::Vector3d from_m = body.position_world_m.cwiseProduct(flat);
    const Eigen::Vector3d to_m = from_m + kPredictionS * body.velocity_world_mps.cwiseProduct(flat);
    const double needed_m = limits.separation_hold_m + kRoomM + tube_m(body, limits);
    return is_in_climb_range && models::closest_approach_m(here_m, here_m, from_m, to_m) < needed_m;
  });
}

std::optional<Eigen::Vector3d> clear_spot(const Eigen::Vector3d& hover_m,
                                          std::span<const OtherBody> others,
                                          const SafetyLimits& limits) {
  constexpr double kRingM = 0.05;
  constexpr int kRings = 12;
  constexpr int kBearings = 24;
  const auto edge_m = [&limits](const Eigen::Vector3d& p_m) {
    return std::min(fence_edge_m(p_m, limits), obstacle_edge_m(p_m, limits));
  };
  if (edge_m(hover_m) >= limits.hover_clearance_m) {
    return std::nullopt;
  }
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int bearing = 0; bearing < kBearings; ++bearing) {
      const double angle_rad = 2.0 * kPi * bearing / kBearings;
      const Eigen::Vector3d spot_m =
          hover_m + kRingM * ring * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
      const bool is_apart = std::all_of(others.begin(), others.end(), [&](const OtherBody& body) {
        const double now_m = (hover_m - body.position_world_m).norm();
        const double then_m = models::closest_approach_m(spot_m, spot_m, body.position_world_m,
                                                         carried_on_m(body, kMovesOffS));
        return then_m >=
               std::min(now_m, limits.separation_hold_m + kHoverSpareM + body.excess_radius_m);
      });
      if (is_apart && edge_m(spot_m) >= limits.hover_clearance_m + kHoverSpareM) {
        return spot_m;
      }
    }
  }
  return std::nullopt;
}

}  // namespace vantage::drivers
