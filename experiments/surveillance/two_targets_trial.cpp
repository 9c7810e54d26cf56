#include "experiments/surveillance/two_targets_trial.hpp"

#include <random>

namespace vantage::experiments {

WatchSetting two_targets_setting(int jammed_robot) {
  WatchSetting setting;
  setting.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  setting.clearance_m = 0.25;
  setting.landmarks_m = {Eigen::Vector2d(-2.0, 0.0), Eigen::Vector2d(2.0, 0.0)};
  setting.landmark_model = {models::TargetKind::kRandomWalk, 2, 0.01};
  setting.sensor.kind = models::SensorKind::kRangeBearing;
  setting.sensor.range_max_m = 1.0;
  setting.sensor.range_min_m = 0.1;
  setting.sensor.range_sigma_m = 0.3;
  setting.sensor.bearing_sigma_rad = radians(5.0);
  setting.controls = models::lab_primitives();
  setting.step_s = 0.5;
  setting.task_steps = 240;
  setting.plan_steps = 12;
  setting.replan_steps = 2;
  setting.attacks = 1;
  setting.jammed_robot = jammed_robot;
  setting.delta_m = 0.3;
  return setting;
}

std::vector<models::Viewpoint> two_targets_starts(const WatchSetting& setting, std::uint64_t seed) {
  constexpr double kMargin_m = 0.6;  // m; distance to the walls and to the middle
  std::mt19937_64 rng(seed);
  const models::Rectangle& bounds = setting.world.bounds;
  std::uniform_real_distribution<double> off_m(kMargin_m, bounds.max_m.x() - kMargin_m);
  std::uniform_real_distribution<double> y_m(bounds.min_m.y() + kMargin_m,
                                             bounds.max_m.y() - kMargin_m);
  std::uniform_real_distribution<double> yaw_rad(-kPi, kPi);
  std::vector<models::Viewpoint> starts;
  for (const double side : {-1.0, 1.0}) {
    const double x = side * off_m(rng);
    const double y = y_m(rng);
    starts.push_back({{x, y, yaw_rad(rng)}, side < 0.0 ? 1.0 : 2.0});
  }
  return starts;
}

Visits visits(const WatchSetting& setting, const WatchRun& run, std::size_t robot) {
  const auto distance_m = [&](std::size_t step, std::size_t target) {
    return (run.poses[step][robot].position_m() - setting.landmarks_m[target].head<2>()).norm();
  };
  const std::size_t home = distance_m(0, 0) <= distance_m(0, 1) ? 0 : 1;
  Visits result;
  int at_home = 0;
  int at_any = 0;
  int last = -1;
  for (std::size_t step = 1; step < run.poses.size(); ++step) {
    for (std::size_t target = 0; target < setting.landmarks_m.size(); ++target) {
      if (distance_m(step, target) >= setting.sensor.range_max_m) {
        continue;
      }
      const int visited = static_cast<int>(target);
      result.switches += last >= 0 && last != visited ? 1 : 0;
      last = visited;
      at_home += target == home ? 1 : 0;
      ++at_any;
    }
  }
  result.home_share = at_any > 0 ? static_cast<double>(at_home) / at_any : 0.0;
  return result;
}

}  // namespace vantage::experiments
