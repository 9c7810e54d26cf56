#pragma once

#include <cmath>
#include <string>

#include "core/angle.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"

// Fixture data of a sample-based filter for one target in a field.

namespace vantage::estimator::test {

inline const models::World kField{{{-32.0, -32.0}, {32.0, 32.0}}, 10.0, {}, {}};
inline const models::TargetModel kModel{models::TargetKind::kDoubleIntegrator, 2, 0.001};

inline models::SensorModel field_sensor() {
  models::SensorModel sensor;
  sensor.range_max_m = 10.0;
  sensor.range_min_m = 0.1;
  sensor.fov_rad = 94.0 * kPi / 180.0;
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = 5.0 * kPi / 180.0;
  return sensor;
}

/// Returns a belief with correlated position and velocity.
inline models::Gaussian moving(const Eigen::Vector2d& position_m,
                               const Eigen::Vector2d& velocity_mps, double position_sigma_m,
                               double velocity_sigma_mps) {
  models::Gaussian belief{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Zero()};
  belief.mean << position_m, velocity_mps;
  Eigen::Matrix4d root = Eigen::Matrix4d::Zero();
  root.diagonal() << position_sigma_m, 0.8 * position_sigma_m, velocity_sigma_mps,
      velocity_sigma_mps;
  root(1, 0) = 0.4 * position_sigma_m;
  root(2, 0) = 0.3 * velocity_sigma_mps;
  belief.covariance = root * root.transpose();
  return belief;
}

inline FilterSpec field_spec(bool samples) {
  FilterSpec spec = open_spec(kModel, field_sensor(), 1);
  spec.sensor = field_sensor();
  spec.team = {{"Q1", field_sensor()}, {"Q2", field_sensor()}};
  spec.world = kField;
  spec.communication_range_m = 1000.0;
  spec.estimator.detection_probability = 0.99;
  spec.estimator.targets_stay_inside = true;
  spec.estimator.samples = samples;
  return spec;
}

/// Returns an empty scan of `robot` from viewpoint `from`.
inline models::RobotMeasurement look_of(const std::string& robot, int step,
                                        const models::Viewpoint& from) {
  models::RobotMeasurement look;
  look.stamp.time = instant(step);
  look.robot = robot;
  look.viewpoint = from;
  return look;
}

/// Returns the noise-free measurement of a target at truth_m.
inline models::Measurement seen(const models::Viewpoint& from, const Eigen::Vector2d& truth_m) {
  const models::PositionVector y_m = truth_m;
  return {models::observe(field_sensor(), from, y_m),
          models::noise_covariance(field_sensor(), from, y_m)};
}

inline DistributedFilter knows(const models::Gaussian& start, bool samples = true) {
  DistributedFilter filter(field_spec(samples));
  filter.rebase(prior(instant(0), {start}));
  return filter;
}

/// Returns the viewpoint of a robot that scans next to the target's initial position.
inline models::Viewpoint beside(const models::Gaussian& start, int step) {
  return at(start.mean(0) - 6.0 + 0.1 * step, start.mean(1) - 8.0,
            0.5 * kPi + 0.3 * std::sin(0.2 * step));
}

inline const models::Gaussian kNearACorner = moving({24.0, 26.0}, {0.4, 0.3}, 1.0, 0.3);

}  // namespace vantage::estimator::test
