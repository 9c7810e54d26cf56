#include "estimator/tracks/filter_spec.hpp"

#include <algorithm>

#include "core/check.hpp"

namespace vantage::estimator {

FilterSpec filter_spec(const scenario::Scenario& scenario, const std::string& robot) {
  const scenario::RobotSpec* self = scenario.find_robot(robot);
  require(self != nullptr, "the scenario has no robot '" + robot + "'");
  FilterSpec spec;
  spec.robot = robot;
  spec.sensor = self->sensor;
  spec.detection = self->detection;
  for (const scenario::RobotSpec& each : scenario.robots) {
    spec.team.push_back({each.name, each.sensor, each.detection});
  }
  spec.start = {self->start, self->height_m};
  spec.estimator = scenario.estimator;
  spec.world = scenario.world;
  for (const scenario::TargetSpec& target : scenario.targets) {
    const bool is_first = spec.target_count == 0;
    spec.target_radius_m =
        is_first ? target.radius_m : std::min(spec.target_radius_m, target.radius_m);
    spec.target_count = std::max(spec.target_count, target.id + 1);
  }
  spec.step_s = scenario.planner.step_s;
  spec.communication_range_m = scenario.network.communication_range_m;
  spec.neighbourhood_m = scenario.network.neighbourhood_m;
  spec.belief_age_max_s = 3.0 * spec.step_s;
  return spec;
}

std::vector<models::NamedCount> FilterCounters::named() const {
  std::vector<models::NamedCount> all = {
      {"steps_out_of_order", steps_out_of_order},
      {"stale_beliefs", stale_beliefs},
      {"future_beliefs", future_beliefs},
      {"malformed_beliefs", malformed_beliefs},
      {"grid_mismatches", grid_mismatches},
      {"repeated_looks", repeated_looks},
      {"late_measurements", late_measurements},
      {"too_late_measurements", too_late_measurements},
      {"future_measurements", future_measurements},
      {"jammed_looks", jammed_looks},
      {"malformed_detections", malformed_detections},
      {"surplus_detections", surplus_detections},
      {"gated", gated},
      {"unknown_ids", unknown_ids},
      {"undiscoverable", undiscoverable},
      {"singular", singular},
  };
  std::erase_if(all, [](const models::NamedCount& c) { return c.count == 0; });
  return all;
}

}  // namespace vantage::estimator
