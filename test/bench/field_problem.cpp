#include "test/bench/field_problem.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace vantage::bench {

planner::SearchProblem field_problem(int targets, int horizon_steps, std::uint64_t seed) {
  // More than 25 targets have the density of 25 targets.
  const double half_m = 32.0 * std::sqrt(std::max(1.0, targets / 25.0));
  std::mt19937_64 rng(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(rng);
  };
  planner::SearchProblem problem;
  problem.horizon_steps = horizon_steps;
  problem.controls = models::standard_primitives();
  models::SensorModel sensor;
  sensor.range_max_m = 10.0;
  sensor.range_min_m = 0.01;
  sensor.fov_rad = radians(94.0);
  problem.sensors = {sensor};
  for (int m = 0; m < targets; ++m) {
    planner::SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.001}, {}};
    const double course_rad = uniform(-kPi, kPi);
    target.prior.mean = Eigen::Vector4d(uniform(-half_m, half_m), uniform(-half_m, half_m),
                                        0.5 * std::cos(course_rad), 0.5 * std::sin(course_rad));
    target.prior.covariance = Eigen::Vector4d(1.0, 1.0, 0.1, 0.1).asDiagonal();
    problem.targets.push_back(target);
  }
  return problem;
}

planner::OwnedProblem obstructed_problem(int targets, int horizon_steps, int obstacles,
                                         std::uint64_t seed) {
  planner::OwnedProblem owned;
  owned.problem = field_problem(targets, horizon_steps, seed);
  if (obstacles == 0) {
    return owned;
  }
  owned.world = std::make_unique<models::World>();
  const double half_m = 32.0 * std::sqrt(std::max(1.0, targets / 25.0));
  owned.world->bounds = {{-half_m, -half_m}, {half_m, half_m}};
  std::mt19937_64 rng(1'000 + seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(rng);
  };
  while (static_cast<int>(owned.world->obstacles.size()) < obstacles) {
    const Eigen::Vector2d corner(uniform(-20.0, 20.0), uniform(-20.0, 20.0));
    const Eigen::Vector2d size(uniform(0.5, 3.0), uniform(0.5, 3.0));
    owned.world->obstacles.push_back({{corner, corner + size}, 10.0});
    if (models::clearance_m(*owned.world, Eigen::Vector2d::Zero()) < 1.0) {
      owned.world->obstacles.pop_back();
    }
  }
  owned.field = std::make_unique<models::DistanceField>(*owned.world, 0.1);
  owned.problem.world = owned.world.get();
  owned.problem.field = owned.field.get();
  owned.problem.clearance_m = 0.2;
  return owned;
}

}  // namespace vantage::bench
