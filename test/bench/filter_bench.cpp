// filter_bench: CPU time of one step of a robot's filter, with five targets in the lab's room and a
// hundred in the field's, and three robots that all receive each other. Target models: random walk,
// damped oscillator, and the latter with samples while unseen. Also measures sending a belief in
// parts.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "estimator/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"

namespace {

using namespace vantage;             // NOLINT(google-build-using-namespace): main alone
using namespace vantage::estimator;  // NOLINT(google-build-using-namespace)

constexpr int kRobots = 3;
constexpr int kSteps = 400;

double cpu_us() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

models::TargetModel walk() { return {models::TargetKind::kRandomWalk, 2, 0.3}; }

models::TargetModel oscillator(const Eigen::Vector2d& half_m) {
  models::TargetModel model{models::TargetKind::kDampedOscillator};
  model.oscillator = {Eigen::Vector2d::Zero(), 0.45 * half_m, {0.4, 0.25}, {0.3, 0.5}};
  return model;
}

void measure_steps(const char* name, const models::TargetModel& model, int targets,
                   const Eigen::Vector2d& half_m, double range_max_m, bool samples = false) {
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = range_max_m;
  sensor.range_sigma_m = 0.3;
  FilterSpec spec = test::open_spec(model, sensor, targets);
  spec.sensor = sensor;
  spec.robot = "Q0";
  for (int i = 0; i < kRobots; ++i) {
    spec.team.push_back({"Q" + std::to_string(i), sensor});
  }
  spec.estimator.detection_probability = 0.9;
  spec.estimator.targets_stay_inside = true;
  spec.estimator.samples = samples;
  spec.target_radius_m = samples ? 0.2 : 0.0;
  spec.estimator.grid_resolution_m = 0.25 * range_max_m;
  spec.world.bounds = {-half_m, half_m};
  spec.world.obstacles = {{{{1.2, -1.1}, {1.8, -0.5}}, 2.5}, {{{-1.8, 0.5}, {-1.2, 1.1}}, 2.5}};
  spec.communication_range_m = 1e3;
  DistributedFilter filter(spec);
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  const auto anywhere_m = [&] {
    return Eigen::Vector2d(half_m.x() * side(rng), half_m.y() * side(rng));
  };
  std::vector<Eigen::Vector2d> truth;
  std::vector<models::Gaussian> start;
  for (int m = 0; m < targets; ++m) {
    truth.push_back(anywhere_m());
    models::Gaussian belief{models::StateVector::Zero(model.dim()),
                            0.5 * models::StateMatrix::Identity(model.dim(), model.dim())};
    belief.mean.head<2>() = truth.back();
    start.push_back(belief);
  }
  filter.rebase(test::prior(test::instant(0), start));
  std::vector<double> step_us;
  std::vector<double> mixture_us;
  for (int k = 1; k <= kSteps; ++k) {
    std::vector<models::RobotMeasurement> looks;
    for (Eigen::Vector2d& y_m : truth) {
      y_m += 0.2 * test::normal_vector(2, rng);
    }
    for (int i = 0; i < kRobots; ++i) {
      const Eigen::Vector2d eye_m = anywhere_m();
      const models::Viewpoint from = test::at(eye_m.x(), eye_m.y(), k);
      looks.push_back(test::look_at(sensor, test::instant(k), from, truth, rng));
      looks.back().robot = spec.team[static_cast<std::size_t>(i)].robot;
      std::erase_if(looks.back().detections, [&](const models::Detection& d) {
        return !models::in_view(sensor, from, truth[static_cast<std::size_t>(d.target_id)]);
      });
    }
    models::RobotBelief teammate = test::prior(test::instant(k - 1), start);
    teammate.robot = "Q1";
    const models::RobotMeasurement* look_pointers[] = {&looks[0], &looks[1], &looks[2]};
    const models::RobotBelief* belief_pointers[] = {&teammate};
    const double before_us = cpu_us();
    filter.advance({test::instant(k), test::at(0, 0), look_pointers, belief_pointers});
    step_us.push_back(cpu_us() - before_us);
    const double told_us = cpu_us();
    static_cast<void>(filter.mixture());
    mixture_us.push_back(cpu_us() - told_us);
  }
  std::sort(step_us.begin(), step_us.end());
  std::sort(mixture_us.begin(), mixture_us.end());
  std::printf(
      "%s, %3d targets: median %.0f us, 99 of 100 below %.0f us, worst %.0f us; "
      "mixture %.0f, %.0f, %.0f us\n",
      name, targets, step_us[kSteps / 2], step_us[kSteps * 99 / 100], step_us.back(),
      mixture_us[kSteps / 2], mixture_us[kSteps * 99 / 100], mixture_us.back());
}

}  // namespace

int main() {
  const Eigen::Vector2d lab_m(4.0, 2.0);
  const Eigen::Vector2d field_m(32.0, 32.0);
  measure_steps("random walk", walk(), 5, lab_m, 1.0);
  measure_steps("oscillator", oscillator(lab_m), 5, lab_m, 1.0);
  measure_steps("samples", oscillator(lab_m), 5, lab_m, 1.0, true);
  measure_steps("random walk", walk(), 100, field_m, 10.0);
  measure_steps("oscillator", oscillator(field_m), 100, field_m, 10.0);
  measure_steps("samples", oscillator(field_m), 100, field_m, 10.0, true);
}
