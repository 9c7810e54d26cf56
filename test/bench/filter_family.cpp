#include "test/bench/filter_family.hpp"

#include <string>

#include "core/index.hpp"
#include "test/estimator/filter_support.hpp"

namespace vantage::bench {
namespace {

using estimator::FilterSpec;

constexpr int kRobots = 3;

std::string robot_name(int i) { return "Q" + std::to_string(i); }

models::TargetModel target_model(const FilterCase& filter_case) {
  if (!filter_case.is_oscillator) {
    return {models::TargetKind::kRandomWalk, 2, 0.3};
  }
  models::TargetModel model{models::TargetKind::kDampedOscillator};
  model.oscillator = {Eigen::Vector2d::Zero(), 0.45 * filter_case.half_m, {0.4, 0.25}, {0.3, 0.5}};
  return model;
}

models::SensorModel sensor_of(const FilterCase& filter_case) {
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = filter_case.range_max_m;
  sensor.range_sigma_m = 0.3;
  return sensor;
}

FilterSpec spec_of(const FilterCase& filter_case) {
  const models::SensorModel sensor = sensor_of(filter_case);
  FilterSpec spec =
      estimator::test::open_spec(target_model(filter_case), sensor, filter_case.targets);
  spec.sensor = sensor;
  spec.robot = robot_name(0);
  for (int i = 0; i < kRobots; ++i) {
    spec.team.push_back({robot_name(i), sensor});
  }
  spec.estimator.detection_probability = 0.9;
  spec.estimator.targets_stay_inside = true;
  spec.estimator.samples = filter_case.has_samples;
  spec.target_radius_m = filter_case.has_samples ? 0.2 : 0.0;
  spec.estimator.grid_resolution_m = 0.25 * filter_case.range_max_m;
  spec.world.bounds = {-filter_case.half_m, filter_case.half_m};
  spec.world.obstacles = {{{{1.2, -1.1}, {1.8, -0.5}}, 2.5}, {{{-1.8, 0.5}, {-1.2, 1.1}}, 2.5}};
  spec.communication_range_m = 1e3;
  return spec;
}

}  // namespace

const std::vector<FilterCase>& filter_cases() {
  static const Eigen::Vector2d kLab_m(4.0, 2.0);
  static const Eigen::Vector2d kField_m(32.0, 32.0);
  static const std::vector<FilterCase> kCases = {
      {"random walk", 5, kLab_m, 1.0, false, false},
      {"oscillator", 5, kLab_m, 1.0, true, false},
      {"samples", 5, kLab_m, 1.0, true, true},
      {"random walk", 100, kField_m, 10.0, false, false},
      {"oscillator", 100, kField_m, 10.0, true, false},
      {"samples", 100, kField_m, 10.0, true, true},
  };
  return kCases;
}

FilterRun::FilterRun(const FilterCase& filter_case)
    : half_m_(filter_case.half_m), sensor_(sensor_of(filter_case)), filter_(spec_of(filter_case)) {
  const int dim = target_model(filter_case).dim();
  for (int m = 0; m < filter_case.targets; ++m) {
    truth_m_.push_back(anywhere_m());
    models::Gaussian belief{models::StateVector::Zero(dim),
                            0.5 * models::StateMatrix::Identity(dim, dim)};
    belief.mean.head<2>() = truth_m_.back();
    start_.push_back(belief);
  }
  filter_.rebase(estimator::test::prior(estimator::test::instant(0), start_));
}

Eigen::Vector2d FilterRun::anywhere_m() {
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  const double x_m = half_m_.x() * side(rng_);
  return {x_m, half_m_.y() * side(rng_)};
}

void FilterRun::prepare_step() {
  namespace test = estimator::test;
  const int k = ++steps_;
  for (Eigen::Vector2d& position_m : truth_m_) {
    position_m += 0.2 * test::normal_vector(2, rng_);
  }
  looks_.clear();
  for (int i = 0; i < kRobots; ++i) {
    const Eigen::Vector2d eye_m = anywhere_m();
    const models::Viewpoint from = test::at(eye_m.x(), eye_m.y(), k);
    models::RobotMeasurement look = test::look_at(sensor_, test::instant(k), from, truth_m_, rng_);
    look.robot = robot_name(i);
    std::erase_if(look.detections, [&](const models::Detection& each) {
      return !models::in_view(sensor_, from, truth_m_[index(each.target_id)]);
    });
    looks_.push_back(std::move(look));
  }
  teammate_ = test::prior(test::instant(k - 1), start_);
  teammate_.robot = robot_name(1);
}

void FilterRun::step() {
  const models::RobotMeasurement* looks[] = {&looks_[0], &looks_[1], &looks_[2]};
  const models::RobotBelief* beliefs[] = {&teammate_};
  filter_.advance({estimator::test::instant(steps_), estimator::test::at(0, 0), looks, beliefs});
}

}  // namespace vantage::bench
