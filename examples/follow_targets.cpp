// Tracks a target from the measurements of a range-bearing sensor. Needs component estimator, which
// only depends on Eigen.
#include <cstdio>
#include <random>

#include <vantage/estimator/filter/distributed_filter.hpp>

using namespace vantage;

int main() {
  estimator::FilterSpec spec;
  spec.robot = "Q1";
  spec.sensor = {.kind = models::SensorKind::kRangeBearing, .range_max_m = 15.0};
  spec.estimator.target_model = {.kind = models::TargetKind::kDoubleIntegrator, .q = 0.01};
  spec.world.bounds = {{0.0, 0.0}, {20.0, 20.0}};
  spec.target_count = 1;
  estimator::DistributedFilter filter(spec);

  std::mt19937_64 rng(1);
  const models::Viewpoint from{{10.0, 3.0, kPi / 2}, 0.0};
  for (int k = 1; k <= 20; ++k) {
    const Time time{Duration{k * 500'000}};
    const Eigen::Vector2d truth_m{4.0 + 0.4 * k, 9.0};
    models::RobotMeasurement measurement{.stamp = {time}, .robot = "Q1", .viewpoint = from};
    if (in_view(spec.sensor, from, truth_m)) {
      measurement.detections.push_back({0, sample(spec.sensor, from, truth_m, rng)});
    }
    const models::RobotMeasurement* measurements[] = {&measurement};
    filter.advance({.time = time, .viewpoint = from, .measurements = measurements});
    if (const auto belief = models::to_gaussian(filter.track(0).information)) {
      std::printf("%4.1f s: estimate %.3f %.3f, true %.3f %.3f, 1 sigma %.3f m\n", 0.5 * k,
                  belief->mean(0), belief->mean(1), truth_m.x(), truth_m.y(),
                  std::sqrt(belief->covariance(0, 0)));
    }
  }
  return filter.track(0).known ? 0 : 1;
}
