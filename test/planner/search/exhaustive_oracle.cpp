#include "test/planner/search/exhaustive_oracle.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::test {
namespace {

constexpr double kUndecided_m = 1e-6;

// True if the robot can stop from `at`; nullopt if the result depends on rounding.
std::optional<bool> can_stop(const planner::SearchProblem& problem, const Pose2& at,
                             double speed_mps) {
  if (problem.brake_mps2 <= 0.0 || problem.world == nullptr) {
    return true;
  }
  const double way_m = 0.5 * speed_mps * speed_mps / problem.brake_mps2;
  const Eigen::Vector2d ahead(std::cos(at.yaw_rad), std::sin(at.yaw_rad));
  const double margin_m =
      models::swept_clearance_m(*problem.world, at.position_m(), at.position_m() + way_m * ahead) -
      problem.clearance_m;
  if (std::abs(margin_m) < kUndecided_m) {
    return std::nullopt;
  }
  return margin_m > 0.0;
}

// Returns `before` and the targets at these means that the robot's sensors measure from `pose`.
std::vector<std::uint16_t> measured_from(const planner::SearchProblem& problem,
                                         const std::vector<models::Gaussian>& beliefs,
                                         const Pose2& pose, std::vector<std::uint16_t> before) {
  for (std::size_t m = 0; m < beliefs.size(); ++m) {
    const models::PositionVector mean_m =
        beliefs[m].mean.head(problem.targets[m].model.position_dim);
    const bool is_visible =
        problem.world == nullptr || !problem.obstacles_block_sight ||
        models::line_of_sight(*problem.world, pose.position_m(), mean_m.head<2>());
    const bool is_measured =
        is_visible &&
        std::any_of(
            problem.sensors.begin(), problem.sensors.end(), [&](const models::SensorModel& sensor) {
              return !models::information(sensor, {pose, problem.height_m}, mean_m).isZero(0.0);
            });
    if (is_measured) {
      before.push_back(static_cast<std::uint16_t>(m));
    }
  }
  std::sort(before.begin(), before.end());
  before.erase(std::unique(before.begin(), before.end()), before.end());
  return before;
}

void search(const planner::SearchProblem& problem, const OracleState& state, double cost,
            std::vector<int>& controls, OracleAnswer& best) {
  for (std::size_t c = 0; c < problem.controls.size(); ++c) {
    const models::UnicycleControl& control = problem.controls[c];
    const std::optional<bool> clear =
        arc_clear(problem, state.world_from_body, control, problem.step_s);
    best.undecided = best.undecided || !clear;
    if (!clear.value_or(false)) {
      continue;
    }
    OracleState next;
    next.depth = state.depth + 1;
    next.world_from_body = models::step_unicycle(state.world_from_body, control, problem.step_s);
    next.beliefs = look_from(problem, state.beliefs, next.world_from_body, next.depth);
    double next_cost = cost + stage_cost(problem, next.beliefs);
    if (!problem.terminal.is_empty()) {
      next.measured = measured_from(problem, next.beliefs, next.world_from_body, state.measured);
      if (next.depth == problem.horizon_steps) {
        const auto cost_of = [&](std::size_t k) {
          const models::StateMatrix& covariance = state.beliefs[state.measured[k]].covariance;
          return problem.cost == planner::CostKind::kLogDet ? models::log_det(covariance)
                                                            : covariance.trace();
        };
        next_cost += problem.terminal.at(problem.terminal.rest(state.measured, cost_of),
                                         next.world_from_body.position_m());
      }
    }
    controls.push_back(static_cast<int>(c));
    if (next.depth < problem.horizon_steps) {
      search(problem, next, next_cost, controls, best);
    } else if (!best.found || next_cost < best.cost) {
      const std::optional<bool> stops = can_stop(problem, next.world_from_body, control.speed_mps);
      best.undecided = best.undecided || !stops;
      if (stops.value_or(false)) {
        best.found = true;
        best.cost = next_cost;
        best.controls = controls;
      }
    }
    controls.pop_back();
  }
}

// Returns (Σ⁻¹ + M)⁻¹ by two inversions, with more digits than a double has.
models::StateMatrix with_state_information(const models::StateMatrix& covariance,
                                           const models::StateMatrix& M) {
  using Matrix = Eigen::Matrix<long double, 4, 4>;
  const Matrix sum = Matrix(covariance.cast<long double>()).inverse() + M.cast<long double>();
  return Matrix(sum.inverse()).cast<double>();
}

}  // namespace

OracleState start_of(const planner::SearchProblem& problem) {
  OracleState state;
  state.world_from_body = problem.start;
  for (const planner::SearchTarget& target : problem.targets) {
    state.beliefs.push_back(target.prior);
  }
  return state;
}

OracleAnswer best_completion(const planner::SearchProblem& problem, const OracleState& state) {
  OracleAnswer best;
  std::vector<int> controls;
  if (state.depth == problem.horizon_steps) {
    best.found = true;
    return best;
  }
  search(problem, state, 0.0, controls, best);
  return best;
}

std::vector<models::Gaussian> look_from(const planner::SearchProblem& problem,
                                        const std::vector<models::Gaussian>& beliefs,
                                        const Pose2& pose, int depth) {
  std::vector<models::Gaussian> after;
  for (std::size_t m = 0; m < beliefs.size(); ++m) {
    const models::TargetModel& model = problem.targets[m].model;
    models::Gaussian belief = models::predict(beliefs[m], model, problem.step_s);
    const models::PositionVector mean_m = belief.mean.head(model.position_dim);
    if (!problem.fixed_information.empty()) {
      const models::StateMatrix& fixed =
          problem.fixed_information[m][static_cast<std::size_t>(depth - 1)];
      if (fixed.rows() == 4) {
        belief.covariance = with_state_information(belief.covariance, fixed);
      } else if (fixed.size() > 0) {
        belief.covariance = models::update_covariance(belief.covariance, fixed);
      }
    }
    if (problem.world == nullptr || !problem.obstacles_block_sight ||
        models::line_of_sight(*problem.world, pose.position_m(), mean_m.head<2>())) {
      for (const models::SensorModel& sensor : problem.sensors) {
        if (models::measures_velocity(sensor) && model.has_velocity()) {
          belief.covariance = with_state_information(
              belief.covariance,
              models::state_information(sensor, {pose, problem.height_m}, belief.mean));
          continue;
        }
        belief.covariance = models::update_covariance(
            belief.covariance, models::information(sensor, {pose, problem.height_m}, mean_m));
      }
    }
    after.push_back(belief);
  }
  return after;
}

double stage_cost(const planner::SearchProblem& problem,
                  const std::vector<models::Gaussian>& beliefs) {
  double cost = 0.0;
  for (const models::Gaussian& belief : beliefs) {
    cost += problem.cost == planner::CostKind::kLogDet ? models::log_det(belief.covariance)
                                                       : belief.covariance.trace();
  }
  return cost;
}

std::optional<bool> arc_clear(const planner::SearchProblem& problem, const Pose2& from,
                              const models::UnicycleControl& control, double duration_s) {
  if (problem.world == nullptr) {
    return true;
  }
  const Pose2 to = models::step_unicycle(from, control, duration_s);
  const double margin_m =
      models::swept_clearance_m(*problem.world, from.position_m(), to.position_m()) -
      problem.clearance_m;
  const double sagitta_m =
      0.125 * std::abs(control.speed_mps * control.yaw_rate_radps) * duration_s * duration_s;
  if (margin_m > sagitta_m + kUndecided_m) {
    return true;
  }
  if (margin_m < -sagitta_m - kUndecided_m) {
    return false;
  }
  if (sagitta_m < 0.1 * kUndecided_m) {
    return std::nullopt;
  }
  const Pose2 middle = models::step_unicycle(from, control, 0.5 * duration_s);
  const std::optional<bool> first = arc_clear(problem, from, control, 0.5 * duration_s);
  if (first == false) {
    return false;
  }
  const std::optional<bool> second = arc_clear(problem, middle, control, 0.5 * duration_s);
  if (second == false) {
    return false;
  }
  return first && second ? std::optional<bool>(true) : std::nullopt;
}

}  // namespace vantage::test
