#pragma once

#include <random>
#include <vector>

#include "models/sensor/sensor.hpp"

// What a sensor reports that is no target. Planar targets only.

namespace vantage::models {

/// Which of the targets in view a look reports, and what it reports besides.
struct DetectionModel {
  double detection_probability = 1.0;  ///< of a target in view and in line of sight
  double clutter_per_look = 0.0;       ///< false alarms in the mean
  bool detects_ids = true;             ///< a report says which target it is of
};

/// Area of the ground in view, walls not counted: of a camera that is not straight down to about a
/// percent. Constant but for a camera, which costs some 50 µs.
double view_area_m2(const SensorModel& sensor, const Viewpoint& from);

/// False alarms of one look: their number is Poisson with mean `clutter_per_look`, each is what the
/// sensor would measure of a target uniformly distributed over the area in view.
std::vector<Measurement> sample_clutter(const SensorModel& sensor, const Viewpoint& from,
                                        double clutter_per_look, std::mt19937_64& rng);

}  // namespace vantage::models
