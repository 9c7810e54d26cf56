#include <algorithm>
#include <cmath>
#include <tuple>

#include "planner/robot/robot_planner.hpp"
#include "planner/robot/trajectory_tools.hpp"

// What is published: what a search found, where it is safe; else the next rung of the ladder.

namespace vantage::planner {
namespace {

// The search's own margins are tighter than the closing check's by rounding and its finer pieces.
constexpr double kRounding_m = 0.02;
constexpr double kTurn_rad = kPi / 4.0;  // of a plan that turns on the spot

// What a search says of its plan: of a SearchResult or a RobotPlan.
template <class Found>
auto certificate_of(Found& found) {
  return std::tie(found.cost, found.lower_bound, found.epsilon, found.delta_m, found.passes);
}

}  // namespace

bool RobotPlanner::keeps_apart(const models::Trajectory& trajectory, double rounding_m) const {
  for (std::size_t i = 0; i < problem_.teammates.size(); ++i) {
    if (!models::keeps_separation(trajectory, problem_.teammates[i], trajectory.start_time,
                                  kept_separation_m(problem_, i) - rounding_m, models::kPlanPiece_s,
                                  problem_.separation_from_above)) {
      return false;
    }
  }
  return true;
}

bool RobotPlanner::is_safe(const models::Trajectory& trajectory) const {
  return models::is_clear(scenario_.world, trajectory, trajectory.start_time,
                          problem_.clearance_m - kRounding_m) &&
         keeps_apart(trajectory, kRounding_m);
}

std::optional<std::size_t> RobotPlanner::too_near() const {
  std::optional<std::size_t> nearest;
  double least_m = problem_.separation_m;
  for (std::size_t i = 0; i < problem_.teammates.size(); ++i) {
    const double kept_m = kept_separation_m(problem_, i);
    if (kept_m < least_m) {
      least_m = kept_m;
      nearest = i;
    }
  }
  return nearest;
}

void RobotPlanner::turn_away_from(std::size_t teammate, models::RobotPlan& plan) {
  const Eigen::Vector2d from_m =
      models::at(problem_.teammates[teammate], problem_.start_time).world_from_body.position_m();
  const Eigen::Vector2d away_m = problem_.start.position_m() - from_m;
  turn(wrap_to_pi(std::atan2(away_m.y(), away_m.x()) - problem_.start.yaw_rad), plan);
}

bool RobotPlanner::turn_to_a_way_out(bool is_boxed_in, models::RobotPlan& plan) {
  const auto is_way_out = [this](double turned_rad) {
    Pose2 from = problem_.start;
    from.yaw_rad = wrap_to_pi(from.yaw_rad + turned_rad);
    models::Trajectory step = hover_at(from, spec_->height_m, problem_.start_time);
    return std::any_of(
        problem_.controls.begin(), problem_.controls.end(), [&](const auto& control) {
          step.segments = {{control, problem_.step_s, 0.0}};
          for (const auto& stop : models::brake(control.speed_mps, problem_.brake_mps2)) {
            step.segments.push_back(stop);
          }
          // No more than the search asks for: where it stands, there may not be more.
          return control.speed_mps > 0.0 &&
                 models::is_clear(scenario_.world, step, step.start_time, problem_.clearance_m) &&
                 keeps_apart(step, 0.0);
        });
  };
  if (!is_boxed_in && is_way_out(0.0)) {
    return false;  // it may stay because that is best
  }
  for (const double turn_rad : {kTurn_rad, 2.0 * kTurn_rad, 3.0 * kTurn_rad, kPi}) {
    for (const double off_rad : {turn_rad, -turn_rad}) {
      if (is_way_out(off_rad)) {
        turn(off_rad, plan);
        return true;
      }
    }
  }
  if (is_boxed_in) {
    turn(kTurn_rad, plan);
  }
  return is_boxed_in;
}

void RobotPlanner::turn(double off_rad, models::RobotPlan& plan) {
  constexpr double kYawRate_radps = 1.5;
  const double rate_radps = std::min(kYawRate_radps, spec_->limits.yaw_rate_max_radps);
  plan.source = models::PlanSource::kBraking;
  plan.trajectory = hover_at(problem_.start, spec_->height_m, problem_.start_time);
  plan.trajectory.segments = {
      {{0.0, off_rad <= -kTurn_rad ? -rate_radps : rate_radps}, kTurn_rad / rate_radps, 0.0}};
  ++counts_.turns_away;
}

void RobotPlanner::fall_back(const models::Trajectory& committed, models::RobotPlan& plan) {
  if (is_safe(committed)) {
    plan.source = models::PlanSource::kShifted;
    plan.trajectory = committed;
    ++counts_.fallbacks_shifted;
    return;
  }
  plan.source = models::PlanSource::kBraking;
  plan.trajectory = stop_from(committed, committed.start_time, spec_->limits.brake_mps2);
  ++counts_.fallbacks_braking;
}

bool RobotPlanner::take(const SearchResult& result, models::RobotPlan& plan) {
  if (!result.found) {
    return false;
  }
  plan.trajectory = to_trajectory(problem_, result);
  if (!is_safe(plan.trajectory)) {
    ++counts_.checks_failed;
    return false;
  }
  plan.source = models::PlanSource::kSearched;
  certificate_of(plan) = certificate_of(result);
  return true;
}

bool RobotPlanner::take(const models::RobotPlan& proposed, models::RobotPlan& plan) const {
  if (proposed.source != models::PlanSource::kSearched || !is_safe(proposed.trajectory)) {
    return false;
  }
  plan.source = proposed.source;
  plan.trajectory = proposed.trajectory;
  certificate_of(plan) = certificate_of(proposed);
  return true;
}

}  // namespace vantage::planner
