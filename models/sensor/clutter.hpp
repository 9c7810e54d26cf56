#pragma once

#include <random>
#include <vector>

#include "models/sensor/sensor.hpp"

// False alarms of a sensor. Planar targets only.

namespace vantage::models {

/// Properties of a sensor's detections: missed targets, false alarms and target ids.
struct DetectionModel {
  /// probability of detecting a target in view and in line of sight
  double detection_probability = 1.0;
  double clutter_per_look = 0.0;  ///< mean number of false alarms per measurement
  bool detects_ids = true;        ///< true: each detection has its target's id
};

/// Returns the area of the ground in view, m², if no walls block the view. The result for a tilted
/// camera is exact to about one percent. Constant computation time; about 50 µs for kinds with
/// SensorLaw::can_measure.
double view_area_m2(const SensorModel& sensor, const Viewpoint& from);

/// Returns the false alarms of one measurement. Their number is Poisson distributed with mean
/// `clutter_per_look`. Each is the measurement of a target that is uniformly distributed over the
/// area in view.
std::vector<Measurement> sample_clutter(const SensorModel& sensor, const Viewpoint& from,
                                        double clutter_per_look, std::mt19937_64& rng);

}  // namespace vantage::models
