#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "estimator/range_fit.hpp"
#include "tools/log/range_recording.hpp"

namespace vantage::tools {

/// A fitted beacon beside its survey.
struct SurveyedBeacon {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double error_m = 0.0;
  double nees = 0.0;  ///< 2 is right
};

struct RangeReport {
  RangeRecording recording;
  estimator::RangeFit fit;
  std::vector<std::optional<SurveyedBeacon>> surveys;  ///< by beacon
  std::vector<std::string> unheard;                    ///< surveyed, and no range to them
  /// Of a fit to the first part of the time on the rest; none: too few ranges in one of them.
  std::optional<estimator::InnovationScore> held_back;
};

/// Fits, and judges by the survey and by what is held back. @throws StartupError when no beacon has
/// enough ranges; its text says where the others went.
RangeReport report_of(RangeRecording recording, const std::vector<Survey>& surveys,
                      double fitted_share, const std::string& source);

/// Mean over the surveyed beacons that were found; none: there is none.
std::optional<double> mean_nees(const RangeReport& report);

std::vector<std::string> to_lines(const RangeReport& report);
nlohmann::ordered_json to_json(const RangeReport& report);

/// A gnuplot script, data included, that draws into `picture_path` the robot's way, the beacons
/// with their 95 % ellipses and surveys, and the residuals over distance. Pure. @throws
/// StartupError as plot_terminal().
std::string range_plot_script(const RangeReport& report, const std::string& picture_path);

}  // namespace vantage::tools
