#include "test/bench/tracking_family.hpp"

#include <random>

#include <fmt/format.h>

#include "planner/tour/tour_planner.hpp"

namespace vantage::bench {

tools::PlanningProblem tracking_problem(int targets, std::uint64_t seed, double fov_deg) {
  std::mt19937_64 rng(1'000 * seed + static_cast<std::uint64_t>(targets));
  const auto within = [&](double most) {
    return most * (2.0 * std::generate_canonical<double, 53>(rng) - 1.0);
  };
  tools::PlanningProblem drawn;
  drawn.name = fmt::format("M{}_s{}", targets, seed);
  drawn.world = std::make_unique<models::World>();
  drawn.world->bounds = {{-32.0, -32.0}, {32.0, 32.0}};
  drawn.field = std::make_unique<models::DistanceField>(*drawn.world, 0.1);
  planner::SearchProblem& problem = drawn.problem;
  problem.world = drawn.world.get();
  problem.field = drawn.field.get();
  problem.horizon_steps = 12;
  problem.controls = models::standard_primitives();
  models::SensorModel sensor;
  sensor.range_max_m = 10.0;
  sensor.range_min_m = 1e-3;
  sensor.fov_rad = radians(fov_deg);
  problem.sensors = {sensor};
  for (int m = 0; m < targets; ++m) {
    planner::SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.001}, {}};
    target.prior.mean = Eigen::Vector4d::Zero();
    for (int i = 0; i < 4; ++i) {
      target.prior.mean(i) = within(i < 2 ? 20.0 : 0.5);
    }
    target.prior.covariance = Eigen::Vector4d(1.0, 1.0, 0.1, 0.1).asDiagonal();
    problem.targets.push_back(target);
  }
  return drawn;
}

std::vector<tools::PlanningProblem> hundred_problems(double fov_deg, std::uint64_t first_seed) {
  std::vector<tools::PlanningProblem> problems;
  for (std::uint64_t seed = first_seed; seed < first_seed + 20; ++seed) {
    for (const int targets : {1, 3, 9, 16, 25}) {
      problems.push_back(tracking_problem(targets, seed, fov_deg));
    }
  }
  return problems;
}

void add_tour(planner::SearchProblem& problem) {
  planner::TourPlanner tours(static_cast<int>(problem.targets.size()));
  tours.plan(problem, {}, {120.0, 1.0, 1.0});
  problem.terminal = tours.terminal_value();
}

}  // namespace vantage::bench
