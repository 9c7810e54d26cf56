#pragma once

#include <optional>
#include <vector>

#include "localizer/fit/robust_fit.hpp"
#include "localizer/judge/recording.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Sensor of one robot, fitted to its sightings of landmarks and its true poses.
struct SensorFit {
  int sightings = 0;               ///< number of sightings used
  scenario::SightingSpec sensor;   ///< parameters of the range model that fits better
  double depth_loss = 0.0;         ///< mean Cauchy loss per sighting if the range is a depth
  double distance_loss = 0.0;      ///< mean Cauchy loss per sighting if the range is the distance
  double range_sigma_m = 0.0;      ///< robust 1σ of the range at distance 0
  double range_sigma_per_m = 0.0;  ///< 1/m; growth of the 1σ with squared distance
  double bearing_sigma_rad = 0.0;  ///< robust 1σ of the bearing of landmarks beyond 1.5 m
  double outliers = 0.0;           ///< share of sightings with an error above 6σ
  /// Share of frames with at least one sighting in which a landmark in the used field of view and
  /// range was detected.
  double detection_probability = 0.0;
};

/// Drive of one robot, fitted to its commands and its true poses.
struct DriveFit {
  int windows = 0;  ///< number of time windows used
  scenario::DriveSpec drive;
  double turn_sigma_rad = 0.0;  ///< robust 1σ of the turn per 0.2 s
  double move_sigma_m = 0.0;    ///< robust 1σ of the forward motion per 0.2 s
};

/// Fits both models of the range and selects the better one.
/// @throws UsageError if there are fewer than 100 sightings of landmarks with a true pose
SensorFit fit_sensor(const std::vector<scenario::LandmarkSpec>& landmarks,
                     const RobotRecording& recording,
                     std::optional<double> stamp_delay_s = std::nullopt);

/// @param response  delay and lag if they are known; nullopt: they are fitted
/// @throws UsageError if there are fewer than 100 windows with true poses
DriveFit fit_drive(const RobotRecording& recording,
                   std::optional<Response> response = std::nullopt);

}  // namespace vantage::localizer
