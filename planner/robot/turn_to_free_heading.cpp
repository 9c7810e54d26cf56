#include "planner/robot/turn_to_free_heading.hpp"

#include <algorithm>
#include <cmath>

#include "planner/robot/closing_check.hpp"
#include "planner/robot/trajectory_tools.hpp"

namespace vantage::planner {
namespace {

constexpr double kTurn_rad = kPi / 4.0;

// Returns a turn by an eighth of a circle: to the right if off_rad ≤ −45°, otherwise to the left.
models::Trajectory turn(const SearchProblem& problem, double off_rad, double yaw_rate_max_radps) {
  constexpr double kYawRate_radps = 1.5;
  const double rate_radps = std::min(kYawRate_radps, yaw_rate_max_radps);
  models::Trajectory turning = hover_at(problem.start, problem.height_m, problem.start_time);
  turning.segments = {
      {{0.0, off_rad <= -kTurn_rad ? -rate_radps : rate_radps}, kTurn_rad / rate_radps, 0.0}};
  return turning;
}

double bearing_away_rad(const SearchProblem& problem, const models::Trajectory& teammate) {
  const Eigen::Vector2d from_m =
      models::at(teammate, problem.start_time).world_from_body.position_m();
  const Eigen::Vector2d away_m = problem.start.position_m() - from_m;
  return wrap_to_pi(std::atan2(away_m.y(), away_m.x()) - problem.start.yaw_rad);
}

}  // namespace

bool can_move_after_turn(const SearchProblem& problem, double turned_rad) {
  Pose2 from = problem.start;
  from.yaw_rad = wrap_to_pi(from.yaw_rad + turned_rad);
  models::Trajectory step = hover_at(from, problem.height_m, problem.start_time);
  return std::any_of(problem.controls.begin(), problem.controls.end(), [&](const auto& control) {
    step.segments = {{control, problem.step_s, 0.0}};
    for (const auto& stop : models::brake(control.speed_mps, problem.brake_mps2)) {
      step.segments.push_back(stop);
    }
    // Requires only the clearance and separation of the search: a larger margin may be impossible
    // here.
    return control.speed_mps > 0.0 &&
           models::is_clear(*problem.world, step, step.start_time, problem.clearance_m) &&
           keeps_apart(problem, step, 0.0);
  });
}

std::optional<models::Trajectory> turn_to_free_heading(const SearchProblem& problem,
                                                       bool is_blocked, double yaw_rate_max_radps) {
  if (const auto teammate = nearest_violating_teammate(problem)) {
    return turn(problem, bearing_away_rad(problem, problem.teammates[*teammate]),
                yaw_rate_max_radps);
  }
  if (!is_blocked && can_move_after_turn(problem, 0.0)) {
    return std::nullopt;  // staying may be optimal
  }
  for (const double turn_rad : {kTurn_rad, 2.0 * kTurn_rad, 3.0 * kTurn_rad, kPi}) {
    for (const double off_rad : {turn_rad, -turn_rad}) {
      if (can_move_after_turn(problem, off_rad)) {
        return turn(problem, off_rad, yaw_rate_max_radps);
      }
    }
  }
  return is_blocked ? std::optional(turn(problem, kTurn_rad, yaw_rate_max_radps)) : std::nullopt;
}

}  // namespace vantage::planner
