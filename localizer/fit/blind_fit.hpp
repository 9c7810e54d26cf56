#pragma once

#include <vector>

#include "localizer/fit/sensor_fit.hpp"
#include "localizer/judge/recording.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Fits of all robots of a team without true poses.
struct BlindFit {
  std::vector<SensorFit> sensors;  ///< in the order of the robots
  std::vector<DriveFit> drives;
  int rounds = 0;  ///< number of rounds until the parameters hardly changed
};

/// Fits sensors and drives without true poses, and writes them to `spec`. Each round estimates all
/// paths in hindsight with the parameters so far, and then fits the parameters to these paths. The
/// landmarks must be known. True poses in `recording` are not used.
///
/// The delay of the stamps keeps its value in `spec`: a common delay of stamps and paths cannot be
/// observed. The delay of commands is fitted relative to it.
/// @throws UsageError if a robot has too few sightings, or if its start is not found
BlindFit fit_without_truth(scenario::LocalizerSpec& spec, Recording recording);

}  // namespace vantage::localizer
