#include "sim/rover/fleet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

constexpr double kSafetyMarginM = 0.03;  // m; clearance between surfaces
constexpr double kRouteMarginM = 0.1;    // m; clearance of a route from other rovers
constexpr double kNeighbourhoodM = 1.5;  // m; routes avoid rovers nearer than this
constexpr double kLookAheadM = 0.6;      // m; largest distance of the point that a rover steers to
constexpr double kArrivalM = 0.15;       // m; a way point nearer than this is reached
constexpr double kHeadwayM = 0.1;        // m; a rover that moves less than this is stuck
constexpr double kRerouteS = 1.0;        // s; a rover stuck for longer searches for a new route
constexpr double kPatienceS = 4.0;       // s; a rover stuck for longer chooses another way point
constexpr double kTurnGainPerS = 3.0;
constexpr double kRoundingM = 1e-9;
constexpr double kClearlyM = 1e-6;  // m; margin for rounding errors of the fast distance check
constexpr int kDrawsMax = 40;
// Variations of the desired command, smallest first: factor of the speed, additional yaw rate.
constexpr std::array<std::array<double, 2>, 8> kVariations{{{1.0, 0.0},
                                                            {0.6, 0.0},
                                                            {0.7, 1.2},
                                                            {0.7, -1.2},
                                                            {0.3, 0.0},
                                                            {0.3, 2.0},
                                                            {0.3, -2.0},
                                                            {0.0, 0.0}}};

/// Returns the distance from the segment a–b to a point.
double distance_m(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m,
                  const Eigen::Vector2d& point_m) {
  const Eigen::Vector2d ab_m = b_m - a_m;
  const double share = ab_m.dot(point_m - a_m) / std::max(ab_m.squaredNorm(), 1e-18);
  return (a_m + std::clamp(share, 0.0, 1.0) * ab_m - point_m).norm();
}

double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * std::uniform_real_distribution<double>(0.0, 1.0)(rng);
}

}  // namespace

RoverFleet::RoverFleet(const models::World& world, const scenario::TargetTruthSpec& truth,
                       const std::vector<Start>& starts, std::uint64_t seed,
                       const RoverParameters& parameters)
    : world_(world), truth_(truth), parameters_(parameters), map_(world) {
  require(truth.speed_min_mps > 0.0 && truth.speed_min_mps <= truth.speed_max_mps &&
              truth.speed_max_mps <= parameters.speed_max_mps,
          "target_truth: rovers need 0 < speed_min_mps <= speed_max_mps <= 1.4");
  rovers_.resize(starts.size());
  reaches_.resize(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    Rover& rover = rovers_[i];
    rover.state.world_from_body = starts[i].world_from_body;
    rover.radius_m = starts[i].radius_m;
    rover.rng = random_stream(seed, "rover:" + std::to_string(i));
    commit(i, StoppingPath(rover.state, {}, parameters_, kDecisionPeriodS));
    rover.headway_m = rover.state.world_from_body.position_m();
    rover.pause_s = uniform(rover.rng, 0.0, truth_.pause_max_s);
  }
}

void RoverFleet::keep_out(std::vector<Eigen::Vector2d> centres_m, double distance_m) {
  kept_out_m_ = std::move(centres_m);
  keep_out_m_ = distance_m;
}

void RoverFleet::decide(double elapsed_s) {
  for (std::size_t i = 0; i < rovers_.size(); ++i) {
    supervise(i, elapsed_s);
    Rover& rover = rovers_[i];
    const RoverCommand desired_command = desired(rover);
    // A braking rover stays within its stopping area. Turning in place sweeps no additional ground.
    rover.command =
        RoverCommand{0.0, rover.state.speed_mps > 0.0 ? 0.0 : desired_command.yaw_rate_radps};
    StoppingPath chosen(rover.state, rover.command, parameters_, kDecisionPeriodS);
    for (const auto& [share, turn_radps] : kVariations) {
      const RoverCommand command{share * desired_command.speed_mps,
                                 desired_command.yaw_rate_radps + turn_radps};
      const StoppingPath path(rover.state, command, parameters_, kDecisionPeriodS);
      if (is_safe(i, path)) {
        rover.command = command;
        chosen = path;
        break;
      }
    }
    commit(i, chosen);
  }
}

void RoverFleet::commit(std::size_t i, const StoppingPath& path) {
  rovers_[i].committed = path;
  reaches_[i] = {path.points_m().front(), path.reach_m() + rovers_[i].radius_m};
}

void RoverFleet::step(double dt_s) {
  for (Rover& rover : rovers_) {
    rover.state = step_rover(rover.state, rover.command, parameters_, dt_s);
  }
}

void RoverFleet::supervise(std::size_t i, double elapsed_s) {
  Rover& rover = rovers_[i];
  const Eigen::Vector2d here_m = rover.state.world_from_body.position_m();
  if (rover.path.empty()) {
    rover.pause_s -= elapsed_s;
    if (rover.pause_s <= 0.0) {
      choose_way_point(i);
    }
    return;
  }
  if ((here_m - rover.path.back()).norm() < kArrivalM) {
    ++way_points_reached_;
    rover.path.clear();
    rover.pause_s = uniform(rover.rng, 0.0, truth_.pause_max_s);
    return;
  }
  rover.stuck_s += elapsed_s;
  if ((here_m - rover.headway_m).norm() > kHeadwayM) {
    rover.headway_m = here_m;
    rover.stuck_s = 0.0;
    rover.rerouted = false;
  } else if (rover.stuck_s > kPatienceS) {
    ++way_points_abandoned_;
    choose_way_point(i);
  } else if (rover.stuck_s > kRerouteS && !rover.rerouted) {
    rover.rerouted = true;
    std::vector<Eigen::Vector2d> around =
        map_.route(here_m, rover.path.back(), rover.radius_m, neighbours(i));
    if (!around.empty()) {
      rover.path = std::move(around);
      rover.passed = 0;
    }
  }
}

std::vector<Disc> RoverFleet::neighbours(std::size_t i) const {
  const Rover& rover = rovers_[i];
  const Eigen::Vector2d here_m = rover.state.world_from_body.position_m();
  std::vector<Disc> blocked;
  for (std::size_t j = 0; j < rovers_.size(); ++j) {
    const Eigen::Vector2d there_m = rovers_[j].state.world_from_body.position_m();
    if (j != i && (there_m - here_m).norm() < kNeighbourhoodM) {
      const double wanted_m = rover.radius_m + rovers_[j].radius_m + kRouteMarginM;
      blocked.push_back({there_m, std::min(wanted_m, (there_m - here_m).norm())});
    }
  }
  for (const Eigen::Vector2d& centre_m : kept_out_m_) {
    const double away_m = (centre_m - here_m).norm();
    blocked.push_back({centre_m, std::min(keep_out_m_ + kRouteMarginM, away_m)});
  }
  return blocked;
}

void RoverFleet::choose_way_point(std::size_t i) {
  Rover& rover = rovers_[i];
  const Eigen::Vector2d here_m = rover.state.world_from_body.position_m();
  rover.path.clear();
  rover.passed = 0;
  rover.stuck_s = 0.0;
  rover.rerouted = false;
  rover.headway_m = here_m;
  rover.leg_speed_mps = uniform(rover.rng, truth_.speed_min_mps, truth_.speed_max_mps);
  const std::vector<Disc> blocked = neighbours(i);
  const double needed_m = map_.clearance_needed_m(rover.radius_m);
  for (int draw = 0; draw < kDrawsMax && rover.path.empty(); ++draw) {
    const models::Rectangle& bounds = world_.bounds;
    // These are separate statements, because the evaluation order of arguments depends on the
    // compiler.
    const double y_m = uniform(rover.rng, bounds.min_m.y(), bounds.max_m.y());
    const double x_m = uniform(rover.rng, bounds.min_m.x(), bounds.max_m.x());
    const Eigen::Vector2d goal_m(x_m, y_m);
    if (models::clearance_m(world_, goal_m) >= needed_m && (goal_m - here_m).norm() > kArrivalM) {
      rover.path = map_.route(here_m, goal_m, rover.radius_m, blocked);
    }
  }
  if (rover.path.empty()) {  // no route: waits for a short time, then draws another way point
    rover.pause_s = uniform(rover.rng, 0.1, 1.0);
  }
}

RoverCommand RoverFleet::desired(Rover& rover) const {
  if (rover.path.empty()) {
    return {};
  }
  const Pose2& pose = rover.state.world_from_body;
  const Eigen::Vector2d here_m = pose.position_m();
  // Steers to the farthest point of the path within kLookAheadM that is reachable in a straight
  // line.
  std::size_t aim = rover.passed;
  for (std::size_t k = rover.passed; k < rover.path.size(); ++k) {
    if ((rover.path[k] - here_m).norm() > kLookAheadM) {
      break;
    }
    if (models::swept_clearance_m(world_, here_m, rover.path[k]) >=
        rover.radius_m + kSafetyMarginM) {
      aim = k;
    }
  }
  rover.passed = aim;
  const Eigen::Vector2d to_aim_m = rover.path[aim] - here_m;
  const double error_rad = wrap_to_pi(std::atan2(to_aim_m.y(), to_aim_m.x()) - pose.yaw_rad);
  const double ahead = std::max(0.0, std::cos(error_rad));
  const double left_m = (rover.path.back() - here_m).norm();
  // m/s; allows a stop at half the maximum deceleration
  const double arrive_mps = std::sqrt(parameters_.brake_mps2 * left_m);
  return {std::min(rover.leg_speed_mps, arrive_mps) * ahead * ahead * ahead,
          std::clamp(kTurnGainPerS * error_rad, -parameters_.yaw_rate_max_radps,
                     parameters_.yaw_rate_max_radps)};
}

bool RoverFleet::is_safe(std::size_t i, const StoppingPath& path) const {
  const Rover& rover = rovers_[i];
  const Eigen::Vector2d here_m = rover.state.world_from_body.position_m();
  // A rover that is already too close to a wall or obstacle must not come closer.
  const double wall_m =
      std::min(rover.radius_m + kSafetyMarginM, models::clearance_m(world_, here_m));
  const auto points = path.points_m();
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    if (models::swept_clearance_m(world_, points[k], points[k + 1]) < wall_m) {
      return false;
    }
  }
  for (const Eigen::Vector2d& centre_m : kept_out_m_) {
    const double needed_m = std::min(keep_out_m_, (centre_m - here_m).norm() - kRoundingM);
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      if (distance_m(points[k], points[k + 1], centre_m) < needed_m) {
        return false;
      }
    }
  }
  const double own_reach_m = path.reach_m() + rover.radius_m + kSafetyMarginM + kClearlyM;
  for (std::size_t j = 0; j < rovers_.size(); ++j) {
    const double apart_m = (reaches_[j].first_m - points.front()).norm();
    if (j == i || apart_m > own_reach_m + reaches_[j].reach_m) {
      continue;
    }
    const double needed_m = rover.radius_m + rovers_[j].radius_m + kSafetyMarginM;
    if (distance_m(path, rovers_[j].committed) >= needed_m) {
      continue;
    }
    const Eigen::Vector2d there_m = rovers_[j].state.world_from_body.position_m();
    const double now_m = (there_m - here_m).norm();
    const bool moves_away = now_m < needed_m && (points.back() - there_m).norm() > now_m &&
                            (rovers_[j].committed.points_m().back() - there_m).norm() < 1e-6;
    if (!moves_away) {
      return false;
    }
  }
  return true;
}

}  // namespace vantage::sim
