#pragma once

#include <random>
#include <vector>

#include "models/sensor/sensor.hpp"

// False alarms (clutter) of a sensor, for planar targets only.

namespace vantage::models {

/// Detection statistics of a sensor: misses, false alarms and target ids.
struct DetectionModel {
  double detection_probability = 1.0;  ///< for a target in view and in line of sight
  double clutter_per_look = 0.0;       ///< mean number of false alarms per scan
  bool detects_ids = true;             ///< true: a detection contains the id of its target
};

/// Returns the ground area in view, m², walls not counted. Exact, except for a camera that does not
/// point straight down: accurate to about a percent. Depends on the viewpoint only for a camera,
/// which costs about 50 µs.
double view_area_m2(const SensorModel& sensor, const Viewpoint& from);

/// Returns the false alarms of one scan. Their number is Poisson with mean `clutter_per_look`; each
/// is a measurement of a target uniformly distributed over the area in view.
std::vector<Measurement> sample_clutter(const SensorModel& sensor, const Viewpoint& from,
                                        double clutter_per_look, std::mt19937_64& rng);

}  // namespace vantage::models
