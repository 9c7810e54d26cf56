#include "test/planner/mapping_problem.hpp"

namespace vantage::test {
namespace {

Eigen::Vector2d anywhere_free(std::mt19937_64& rng, const models::World& world) {
  while (true) {
    const Eigen::Vector2d p_m(uniform(rng, 0.0, 10.0), uniform(rng, 0.0, 10.0));
    if (models::clearance_m(world, p_m) > 0.05) {
      return p_m;
    }
  }
}

void add_landmark(planner::SearchProblem& problem, const Eigen::Vector2d& at_m) {
  planner::SearchTarget target{{models::TargetKind::kStatic, 2, 0.0}, {}};
  target.prior.mean = at_m;
  target.prior.covariance = 0.25 * Eigen::Matrix2d::Identity();
  problem.targets.push_back(target);
}

}  // namespace

OwnedProblem mapping_problem(const Pose2& start) {
  OwnedProblem owned;
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
    add_landmark(problem, at_m);
  }
  return owned;
}

OwnedProblem known_mapping_problem() { return mapping_problem({3.0, 3.0, 0.0}); }

OwnedProblem random_mapping_problem(std::uint64_t seed) {
  OwnedProblem owned = mapping_problem({});
  std::mt19937_64 rng(0x9E3779B97F4A7C15U * (seed + 1));
  const Eigen::Vector2d at_m = anywhere_free(rng, *owned.world);
  owned.problem.start = {at_m.x(), at_m.y(), uniform(rng, -kPi, kPi)};
  return owned;
}

OwnedProblem random_landmark_problem(std::uint64_t seed, int landmarks) {
  OwnedProblem owned = random_mapping_problem(seed);
  std::mt19937_64 rng(0xD1B54A32D192ED03U * (seed + 1));
  owned.problem.targets.clear();
  for (int m = 0; m < landmarks; ++m) {
    add_landmark(owned.problem, anywhere_free(rng, *owned.world));
  }
  return owned;
}

}  // namespace vantage::test
