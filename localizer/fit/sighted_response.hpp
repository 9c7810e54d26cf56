#pragma once

#include <vector>

#include "localizer/fit/robust_fit.hpp"
#include "localizer/judge/recording.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Fits the response of a robot to its commands. Compares commanded turns with the turns computed
/// from consecutive sightings of the same landmarks. Needs neither poses nor the landmarks'
/// positions. The delay is relative to the frames' times, so an error of `sensor.stamp_delay_s`
/// becomes an error of the delay.
/// @throws UsageError if there are fewer than 100 pairs of frames with a common landmark
Response sighted_response(const std::vector<scenario::LandmarkSpec>& landmarks,
                          const scenario::SightingSpec& sensor, const RobotRecording& recording);

}  // namespace vantage::localizer
