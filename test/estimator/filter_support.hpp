#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "estimator/filter/distributed_filter.hpp"
#include "models/exchange/messages.hpp"

// Functions for the filter's tests: specs, observations, priors, χ² limits.

namespace vantage::estimator::test {

/// Returns a sensor with a range of 10 km.
inline models::SensorModel far_sighted(models::SensorKind kind) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_max_m = 1e4;
  return sensor;
}

/// Returns a filter spec with a range of 10 km and without missed detections, walls, gate or team.
inline FilterSpec open_spec(const models::TargetModel& model, const models::SensorModel& sensor,
                            int target_count) {
  FilterSpec spec;
  spec.robot = "Q1";
  spec.sensor = sensor;
  spec.sensor.range_max_m = 1e4;
  spec.estimator.target_model = model;
  spec.estimator.detection_probability = 0.0;
  spec.estimator.gate_sigma = 0.0;
  spec.estimator.targets_stay_inside = false;
  spec.estimator.grid_resolution_m = 10.0;
  spec.world.bounds = {{-20.0, -20.0}, {20.0, 20.0}};
  spec.target_count = target_count;
  spec.step_s = 0.5;
  return spec;
}

/// Returns the open spec with a gate.
inline FilterSpec gated_spec(const models::TargetModel& model, const models::SensorModel& sensor,
                             int targets, double gate_sigma) {
  FilterSpec spec = open_spec(model, sensor, targets);
  spec.estimator.gate_sigma = gate_sigma;
  return spec;
}

inline Time instant(int step) { return from_utime(1'000'000'000) + from_seconds(0.5 * step); }

inline models::Viewpoint at(double x_m, double y_m, double yaw_rad = 0.0) {
  return {{x_m, y_m, yaw_rad}, 0.0};
}

/// Mean of ε' Σ⁻¹ ε (NEES) of 2-D beliefs; 2 if their covariances are correct.
class MeanNees {
 public:
  void add(const models::Gaussian& belief, const Eigen::Vector2d& truth_m) {
    const Eigen::Vector2d error_m = Eigen::Vector2d(belief.mean) - truth_m;
    const double nees = error_m.dot(Eigen::Matrix2d(belief.covariance).inverse() * error_m);
    sum_ += nees;
    squares_ += nees * nees;
    ++cases_;
  }
  [[nodiscard]] int cases() const { return cases_; }
  [[nodiscard]] double mean() const { return sum_ / cases_; }
  /// Returns the standard error of the mean.
  [[nodiscard]] double sigma() const {
    return std::sqrt((squares_ / cases_ - mean() * mean()) / cases_);
  }

 private:
  double sum_ = 0.0;
  double squares_ = 0.0;
  int cases_ = 0;
};

/// Returns a scan that reports every target of `positions_m` (by id) except those in `skip`.
inline models::RobotMeasurement look_at(const models::SensorModel& sensor, Time time,
                                        const models::Viewpoint& from,
                                        const std::vector<Eigen::Vector2d>& positions_m,
                                        std::mt19937_64& rng) {
  models::RobotMeasurement look;
  look.stamp.time = time;
  look.robot = "Q1";
  look.viewpoint = from;
  for (std::size_t m = 0; m < positions_m.size(); ++m) {
    look.detections.push_back(
        {static_cast<int>(m), models::sample(sensor, from, positions_m[m], rng)});
  }
  return look;
}

/// Returns a belief at `time` with the given moments of every target.
inline models::RobotBelief prior(Time time, const std::vector<models::Gaussian>& targets) {
  models::RobotBelief belief;
  belief.stamp.time = time;
  for (std::size_t m = 0; m < targets.size(); ++m) {
    belief.targets.push_back(
        {static_cast<int>(m), models::to_information(targets[m]).value(), time});
  }
  return belief;
}

/// Messages that one robot of a team has received at a step.
struct Received {
  std::vector<models::RobotMeasurement> looks;
  std::vector<models::RobotBelief> beliefs;
};
/// Returns robot `self`'s own observation and, for each other robot with `hears(other)`, that
/// robot's observation and, if sent, its belief.
template <class Hears>
Received received_by(std::size_t self, const std::vector<models::RobotMeasurement>& looks,
                     const std::vector<models::RobotBelief>& beliefs, const Hears& hears) {
  Received out;
  for (std::size_t other = 0; other < looks.size(); ++other) {
    if (self == other || hears(other)) {
      out.looks.push_back(looks[other]);
    }
    if (self != other && hears(other) && !beliefs[other].robot.empty()) {
      out.beliefs.push_back(beliefs[other]);
    }
  }
  return out;
}

inline models::RobotBelief take_step(DistributedFilter& filter, Time time,
                                     const models::Viewpoint& from,
                                     const std::vector<models::RobotMeasurement>& looks,
                                     const std::vector<models::RobotBelief>& beliefs = {}) {
  std::vector<const models::RobotMeasurement*> look_pointers;
  std::vector<const models::RobotBelief*> belief_pointers;
  for (const auto& look : looks) {
    look_pointers.push_back(&look);
  }
  for (const auto& belief : beliefs) {
    belief_pointers.push_back(&belief);
  }
  return filter.step({time, from, look_pointers, belief_pointers});
}

inline models::Gaussian known(const DistributedFilter& filter, int target_id) {
  return models::to_gaussian(filter.track(target_id).information).value();
}

inline Eigen::VectorXd normal_vector(Eigen::Index size, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(size, [&] { return normal(rng); });
}

/// Returns the p-quantile of χ² with `dof` degrees of freedom, for the standard normal quantile `z`
/// of p. Source: Wilson, Hilferty (1931); better than 0.1 % for dof ≥ 30.
inline double chi2_quantile(double dof, double z) {
  const double a = 2.0 / (9.0 * dof);
  return dof * std::pow(1.0 - a + z * std::sqrt(a), 3);
}

/// Names that the filter tests use without qualification.
namespace words {
using estimator::test::at;
using estimator::test::gated_spec;
using estimator::test::instant;
using estimator::test::known;
using estimator::test::look_at;
using estimator::test::open_spec;
using estimator::test::take_step;
using models::Gaussian;
using models::SensorKind;
using models::TargetKind;
}  // namespace words

}  // namespace vantage::estimator::test
