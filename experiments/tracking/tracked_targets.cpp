#include "experiments/tracking/tracked_targets.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace vantage::experiments {

struct TrackedTargets::Starts {
  std::mt19937_64 rng;  ///< random generator of the starts, then of the targets' motion
  std::vector<models::StateVector> truth;
  std::vector<models::Gaussian> priors;

  Starts(const TargetSetting& setting, const models::World& world, std::uint64_t seed) : rng(seed) {
    std::uniform_real_distribution<double> off_m(-0.5 * setting.start_side_m,
                                                 0.5 * setting.start_side_m);
    const Eigen::Vector2d middle_m = 0.5 * (world.bounds.min_m + world.bounds.max_m);
    models::StateMatrix prior = models::StateMatrix::Zero(4, 4);
    prior.diagonal().head(2).setConstant(std::pow(setting.prior_position_sigma_m, 2));
    prior.diagonal().tail(2).setConstant(std::pow(setting.prior_velocity_sigma_mps, 2));
    const Eigen::LDLT<models::StateMatrix> root_of_prior(prior);
    for (int m = 0; m < setting.count; ++m) {
      models::StateVector state = models::StateVector::Zero(4);
      state(0) = middle_m.x() + off_m(rng);
      state(1) = middle_m.y() + off_m(rng);
      truth.push_back(state);
      priors.push_back({state + sim::draw_gaussian(root_of_prior, rng), prior});
    }
  }
};

models::SensorModel tracking_sensor() {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRangeBearing;
  sensor.range_max_m = 10.0;
  sensor.fov_rad = radians(94.0);
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = radians(5.0);
  return sensor;
}

TrackingGround::TrackingGround(double side_m) {
  constexpr double kResolution_m = 0.5;
  world.bounds = {{0.0, 0.0}, {side_m, side_m}};
  field = models::DistanceField(world, kResolution_m);
}

TrackedTargets::TrackedTargets(const TargetSetting& setting, const models::World& world,
                               std::uint64_t seed)
    : TrackedTargets(setting, world, Starts(setting, world, seed), ~seed) {}

TrackedTargets::TrackedTargets(const TargetSetting& setting, const models::World& world,
                               Starts starts, std::uint64_t noise_seed)
    : noise_rng_(noise_seed),
      filter_({{models::TargetKind::kDoubleIntegrator, 2, setting.q_m2ps3},
               setting.step_s,
               setting.detection_probability,
               setting.beliefs_stay_inside},
              world, std::move(starts.priors)),
      truth_(filter_.model(), setting.step_s, world.bounds, std::move(starts.truth), starts.rng) {}

void TrackedTargets::move() {
  truth_.move();
  filter_.predict();
}

void TrackedTargets::observe(const models::SensorModel& sensor, const std::vector<Pose2>& poses,
                             const std::vector<char>& is_blind) {
  std::vector<models::RobotMeasurement> looks;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (is_blind[i] == 0) {
      looks.emplace_back().viewpoint = {poses[i], 0.0};
    }
  }
  for (std::size_t m = 0; m < truth_.states().size(); ++m) {
    const models::PositionVector target_m = truth_.states()[m].head(2);
    for (models::RobotMeasurement& look : looks) {
      if (models::in_view(sensor, look.viewpoint, target_m)) {
        look.detections.push_back(
            {static_cast<int>(m), models::sample(sensor, look.viewpoint, target_m, noise_rng_)});
      }
    }
  }
  filter_.update(sensor, looks);
}

std::vector<TargetStep> TrackedTargets::steps() const {
  std::vector<TargetStep> steps;
  for (std::size_t m = 0; m < truth_.states().size(); ++m) {
    const models::Gaussian& belief = beliefs()[m];
    const models::StateVector error = truth_.states()[m] - belief.mean;
    const double nees = error.dot(belief.covariance.llt().solve(error));
    steps.push_back({error.head<2>().norm(), nees, is_seen()[m] != 0});
  }
  return steps;
}

}  // namespace vantage::experiments
