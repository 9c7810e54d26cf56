#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "estimator/ranges/range_fit.hpp"
#include "tools/log/range_recording.hpp"

namespace vantage::tools {

/// Comparison of a fitted beacon with its survey.
struct SurveyedBeacon {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< surveyed position
  double error_m = 0.0;
  double nees = 0.0;  ///< NEES of the fitted position; expected: 2
};

struct RangeReport {
  RangeRecording recording;
  estimator::RangeFit fit;
  std::vector<std::optional<SurveyedBeacon>> surveys;  ///< comparison for each beacon
  std::vector<std::string> not_fitted;                 ///< surveyed beacons that were not fitted
  /// Score, on the last part of the recording, of a fit to the first part; nullopt if one of the
  /// parts has too few ranges.
  std::optional<estimator::InnovationScore> held_back;
};

/// Fits the ranges and compares the fit with the survey and with held-out ranges.
/// @throws StartupError if no beacon has enough ranges, with the reasons why ranges were left out.
RangeReport report_of(RangeRecording recording, const std::vector<Survey>& surveys,
                      double fitted_share, const std::string& source);

/// Returns the mean NEES of the fitted beacons that have a survey; nullopt if there is none.
std::optional<double> mean_nees(const RangeReport& report);

std::vector<std::string> to_lines(const RangeReport& report);
nlohmann::ordered_json to_json(const RangeReport& report);

/// Returns a gnuplot script with its data that draws into `picture_path` the robot's path, the
/// beacons with 95 % ellipses and surveys, and the residuals over distance. Pure.
/// @throws StartupError as plot_terminal().
std::string range_plot_script(const RangeReport& report, const std::string& picture_path);

}  // namespace vantage::tools
