#include "test/planner/search/lattice_problem.hpp"

#include <random>

#include "core/angle.hpp"

namespace vantage::test {

using planner::SearchProblem;
using planner::SearchTarget;

OwnedProblem lattice_problem(std::uint64_t seed) {
  std::mt19937_64 rng(0x2545F4914F6CDD1DU * (seed + 1));
  OwnedProblem owned;
  SearchProblem& problem = owned.problem;
  problem.start = {uniform(rng, -3.0, 3.0), uniform(rng, -3.0, 3.0), uniform(rng, -kPi, kPi)};
  problem.horizon_steps = pick(rng, 2, 5);
  const double turn_radps = uniform(rng, 0.4, 3.0);
  const double speed_mps = uniform(rng, 0.1, 3.0);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, turn_radps}, {0.5 * speed_mps, -turn_radps}};
  if (problem.horizon_steps < 5) {
    problem.controls.push_back({pick(rng, 0, 1) * speed_mps, 2.0 * turn_radps});
  }
  models::SensorModel sensor;
  const models::SensorKind kinds[] = {
      models::SensorKind::kRangeBearing, models::SensorKind::kRangeBearing,
      models::SensorKind::kBearing, models::SensorKind::kRange, models::SensorKind::kPosition};
  for (int i = pick(rng, 0, 3) == 0 ? 2 : 1; i > 0; --i) {
    sensor.kind = kinds[pick(rng, 0, 4)];
    sensor.range_max_m = uniform(rng, 1.0, 6.0);
    sensor.range_min_m = pick(rng, 0, 1) == 0 ? 1e-3 : uniform(rng, 0.05, 0.8);
    sensor.variance_grows_with_range = pick(rng, 0, 2) == 0;
    sensor.fov_rad = pick(rng, 0, 2) == 0 ? 2.0 * kPi : radians(uniform(rng, 30.0, 330.0));
    problem.sensors.push_back(sensor);
  }
  for (int m = pick(rng, 1, 4); m > 0; --m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, uniform(rng, 0.0, 0.01)}, {}};
    if (pick(rng, 0, 2) == 0) {
      target.model = {models::TargetKind::kRandomWalk, 2, uniform(rng, 0.0, 0.05)};
    }
    const int n = target.model.dim();
    target.prior.mean = models::StateVector::Zero(n);
    for (int i = 0; i < n; ++i) {
      target.prior.mean(i) = i < 2 ? uniform(rng, -6.0, 6.0) : uniform(rng, -0.4, 0.4);
    }
    if (pick(rng, 0, 1) == 0) {
      const auto& control = problem.controls[rng() % problem.controls.size()];
      const int t = pick(rng, 1, problem.horizon_steps);
      const Eigen::Vector2d p_m =
          models::step_unicycle(problem.start, control, t * problem.step_s).position_m();
      for (int i = 0; i < 2; ++i) {
        const double drift_m = n == 4 ? t * problem.step_s * target.prior.mean(i + 2) : 0.0;
        target.prior.mean(i) = p_m(i) - drift_m + uniform(rng, -0.02, 0.02);
      }
    }
    target.prior.covariance = random_spd(rng, n, uniform(rng, 0.1, 2.0), 1.0);
    problem.targets.push_back(target);
  }
  if (pick(rng, 0, 3) == 0) {
    for (std::size_t m = 0; m < problem.targets.size(); ++m) {
      problem.fixed_information.emplace_back();
      for (int t = 0; t < problem.horizon_steps; ++t) {
        problem.fixed_information.back().emplace_back(random_spd(rng, 2, 20.0, 2.0));
      }
    }
  }
  let_one_in_three_oscillate(seed, rng, problem);
  return owned;
}

}  // namespace vantage::test
