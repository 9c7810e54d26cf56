#include "test/planner/problem/mapping_problem.hpp"

#include "test/planner/problem/random_problem.hpp"

namespace vantage::test {

planner::OwnedProblem known_mapping_problem() {
  return experiments::landmark_problem({3.0, 3.0, 0.0});
}

planner::OwnedProblem random_landmark_problem(std::uint64_t seed, int landmarks) {
  planner::OwnedProblem owned = experiments::random_start_problem(seed);
  std::mt19937_64 rng(0xD1B54A32D192ED03U * (seed + 1));
  const planner::SearchTarget pattern = owned.problem.targets.front();
  owned.problem.targets.clear();
  while (static_cast<int>(owned.problem.targets.size()) < landmarks) {
    planner::SearchTarget target = pattern;
    target.prior.mean = Eigen::Vector2d(uniform(rng, 0.0, 10.0), uniform(rng, 0.0, 10.0));
    if (models::clearance_m(*owned.world, target.prior.mean.head<2>()) > 0.05) {
      owned.problem.targets.push_back(target);
    }
  }
  return owned;
}

}  // namespace vantage::test
