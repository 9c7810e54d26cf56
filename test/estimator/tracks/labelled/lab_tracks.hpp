#pragma once

#include "estimator/tracks/labelled/multi_target.hpp"

// Sensor and filter for detections without ids in a small lab.

namespace vantage::estimator::test {

inline models::SensorModel lab_sensor() {
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 3.0;
  sensor.range_sigma_m = 0.1;
  return sensor;
}

inline MultiTargetSpec spec_of(int targets, models::DetectionModel detection,
                               Tracker tracker = Tracker::kLabelled) {
  MultiTargetSpec spec;
  spec.detection = detection;
  spec.estimator.target_model = {models::TargetKind::kRandomWalk, 2, 0.02};
  spec.estimator.detection_probability = 0.9;
  spec.world.bounds = {{-4.0, -4.0}, {4.0, 4.0}};
  spec.targets = targets;
  spec.tracks_max = targets + 5;
  spec.tracker = tracker;
  return spec;
}

}  // namespace vantage::estimator::test
