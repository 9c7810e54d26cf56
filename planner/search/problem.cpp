#include "planner/search/problem.hpp"

#include <cmath>

#include "core/check.hpp"
#include "planner/search/expander.hpp"

namespace vantage::planner {

void require_valid(const SearchProblem& problem) {
  require(problem.horizon_steps >= 1 && problem.horizon_steps <= 255,
          "search: horizon_steps must be in [1, 255]");
  require(problem.step_s > 0.0 && std::isfinite(problem.step_s), "search: step_s must be > 0");
  require(!problem.controls.empty() && problem.controls.size() <= kMaxControls,
          "search: between 1 and 64 controls");
  require(problem.targets.size() < 65'535, "search: fewer than 65535 targets");
  for (const SearchTarget& target : problem.targets) {
    require(target.prior.mean.size() == target.model.dim() &&
                target.prior.covariance.rows() == target.model.dim() &&
                target.prior.covariance.cols() == target.model.dim(),
            "search: a prior's dimensions must be its target model's");
    require(std::isfinite(models::log_det(target.prior.covariance)),
            "search: a prior covariance must be positive definite");
  }
  require(problem.fixed_information.empty() ||
              problem.fixed_information.size() == problem.targets.size(),
          "search: fixed_information is for every target or for none");
}

models::Trajectory to_trajectory(const SearchProblem& problem, const SearchResult& result) {
  models::Trajectory trajectory;
  trajectory.start_time = problem.start_time;
  trajectory.start = problem.start;
  trajectory.height_m = problem.height_m;
  double speed_mps = problem.start_speed_mps;
  for (const int c : result.controls) {
    const models::UnicycleControl& control = problem.controls[static_cast<std::size_t>(c)];
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
  double cost = 0.0;
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const SearchTarget& target = problem.targets[m];
    const models::StateMatrix A = target.model.transition(problem.step_s);
    const models::StateMatrix W = target.model.process_noise(problem.step_s);
    const int p = target.model.position_dim;
    models::Gaussian belief = target.prior;
    for (std::size_t t = 0; t < poses.size(); ++t) {
      belief = models::predict(belief, A, W);
      models::PositionMatrix M = models::PositionMatrix::Zero(p, p);
      if (!problem.fixed_information.empty() && problem.fixed_information[m][t].size() > 0) {
        M += problem.fixed_information[m][t];
      }
      const models::PositionVector mean_m = belief.mean.head(p);
      if (problem.world == nullptr ||
          models::line_of_sight(*problem.world, poses[t].position_m(), mean_m.head<2>())) {
        for (const models::SensorModel& sensor : problem.sensors) {
          M += models::information(sensor, {poses[t], problem.height_m}, mean_m);
        }
      }
      belief.covariance = models::update_covariance(belief.covariance, M);
      cost += problem.cost == CostKind::kLogDet ? models::log_det(belief.covariance)
                                                : belief.covariance.trace();
    }
  }
  return cost;
}

}  // namespace vantage::planner
