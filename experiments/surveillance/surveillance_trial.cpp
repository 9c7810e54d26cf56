#include "experiments/surveillance/surveillance_trial.hpp"

#include <random>

#include "experiments/surveillance/camp_world.hpp"

namespace vantage::experiments {

WatchSetting surveillance_setting(int replan_steps, int attacks) {
  WatchSetting setting;
  setting.world = camp_world();
  setting.landmarks_m = camp_landmarks_m();
  setting.landmark_model = {models::TargetKind::kGrowingUncertainty, 3, 0.01};
  setting.sensor.kind = models::SensorKind::kRange;
  setting.sensor.range_max_m = 10.0;
  setting.sensor.range_sigma_m = 0.15;
  setting.sensor.variance_grows_with_range = true;
  for (const double speed_mps : {1.0, 3.0}) {
    for (const double yaw_rate_radps : {0.0, 1.0, -1.0, 2.0, -2.0}) {
      setting.controls.push_back({speed_mps, yaw_rate_radps});
    }
  }
  setting.replan_steps = replan_steps;
  setting.attacks = attacks;
  return setting;
}

std::vector<models::Viewpoint> surveillance_starts(const WatchSetting& setting, int robots,
                                                   std::uint64_t seed) {
  constexpr double kRoom_m = 2.0;  // m; distance to obstacles; every robot can leave its start
  std::mt19937_64 rng(seed);
  const models::Rectangle& bounds = setting.world.bounds;
  std::uniform_real_distribution<double> x_m(bounds.min_m.x(), bounds.max_m.x());
  std::uniform_real_distribution<double> y_m(bounds.min_m.y(), bounds.max_m.y());
  std::uniform_real_distribution<double> yaw_rad(-kPi, kPi);
  std::vector<models::Viewpoint> starts;
  for (int robot = 0; robot < robots; ++robot) {
    const double height_m = camp_height_m(robot);
    const models::World world = world_at(setting, height_m);
    Pose2 pose;
    do {
      const double x = x_m(rng);
      const double y = y_m(rng);
      pose = {x, y, yaw_rad(rng)};
    } while (models::clearance_m(world, pose.position_m()) < kRoom_m);
    starts.push_back({pose, height_m});
  }
  return starts;
}

}  // namespace vantage::experiments
