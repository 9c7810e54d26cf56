#include "experiments/decisions/energy_trial.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/uniform.hpp"

namespace vantage::experiments {
namespace {

double side_m(int n) { return 40.0 + 20.0 * (n - 2) / 8.0; }

std::vector<models::UnicycleControl> primitives() {
  std::vector<models::UnicycleControl> controls;
  for (const double speed_mps : {0.0, 8.0}) {
    for (const double yaw_rate_radps : {0.0, kPi / 2.0, -kPi / 2.0}) {
      controls.push_back({speed_mps, yaw_rate_radps});
    }
  }
  return controls;
}

models::SensorModel sensor_of(double range_max_m, double fov_rad) {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRangeBearing;
  sensor.range_max_m = range_max_m;
  sensor.fov_rad = fov_rad;
  sensor.range_sigma_m = 0.1;
  sensor.bearing_sigma_rad = radians(5.0);
  sensor.variance_grows_with_range = true;
  return sensor;
}

Eigen::Vector2d draw_position(std::mt19937_64& rng, double side) {
  const double x_m = uniform(rng, 0.0, side);
  return {x_m, uniform(rng, 0.0, side)};
}

Pose2 draw_start(std::mt19937_64& rng, const Eigen::Vector2d& at_m) {
  return {at_m.x(), at_m.y(), uniform(rng, -kPi, kPi)};
}

planner::SearchTarget draw_moving_target(std::mt19937_64& rng, double side,
                                         const EnergyTrialOptions& options) {
  constexpr double kSpeedMax_mps = 2.0;
  planner::SearchTarget target;
  target.model = {models::TargetKind::kDoubleIntegrator, 2, options.acceleration_q};
  const Eigen::Vector2d at_m = draw_position(rng, side);
  const double speed_mps = uniform(rng, 0.0, kSpeedMax_mps);
  const double heading_rad = uniform(rng, -kPi, kPi);
  target.prior.mean = models::StateVector(4);
  target.prior.mean << at_m, speed_mps * std::cos(heading_rad), speed_mps * std::sin(heading_rad);
  const double position_m2 = options.prior_position_sigma_m * options.prior_position_sigma_m;
  const double velocity_m2ps2 = options.prior_velocity_sigma_mps * options.prior_velocity_sigma_mps;
  target.prior.covariance = models::StateMatrix::Zero(4, 4);
  target.prior.covariance.diagonal() << position_m2, position_m2, velocity_m2ps2, velocity_m2ps2;
  return target;
}

planner::SearchTarget draw_static_target(std::mt19937_64& rng, double side,
                                         const EnergyTrialOptions& options) {
  planner::SearchTarget target;
  target.model = {models::TargetKind::kStatic, 2, 0.0};
  target.prior.mean = draw_position(rng, side);
  target.prior.covariance = models::StateMatrix::Identity(2, 2) * options.prior_position_sigma_m *
                            options.prior_position_sigma_m;
  return target;
}

// Returns a trial without robots and targets, with the parameters that all robots' problems share.
EnergyTrial trial_in(const models::World& world, int horizon_steps) {
  EnergyTrial trial;
  trial.world = std::make_unique<models::World>(world);
  trial.team.horizon_steps = horizon_steps;
  trial.team.step_s = 0.5;
  return trial;
}

void add_robot(EnergyTrial& trial, const Pose2& start, const models::SensorModel& sensor,
               const planner::EnergyModel& energy, const planner::CandidateOptions& options,
               planner::ReducedValueIteration& search) {
  planner::SearchProblem problem;
  problem.start = start;
  problem.horizon_steps = trial.team.horizon_steps;
  problem.step_s = trial.team.step_s;
  problem.controls = primitives();
  problem.sensors = {sensor};
  problem.targets = trial.team.targets;
  problem.world = trial.world.get();
  trial.team.candidates.push_back(candidate_trajectories(problem, energy, search, options));
  trial.robots.push_back(std::move(problem));
  trial.energy.push_back(energy);
}

std::mt19937_64 generator(std::uint64_t seed, std::uint32_t stream) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                         stream};
  return std::mt19937_64(sequence);
}

}  // namespace

EnergyTrial draw_energy_trial(int n, std::uint64_t seed, const EnergyTrialOptions& options,
                              planner::ReducedValueIteration& search) {
  std::mt19937_64 rng = generator(seed, static_cast<std::uint32_t>(n));
  const double side = side_m(n);
  models::World world;
  world.bounds = {{0.0, 0.0}, {side, side}};
  EnergyTrial trial = trial_in(world, 10);
  for (int m = 0; m < n; ++m) {
    trial.team.targets.push_back(draw_moving_target(rng, side, options));
  }
  for (int i = 1; i <= n; ++i) {
    const Pose2 start = draw_start(rng, draw_position(rng, side));
    add_robot(trial, start, sensor_of(6.0, radians(160.0)),
              {static_cast<double>(i), 0.0, 1.0, 2.0, {}}, {1.0, 2.0, options.yaw_weight_m_per_rad},
              search);
  }
  return trial;
}

models::World heterogeneous_world() {
  models::World world;
  world.bounds = {{0.0, 0.0}, {100.0, 100.0}};
  world.regions = {{"mud", {{40.0, 0.0}, {100.0, 60.0}}, 3.0},
                   {"wind", {{30.0, 40.0}, {100.0, 100.0}}, 3.0}};
  return world;
}

EnergyTrial draw_heterogeneous_trial(std::uint64_t seed, const HeterogeneousTrialOptions& options,
                                     planner::ReducedValueIteration& search) {
  constexpr int kTargets = 10;
  constexpr std::uint32_t kStream = 0xD3;
  std::mt19937_64 rng = generator(seed, kStream);
  EnergyTrial trial = trial_in(heterogeneous_world(), options.horizon_steps);
  const double side = trial.world->bounds.max_m.x();
  for (int m = 0; m < kTargets; ++m) {
    trial.team.targets.push_back(draw_static_target(rng, side, options.open));
  }
  const planner::EnergyModel ground{options.price_nats, 0.0, 1.0, 2.0, {"mud"}};
  const planner::EnergyModel air{options.price_nats, 2.0, 2.0, 4.0, {"wind"}};
  for (const bool is_flying : {false, false, true}) {
    Eigen::Vector2d at_m = draw_position(rng, side);
    while (models::region_cost(*trial.world, at_m) > 0.0) {
      at_m = draw_position(rng, side);
    }
    add_robot(trial, draw_start(rng, at_m),
              is_flying ? sensor_of(20.0, 2.0 * kPi) : sensor_of(15.0, radians(160.0)),
              is_flying ? air : ground, {1.0, 4.0, options.open.yaw_weight_m_per_rad}, search);
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

}  // namespace vantage::experiments
