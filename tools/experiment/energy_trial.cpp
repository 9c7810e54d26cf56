#include "tools/experiment/energy_trial.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace vantage::tools {
namespace {

// As std::uniform_real_distribution, which is not the same everywhere.
double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng() >> 11U) * 0x1p-53;
}

double side_m(int n) { return 40.0 + 20.0 * (n - 2) / 8.0; }

std::vector<models::UnicycleControl> ground_primitives() {
  std::vector<models::UnicycleControl> controls;
  for (const double speed_mps : {0.0, 8.0}) {
    for (const double yaw_rate_radps : {0.0, kPi / 2.0, -kPi / 2.0}) {
      controls.push_back({speed_mps, yaw_rate_radps});
    }
  }
  return controls;
}

models::SensorModel ground_sensor() {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRangeBearing;
  sensor.range_max_m = 6.0;
  sensor.fov_rad = radians(160.0);
  sensor.range_sigma_m = 0.1;
  sensor.bearing_sigma_rad = radians(5.0);
  sensor.variance_grows_with_range = true;
  return sensor;
}

planner::SearchTarget draw_target(std::mt19937_64& rng, double side,
                                  const EnergyTrialOptions& options) {
  constexpr double kSpeedMax_mps = 2.0;
  planner::SearchTarget target;
  target.model = {models::TargetKind::kDoubleIntegrator, 2, options.acceleration_q};
  const double x_m = uniform(rng, 0.0, side);
  const double y_m = uniform(rng, 0.0, side);
  const double speed_mps = uniform(rng, 0.0, kSpeedMax_mps);
  const double heading_rad = uniform(rng, -kPi, kPi);
  target.prior.mean = models::StateVector(4);
  target.prior.mean << x_m, y_m, speed_mps * std::cos(heading_rad),
      speed_mps * std::sin(heading_rad);
  const double position_m2 = options.prior_position_sigma_m * options.prior_position_sigma_m;
  const double velocity_m2ps2 = options.prior_velocity_sigma_mps * options.prior_velocity_sigma_mps;
  target.prior.covariance = models::StateMatrix::Zero(4, 4);
  target.prior.covariance.diagonal() << position_m2, position_m2, velocity_m2ps2, velocity_m2ps2;
  return target;
}

}  // namespace

EnergyTrial draw_energy_trial(int n, std::uint64_t seed, const EnergyTrialOptions& options,
                              planner::ReducedValueIteration& search) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                         static_cast<std::uint32_t>(n)};
  std::mt19937_64 rng(sequence);
  const double side = side_m(n);
  EnergyTrial trial;
  trial.world = std::make_unique<models::World>();
  trial.world->bounds = {{0.0, 0.0}, {side, side}};

  planner::SearchProblem problem;
  problem.horizon_steps = 10;
  problem.step_s = 0.5;
  problem.controls = ground_primitives();
  problem.sensors = {ground_sensor()};
  problem.world = trial.world.get();
  for (int m = 0; m < n; ++m) {
    problem.targets.push_back(draw_target(rng, side, options));
  }
  trial.team.targets = problem.targets;
  trial.team.horizon_steps = problem.horizon_steps;
  trial.team.step_s = problem.step_s;
  for (int i = 1; i <= n; ++i) {
    const double x_m = uniform(rng, 0.0, side);
    const double y_m = uniform(rng, 0.0, side);
    problem.start = {x_m, y_m, uniform(rng, -kPi, kPi)};
    const planner::EnergyModel energy{static_cast<double>(i), 0.0, 1.0, 2.0, {}};
    trial.team.candidates.push_back(planner::candidate_trajectories(
        problem, energy, search, {1.0, 2.0, options.yaw_weight_m_per_rad}));
    trial.robots.push_back(problem);
  }
  return trial;
}

planner::TeamProblem best_share(const planner::TeamOracle& oracle, double share) {
  planner::TeamProblem team = oracle.problem();
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    const auto sorted = oracle.by_value(robot);
    const auto kept = std::min(
        sorted.size(), static_cast<std::size_t>(std::ceil(
                           share * static_cast<double>(std::max<std::size_t>(1, sorted.size())))));
    auto& candidates = team.candidates[static_cast<std::size_t>(robot)];
    candidates.clear();
    for (const planner::CandidateId id : sorted.first(kept)) {
      candidates.push_back(oracle.candidate(id));
    }
  }
  return team;
}

}  // namespace vantage::tools
