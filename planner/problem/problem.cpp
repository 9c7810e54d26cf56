#include "planner/problem/problem.hpp"

#include <cmath>
#include <string>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"
#include "models/sensor/law.hpp"
#include "models/target/law.hpp"

namespace vantage::planner {

namespace {

bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad);
}

bool is_positive(double x) { return x > 0.0 && std::isfinite(x); }
bool is_not_negative(double x) { return x >= 0.0 && std::isfinite(x); }

void require_valid(const models::SensorModel& sensor) {
  demand(sensor.range_max_m > 0.0, "search: a sensor's range_max_m must be > 0");
  demand(is_not_negative(sensor.range_min_m), "search: a sensor's range_min_m must be ≥ 0");
  demand(is_positive(sensor.fov_rad), "search: a sensor's fov_rad must be > 0");
  demand(is_positive(sensor.range_sigma_m) && is_positive(sensor.bearing_sigma_rad) &&
             is_positive(sensor.position_sigma_m) && is_positive(sensor.pixel_sigma),
         "search: a sensor's sigmas must be > 0");
  demand(!sensor.variance_grows_with_range || is_positive(sensor.variance_floor),
         "search: a sensor's variance_floor must be > 0");
  if (const models::SensorParameter* const broken = models::broken_parameter(sensor)) {
    throw UsageError("search: a sensor's " + std::string(broken->name) + " must be " +
                     std::string(models::words_of(broken->rule)));
  }
}

void require_valid(const SearchTarget& target) {
  const models::TargetModel& model = target.model;
  if (const auto rule = models::broken_rule(model)) {
    throw UsageError("search: target model: " + std::string(*rule));
  }
  const models::StateMatrix& covariance = target.prior.covariance;
  demand(target.prior.mean.size() == target.model.dim() &&
             covariance.rows() == target.model.dim() && covariance.cols() == target.model.dim(),
         "search: a prior must have the dimension of its target model");
  demand(target.prior.mean.allFinite(), "search: a prior mean must be finite");
  demand(std::isfinite(models::log_det(covariance)),
         "search: a prior covariance must be positive definite");
  constexpr double kRounding = 1e-9;
  demand((covariance - covariance.transpose()).cwiseAbs().maxCoeff() <=
             kRounding * covariance.diagonal().maxCoeff(),
         "search: a prior covariance must be symmetric");
}

void require_valid_information(const SearchProblem& problem) {
  demand(problem.fixed_information.empty() ||
             problem.fixed_information.size() == problem.targets.size(),
         "search: fixed_information must be empty or have one entry per target");
  for (std::size_t m = 0; m < problem.fixed_information.size(); ++m) {
    demand(problem.fixed_information[m].size() >= static_cast<std::size_t>(problem.horizon_steps),
           "search: fixed_information must have a matrix for every step");
    const int p = problem.targets[m].model.position_dim;
    const int n = problem.targets[m].model.dim();
    for (const models::StateMatrix& M : problem.fixed_information[m]) {
      demand(M.size() == 0 ||
                 ((M.rows() == p || M.rows() == n) && M.cols() == M.rows() && M.allFinite()),
             "search: each matrix of fixed_information must be empty, or finite and square of "
             "size position_dim or dim");
    }
  }
}

double required_separation_from_m(const SearchProblem& problem, const Pose2& start, double height_m,
                                  const models::Trajectory& other) {
  // Steps are checked along chords, which deviate from the path. This margin keeps the deviation
  // from forbidding every motion away from the teammate.
  constexpr double kChords_m = 0.01;
  const double other_height_m = problem.separation_from_above ? height_m : other.height_m;
  Eigen::Vector3d away_m;
  away_m << models::at(other, problem.start_time).world_from_body.position_m() - start.position_m(),
      other_height_m - height_m;
  return std::min(problem.separation_m, std::max(0.0, away_m.norm() - kChords_m));
}

// Evaluates the robot's own sensors for `target` with the belief `belief`. Adds information about
// the position to `M`; information about the full state updates `belief` immediately. Returns true
// if there is any information.
bool add_own_information(const SearchProblem& problem, const SearchTarget& target,
                         const Pose2& pose, models::Gaussian& belief, models::PositionMatrix& M) {
  const models::PositionVector mean_m = belief.mean.head(target.model.position_dim);
  const models::World* const world = sight_world(problem);
  if (world != nullptr && !models::line_of_sight(*world, pose.position_m(), mean_m.head<2>())) {
    return false;
  }
  bool is_measured = false;
  for (const models::SensorModel& sensor : problem.sensors) {
    const models::Viewpoint from{pose, problem.height_m};
    if (models::measures_velocity(sensor) && target.model.has_velocity()) {
      const models::StateMatrix information = models::state_information(sensor, from, belief.mean);
      is_measured = is_measured || !information.isZero(0.0);
      belief.covariance = models::update_state_covariance(belief.covariance, information);
    } else {
      const models::PositionMatrix information = models::information(sensor, from, mean_m);
      is_measured = is_measured || !information.isZero(0.0);
      M += information;
    }
  }
  return is_measured;
}

double cost_of(const SearchProblem& problem, const models::Gaussian& belief) {
  return problem.cost == CostKind::kLogDet ? models::log_det(belief.covariance)
                                           : belief.covariance.trace();
}

// Predicts the belief of target m from depth t to the next depth, and updates it with the
// information at that depth. Returns true if the robot's own sensors give information.
bool step_belief(const SearchProblem& problem, std::size_t m, std::size_t t, const Pose2& pose,
                 models::Gaussian& belief) {
  const SearchTarget& target = problem.targets[m];
  const int p = target.model.position_dim;
  belief = models::predict(belief, target.model, problem.step_s);
  models::PositionMatrix M = models::PositionMatrix::Zero(p, p);
  if (!problem.fixed_information.empty() && problem.fixed_information[m][t].size() > 0) {
    const models::StateMatrix& fixed = problem.fixed_information[m][t];
    if (fixed.rows() == p) {
      M += fixed;
    } else {
      belief.covariance = models::update_state_covariance(belief.covariance, fixed);
    }
  }
  const bool is_measured = add_own_information(problem, target, pose, belief, M);
  belief.covariance = models::update_covariance(belief.covariance, M);
  return is_measured;
}

}  // namespace

void require_valid(const SearchProblem& problem) {
  demand(problem.horizon_steps >= 1 && problem.horizon_steps <= 255,
         "search: horizon_steps must be in [1, 255]");
  demand(is_positive(problem.step_s), "search: step_s must be > 0");
  demand(!problem.controls.empty() && problem.controls.size() <= kMaxControls,
         "search: must have 1 to 64 controls");
  for (const models::UnicycleControl& control : problem.controls) {
    demand(is_not_negative(control.speed_mps) && std::isfinite(control.yaw_rate_radps),
           "search: controls must be finite, with speeds ≥ 0");
  }
  demand(is_finite(problem.start) && std::isfinite(problem.height_m),
         "search: the start must be finite");
  demand(is_not_negative(problem.start_speed_mps), "search: start_speed_mps must be ≥ 0");
  demand(is_not_negative(problem.brake_mps2), "search: brake_mps2 must be ≥ 0");
  demand(is_not_negative(problem.clearance_m), "search: clearance_m must be ≥ 0");
  demand(is_not_negative(problem.separation_m), "search: separation_m must be ≥ 0");
  demand(problem.field == nullptr || problem.world != nullptr,
         "search: a distance field requires a world");
  for (const models::SensorModel& sensor : problem.sensors) {
    require_valid(sensor);
  }
  demand(problem.targets.size() < 65'535, "search: must have fewer than 65535 targets");
  for (const SearchTarget& target : problem.targets) {
    require_valid(target);
  }
  require_valid_information(problem);
  demand(index(problem.terminal.target_count()) <= problem.targets.size(),
         "search: each stop of the terminal value must name a target of the problem");
}

void SearchResult::reset() {
  found = false;
  controls.clear();
  poses.clear();
  history.clear();
  cost = kInfinity;
  moving_steps = 0;
  lower_bound = -kInfinity;
  has_terminal_value = false;
  epsilon = kInfinity;
  delta_m = kInfinity;
  passes = 0;
  nodes_generated = 0;
  nodes_expanded = 0;
  work_nodes = 0;
  peak_bytes = 0;
  stop_reason = StopReason::kFinished;
}

models::Trajectory to_trajectory(const SearchProblem& problem, const SearchResult& result) {
  return to_trajectory(problem, result.controls);
}

models::Trajectory to_trajectory(const SearchProblem& problem, std::span<const int> controls) {
  models::Trajectory trajectory;
  trajectory.start_time = problem.start_time;
  trajectory.start = problem.start;
  trajectory.height_m = problem.height_m;
  double speed_mps = problem.start_speed_mps;
  for (const int c : controls) {
    const models::UnicycleControl& control = problem.controls[index(c)];
    trajectory.segments.push_back({control, problem.step_s, 0.0});
    speed_mps = control.speed_mps;
  }
  if (problem.brake_mps2 > 0.0 && speed_mps > 0.0) {
    for (const models::PlanSegment& segment : models::brake(speed_mps, problem.brake_mps2)) {
      trajectory.segments.push_back(segment);
    }
  }
  return trajectory;
}

double score(const SearchProblem& problem, const std::vector<Pose2>& poses) {
  double cost = terminal_cost(problem, poses);
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    models::Gaussian belief = problem.targets[m].prior;
    for (std::size_t t = 0; t < poses.size(); ++t) {
      step_belief(problem, m, t, poses[t], belief);
      cost += cost_of(problem, belief);
    }
  }
  return cost;
}

double terminal_cost(const SearchProblem& problem, const std::vector<Pose2>& poses) {
  if (problem.terminal.is_empty() || poses.empty()) {
    return 0.0;
  }
  std::vector<std::uint16_t> measured;
  std::vector<double> costs;
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const SearchTarget& target = problem.targets[m];
    models::Gaussian belief = target.prior;
    bool is_measured = false;
    for (std::size_t t = 0; t + 1 < poses.size(); ++t) {
      is_measured = step_belief(problem, m, t, poses[t], belief) || is_measured;
    }
    if (is_measured) {
      measured.push_back(static_cast<std::uint16_t>(m));
      costs.push_back(cost_of(problem, belief));
    }
  }
  return problem.terminal.at(
      problem.terminal.rest(measured, [&](std::size_t k) { return costs[k]; }),
      poses.back().position_m());
}

double required_separation_m(const SearchProblem& problem, std::size_t i) {
  return required_separation_from_m(problem, problem.start, problem.height_m, problem.teammates[i]);
}

double required_separation_m(const SearchProblem& problem, const models::Trajectory& own,
                             const models::Trajectory& other) {
  return required_separation_from_m(problem, own.start, own.height_m, other);
}

}  // namespace vantage::planner
