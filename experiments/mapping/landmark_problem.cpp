#include "experiments/mapping/landmark_problem.hpp"

#include <random>

#include "core/uniform.hpp"

namespace vantage::experiments {
namespace {

Eigen::Vector2d anywhere_free(std::mt19937_64& rng, const models::World& world) {
  while (true) {
    const double y_m = uniform(rng, 0.0, 10.0);
    const Eigen::Vector2d at_m(uniform(rng, 0.0, 10.0), y_m);
    if (models::clearance_m(world, at_m) > 0.05) {
      return at_m;
    }
  }
}

}  // namespace

planner::OwnedProblem landmark_problem(const Pose2& start) {
  planner::OwnedProblem owned;
  owned.world = std::make_unique<models::World>();
  owned.world->bounds = {{0.0, 0.0}, {10.0, 10.0}};
  owned.world->obstacles = {{{{3.885, 0.825}, {5.925, 2.865}}, 10.0},
                            {{{3.885, 3.885}, {5.925, 5.925}}, 10.0},
                            {{{3.885, 6.945}, {5.925, 8.975}}, 10.0}};
  owned.field = std::make_unique<models::DistanceField>(*owned.world, 0.05);
  planner::SearchProblem& problem = owned.problem;
  problem.world = owned.world.get();
  problem.field = owned.field.get();
  problem.start = start;
  problem.controls = models::standard_primitives();
  problem.horizon_steps = 12;
  problem.cost = planner::CostKind::kTrace;
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRange;
  sensor.range_max_m = 1.0;
  sensor.range_sigma_m = 0.15;
  problem.sensors = {sensor};
  for (const Eigen::Vector2d& at_m :
       {Eigen::Vector2d(3.5, 6.8), Eigen::Vector2d(3.5, 2.2), Eigen::Vector2d(6.5, 2.2),
        Eigen::Vector2d(6.5, 6.8), Eigen::Vector2d(3.5, 4.0), Eigen::Vector2d(6.5, 4.8)}) {
    planner::SearchTarget target{{models::TargetKind::kStatic, 2, 0.0}, {}};
    target.prior.mean = at_m;
    target.prior.covariance = 0.25 * Eigen::Matrix2d::Identity();
    problem.targets.push_back(target);
  }
  return owned;
}

planner::OwnedProblem random_start_problem(std::uint64_t seed) {
  planner::OwnedProblem owned = landmark_problem({});
  std::mt19937_64 rng(0x9E3779B97F4A7C15U * (seed + 1));
  const Eigen::Vector2d at_m = anywhere_free(rng, *owned.world);
  owned.problem.start = {at_m.x(), at_m.y(), uniform(rng, -kPi, kPi)};
  return owned;
}

planner::OwnedProblem moving_target_problem() {
  planner::OwnedProblem owned = landmark_problem({2.0, 2.0, 0.8});
  owned.world->obstacles.clear();
  *owned.field = models::DistanceField(*owned.world, 0.05);
  planner::SearchProblem& problem = owned.problem;
  problem.horizon_steps = 6;
  problem.sensors[0].range_max_m = 2.0;
  problem.targets.resize(1);
  problem.targets[0].model = {models::TargetKind::kDoubleIntegrator, 2, 0.001};
  problem.targets[0].prior.mean = Eigen::Vector4d(6.5, 6.0, 0.2, -0.2);
  problem.targets[0].prior.covariance = Eigen::Vector4d(0.25, 0.25, 0.05, 0.05).asDiagonal();
  return owned;
}

}  // namespace vantage::experiments
