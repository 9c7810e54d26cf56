#include "test/planner/problem/random_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/QR>

#include "test/support/own_target.hpp"

namespace vantage::test {
namespace {

constexpr double kLeavesMax = 700.0;

models::SensorModel random_sensor(std::mt19937_64& rng) {
  models::SensorModel sensor;
  sensor.kind = models::all_sensor_kinds()[static_cast<std::size_t>(pick(rng, 0, 4))];
  sensor.range_max_m = uniform(rng, 2.5, 9.0);
  sensor.fov_rad = pick(rng, 0, 2) == 0 ? 2.0 * kPi : radians(uniform(rng, 60.0, 260.0));
  sensor.range_sigma_m = uniform(rng, 0.05, 0.4);
  sensor.bearing_sigma_rad = radians(uniform(rng, 2.0, 10.0));
  sensor.position_sigma_m = uniform(rng, 0.05, 0.5);
  sensor.pixel_sigma = uniform(rng, 30.0, 100.0);  // large, so that few digits are lost
  sensor.depth_min_m = 1.0;
  sensor.camera_tilt_rad = radians(uniform(rng, 20.0, 90.0));
  sensor.variance_grows_with_range = pick(rng, 0, 1) == 1;
  if (pick(rng, 0, 2) == 0) {
    sensor.calibration = {uniform(rng, 0.9, 1.1), uniform(rng, -0.2, 0.2)};
  }
  if (sensor.kind == models::SensorKind::kBearing ||
      sensor.kind == models::SensorKind::kRangeBearing || pick(rng, 0, 3) == 0) {
    sensor.range_min_m = uniform(rng, 0.3, 0.6);
  }
  return sensor;
}

planner::SearchTarget random_target(std::mt19937_64& rng) {
  planner::SearchTarget target;
  target.model.kind = models::all_target_kinds()[static_cast<std::size_t>(pick(rng, 0, 3))];
  const bool moves = target.model.kind == models::TargetKind::kDoubleIntegrator;
  target.model.position_dim = moves || pick(rng, 0, 2) > 0 ? 2 : 3;
  target.model.q = target.model.kind == models::TargetKind::kStatic ? 0.0 : uniform(rng, 0.0, 0.05);
  constexpr double kDragAbove = 0.035;  // a third of the moving targets get a user-defined kind
  if (moves && target.model.q > kDragAbove) {
    target.model.kind = drag();
  }
  const int n = target.model.dim();
  target.prior.mean = models::StateVector::Zero(n);
  target.prior.mean(0) = uniform(rng, -5.0, 5.0);
  target.prior.mean(1) = uniform(rng, -5.0, 5.0);
  if (n == 3) {
    target.prior.mean(2) = uniform(rng, 0.0, 1.0);
  }
  if (moves) {
    target.prior.mean(2) = uniform(rng, -0.8, 0.8);
    target.prior.mean(3) = uniform(rng, -0.8, 0.8);
  }
  target.prior.covariance = random_spd(rng, n, uniform(rng, 0.2, 4.0), 1.5);
  return target;
}

std::vector<models::UnicycleControl> random_controls(std::mt19937_64& rng, int count) {
  // Because of hovering and turns on the spot, different paths reach equal poses.
  std::vector<models::UnicycleControl> pool = models::standard_primitives();
  for (const double yaw_rate_radps : {0.0, 1.0, -1.0}) {
    pool.push_back({0.0, yaw_rate_radps});
  }
  std::shuffle(pool.begin(), pool.end(), rng);
  pool.resize(static_cast<std::size_t>(count));
  return pool;
}

void add_world(std::mt19937_64& rng, OwnedProblem& owned) {
  constexpr double kHalf_m = 6.0;
  planner::SearchProblem& problem = owned.problem;
  problem.clearance_m = pick(rng, 0, 2) == 0 ? 0.0 : 0.2;
  owned.world = std::make_unique<models::World>();
  owned.world->bounds = {{-kHalf_m, -kHalf_m}, {kHalf_m, kHalf_m}};
  const int obstacles = pick(rng, 0, 4);
  while (static_cast<int>(owned.world->obstacles.size()) < obstacles) {
    const Eigen::Vector2d corner = random_point(rng, -5.0, 4.0);
    const Eigen::Vector2d size = random_point(rng, 0.2, 2.0);
    owned.world->obstacles.push_back({{corner, corner + size}, 10.0});
    if (models::clearance_m(*owned.world, problem.start.position_m()) < problem.clearance_m + 0.3) {
      owned.world->obstacles.pop_back();
    }
  }
  problem.world = owned.world.get();
  if (pick(rng, 0, 1) == 1) {
    owned.field = std::make_unique<models::DistanceField>(*owned.world, 0.1);
    problem.field = owned.field.get();
  }
  if (pick(rng, 0, 1) == 1) {
    problem.brake_mps2 = uniform(rng, 2.0, 8.0);
  }
}

void add_fixed_information(std::mt19937_64& rng, planner::SearchProblem& problem) {
  for (const planner::SearchTarget& target : problem.targets) {
    std::vector<models::StateMatrix> steps;
    for (int t = 0; t < problem.horizon_steps; ++t) {
      const int p = target.model.position_dim;
      switch (pick(rng, 0, 2)) {
        case 0:
          steps.emplace_back();
          break;
        case 1:
          steps.emplace_back(models::PositionMatrix::Zero(p, p));
          break;
        default:
          steps.emplace_back(random_spd(rng, p, 20.0, 2.0));
      }
    }
    problem.fixed_information.push_back(steps);
  }
}

}  // namespace

double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * std::generate_canonical<double, 53>(rng);
}

Eigen::Vector2d random_point(std::mt19937_64& rng, double low, double high) {
  const double y = uniform(rng, low, high);
  const double x = uniform(rng, low, high);
  return {x, y};
}

int pick(std::mt19937_64& rng, int low, int high) {
  return low + static_cast<int>(rng() % static_cast<std::uint64_t>(high - low + 1));
}

Eigen::MatrixXd random_spd(std::mt19937_64& rng, int n, double scale, double decades) {
  Eigen::MatrixXd X(n, n);
  Eigen::VectorXd eigenvalues(n);
  for (int i = 0; i < n; ++i) {
    eigenvalues(i) = scale * std::pow(10.0, -uniform(rng, 0.0, decades));
    for (int j = 0; j < n; ++j) {
      X(i, j) = uniform(rng, -1.0, 1.0);
    }
  }
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(X).householderQ();
  const Eigen::MatrixXd S = Q * eigenvalues.asDiagonal() * Q.transpose();
  return 0.5 * (S + S.transpose());
}

models::DampedOscillator random_oscillator(std::mt19937_64& rng) {
  models::DampedOscillator around;
  const double omega = uniform(rng, 0.1, 1.0);
  const bool is_alike = pick(rng, 0, 1) == 0;
  around.damping_per_s.setConstant(uniform(rng, 0.1, 1.5));
  for (Eigen::Index i = 0; i < 2; ++i) {
    around.center_m(i) = uniform(rng, -1.0, 1.0);
    // Powers of two keep σ_v/σ_p, and therefore A, exactly equal.
    around.position_sigma_m(i) =
        is_alike ? std::pow(2.0, pick(rng, -1, 2)) : uniform(rng, 0.5, 4.0);
    around.velocity_sigma_mps(i) = omega * around.position_sigma_m(i);
    if (!is_alike) {
      around.velocity_sigma_mps(i) *= uniform(rng, 0.5, 2.0);
      around.damping_per_s(i) *= uniform(rng, 0.5, 2.0);
    }
  }
  return around;
}

void let_oscillate(std::mt19937_64& rng, planner::SearchProblem& problem) {
  for (planner::SearchTarget& target : problem.targets) {
    if (target.model.kind == models::TargetKind::kDoubleIntegrator) {
      target.model.kind = models::TargetKind::kDampedOscillator;
      target.model.oscillator = random_oscillator(rng);
    }
  }
}

OwnedProblem random_problem(std::uint64_t seed) {
  std::mt19937_64 rng(0x9E3779B97F4A7C15U * (seed + 1));
  OwnedProblem owned;
  planner::SearchProblem& problem = owned.problem;
  problem.start = {uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -kPi, kPi)};
  problem.height_m = uniform(rng, 0.8, 2.5);
  problem.step_s = 0.5;
  problem.horizon_steps = pick(rng, 1, 5);
  const double controls_max = std::floor(std::pow(kLeavesMax, 1.0 / problem.horizon_steps));
  problem.controls =
      random_controls(rng, pick(rng, 2, static_cast<int>(std::min(controls_max, 8.0))));
  problem.cost = pick(rng, 0, 2) == 0 ? planner::CostKind::kTrace : planner::CostKind::kLogDet;
  problem.sensors.push_back(random_sensor(rng));
  if (pick(rng, 0, 2) == 0) {
    problem.sensors.push_back(random_sensor(rng));
  }
  const int targets = pick(rng, 1, 6);
  for (int m = 0; m < targets; ++m) {
    problem.targets.push_back(random_target(rng));
  }
  if (pick(rng, 0, 2) > 0) {
    add_world(rng, owned);
    problem.obstacles_block_sight = seed % 4 != 0;
  }
  if (pick(rng, 0, 2) == 0) {
    add_fixed_information(rng, problem);
  }
  if (seed % 2 == 0) {  // drawn last, so that other draws are unchanged
    let_oscillate(rng, problem);
  }
  return owned;
}

OwnedProblem smooth_problem(std::uint64_t seed) {
  std::mt19937_64 rng(0xD1B54A32D192ED03U * (seed + 1));
  OwnedProblem owned;
  planner::SearchProblem& problem = owned.problem;
  problem.horizon_steps = pick(rng, 2, 5);
  const double controls_max = std::floor(std::pow(kLeavesMax, 1.0 / problem.horizon_steps));
  problem.controls =
      random_controls(rng, pick(rng, 2, static_cast<int>(std::min(controls_max, 8.0))));
  problem.cost = pick(rng, 0, 1) == 0 ? planner::CostKind::kTrace : planner::CostKind::kLogDet;
  models::SensorModel sensor;
  sensor.kind =
      pick(rng, 0, 1) == 0 ? models::SensorKind::kRange : models::SensorKind::kRangeBearing;
  sensor.range_max_m = 1e6;
  sensor.range_sigma_m = uniform(rng, 0.3, 1.0);
  sensor.bearing_sigma_rad = radians(uniform(rng, 4.0, 10.0));
  problem.sensors.push_back(sensor);
  const int targets = pick(rng, 1, 4);
  for (int m = 0; m < targets; ++m) {
    planner::SearchTarget target = random_target(rng);
    target.model.position_dim = 2;
    target.model.q += 0.01;
    const int n = target.model.dim();
    const double bearing_rad = uniform(rng, -kPi, kPi);
    const double range_m = uniform(rng, 12.0, 20.0);
    target.prior.mean = models::StateVector::Zero(n);
    target.prior.mean(0) = range_m * std::cos(bearing_rad);
    target.prior.mean(1) = range_m * std::sin(bearing_rad);
    target.prior.covariance = random_spd(rng, n, uniform(rng, 0.2, 2.0), 1.0);
    problem.targets.push_back(target);
  }
  return owned;
}

void add_random_tour(std::mt19937_64& rng, planner::SearchProblem& problem) {
  std::vector<int> targets(problem.targets.size());
  std::iota(targets.begin(), targets.end(), 0);
  std::shuffle(targets.begin(), targets.end(), rng);
  targets.resize(static_cast<std::size_t>(pick(rng, 1, static_cast<int>(targets.size()))));
  const double speed_mps = uniform(rng, 0.5, 4.0);
  const double scale = std::pow(10.0, uniform(rng, -1.5, 1.0));
  std::vector<planner::TerminalValue::Stop> stops;
  std::vector<Eigen::Vector2d> positions_m;
  for (const int target : targets) {
    const Eigen::Vector2d position_m = random_point(rng, -9.0, 9.0);
    double after_s = 0.0;
    if (!stops.empty()) {
      after_s = stops.back().after_s + uniform(rng, 0.0, 1.0) +
                (position_m - positions_m.back()).norm() / speed_mps;
    }
    // At two of three stops, one measurement may not be enough: `done` is below `open`.
    const models::StateMatrix& prior =
        problem.targets[static_cast<std::size_t>(target)].prior.covariance;
    const bool is_log_det = problem.cost == planner::CostKind::kLogDet;
    const double now = is_log_det ? models::log_det(prior) : prior.trace();
    const double open = is_log_det ? now + uniform(rng, -1.0, 3.0) : now * uniform(rng, 0.5, 2.0);
    const double gain = pick(rng, 0, 2) == 0 ? 0.0 : uniform(rng, 0.0, 1.0);
    const double done = open - gain * (is_log_det ? 6.0 : open);
    stops.push_back({target, scale * uniform(rng, 0.0, 2.0), after_s, open, done});
    positions_m.push_back(position_m);
  }
  planner::TerminalValue::Fields fields;
  fields.side = pick(rng, 2, 30);
  const double half_m = uniform(rng, 1.0, 12.0);
  fields.cell_m = 2.0 * half_m / (fields.side - 1);
  fields.min_m = problem.start.position_m().array() - half_m;
  for (std::size_t i = 0; i < stops.size() && i < planner::TerminalValue::kFieldsMax; ++i) {
    for (int row = 0; row < fields.side; ++row) {
      for (int column = 0; column < fields.side; ++column) {
        const Eigen::Vector2d p_m = fields.min_m + fields.cell_m * Eigen::Vector2d(column, row);
        fields.times_s.push_back((p_m - positions_m[i]).norm() / speed_mps);
      }
    }
  }
  problem.terminal = {std::move(stops), std::move(fields)};
}

models::Trajectory random_teammate(std::mt19937_64& rng, Time around, int steps, double step_s) {
  models::Trajectory teammate;
  teammate.start_time = around + from_seconds(uniform(rng, -1.5, 0.5));
  teammate.start = {uniform(rng, -4.0, 4.0), uniform(rng, -4.0, 4.0), uniform(rng, -kPi, kPi)};
  teammate.height_m = 1.0;
  double speed_mps = 0.0;
  for (int t = 0; t < steps; ++t) {
    const std::vector<models::UnicycleControl> pool = models::standard_primitives();
    const models::UnicycleControl control = pool[rng() % pool.size()];
    teammate.segments.push_back({control, step_s, 0.0});
    speed_mps = control.speed_mps;
  }
  for (const models::PlanSegment& segment : models::brake(speed_mps, 2.0)) {
    teammate.segments.push_back(segment);
  }
  return teammate;
}

}  // namespace vantage::test
