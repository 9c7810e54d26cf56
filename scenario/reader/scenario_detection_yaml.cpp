#include "scenario/reader/scenario_detection_yaml.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "models/sensor/law.hpp"

namespace vantage::scenario {

void read_detection(Mapping& from, const models::SensorModel& sensor,
                    models::DetectionModel& detection) {
  // A scan has at most 32 detections (estimator/track_labels).
  constexpr double kClutterMax = 20.0;
  from.flag("detects_ids", detection.detects_ids);
  from.number("clutter_per_look", detection.clutter_per_look, from_to(0.0, kClutterMax));
  from.number("detection_probability", detection.detection_probability, above_to(0.0, 1.0));
  if (!detection.detects_ids && sensor.kind.law().position_from == nullptr) {
    from.refuse("detects_ids",
                fmt::format("must be true for a sensor of kind {}: without ids, each detection "
                            "must give the position of its target",
                            sensor.kind.name()));
  }
  if (detection.detects_ids && detection.clutter_per_look > 0.0) {
    from.refuse("clutter_per_look",
                fmt::format("must be 0 with detects_ids: true: a false alarm cannot have the id of "
                            "a target; is {}",
                            detection.clutter_per_look));
  }
}

void check_without_ids(Mapping& top, const Scenario& scenario) {
  constexpr std::size_t kRobotsWithoutIdsMax = 32;
  constexpr std::size_t kTargetsWithoutIdsMax = 100;
  const auto reports_ids = [](const RobotSpec& robot) { return robot.detection.detects_ids; };
  const auto with_ids = std::count_if(scenario.robots.begin(), scenario.robots.end(), reports_ids);
  if (with_ids == std::ssize(scenario.robots)) {
    return;
  }
  if (with_ids > 0) {
    top.refuse("robots",
               "must all have the same detects_ids, true or false: the team shares one numbering "
               "of its targets");
  }
  if (scenario.robots.size() > kRobotsWithoutIdsMax) {
    top.refuse("robots", fmt::format("must be at most {} with detects_ids: false, are {}",
                                     kRobotsWithoutIdsMax, scenario.robots.size()));
  }
  if (scenario.targets.empty() || scenario.targets.size() > kTargetsWithoutIdsMax) {
    top.refuse("targets", fmt::format("must be 1 to {} with detects_ids: false, are {}",
                                      kTargetsWithoutIdsMax, scenario.targets.size()));
  }
  if (scenario.estimator.target_model.position_dim != 2) {
    top.refuse("estimator",
               "target_model.position_dim must be 2 with detects_ids: false: targets "
               "without ids are tracked in the plane only");
  }
  if (scenario.network.neighbourhood_m > 0.0) {
    top.refuse("network",
               "neighbourhood_m must be 0 with detects_ids: false: the number "
               "of targets is estimated for the whole world only");
  }
}

}  // namespace vantage::scenario
