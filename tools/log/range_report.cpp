#include "tools/log/range_report.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "core/index.hpp"
#include "tools/log/log_plot.hpp"

namespace vantage::tools {
namespace {

std::optional<SurveyedBeacon> compare_with_survey(const estimator::FittedBeacon& beacon,
                                                  const std::string& name,
                                                  const std::vector<Survey>& surveys) {
  const auto survey = std::find_if(surveys.begin(), surveys.end(),
                                   [&](const Survey& each) { return each.beacon == name; });
  if (survey == surveys.end()) {
    return std::nullopt;
  }
  const Eigen::Vector2d error_m = beacon.position_m - survey->position_m;
  return SurveyedBeacon{survey->position_m, error_m.norm(),
                        error_m.dot(beacon.covariance_m2().inverse() * error_m)};
}

/// Returns text with the numbers of ranges left out, by reason; empty if there are none.
std::string left_out(const RangeRecording& recording) {
  std::vector<std::string> words;
  const auto count = [&](std::int64_t number, const char* what) {
    if (number > 0) {
      words.push_back(fmt::format("{} {}", number, what));
    }
  };
  count(recording.not_finite, "with a missing value");
  count(recording.doubled, "duplicates");
  count(recording.outside_poses, "before the first pose or after the last");
  count(recording.in_gaps, "in gaps between poses");
  count(recording.too_far, "with a range or position beyond 1000 km");
  count(recording.of_too_few, "of beacons with too few ranges");
  return fmt::format("{}", fmt::join(words, ", "));
}

double half_axis_m(const Eigen::Matrix2d& covariance_m2) {
  return std::sqrt(std::max(
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance_m2).eigenvalues()(1), 0.0));
}

std::vector<int> ranges_of(const RangeRecording& recording) {
  std::vector<int> out(recording.beacons.size());
  for (const estimator::TakenRange& range : recording.ranges) {
    ++out[index(range.beacon)];
  }
  return out;
}

double residual_m(const estimator::RangeFit& fit, const estimator::TakenRange& range) {
  const Eigen::Vector2d& beacon_m = fit.beacons[index(range.beacon)].position_m;
  return range.range_m - fit.calibration.range_bias_m -
         fit.calibration.range_scale * (beacon_m - range.robot_m).norm();
}

std::string beacon_line(const RangeReport& report, std::size_t b, int ranges) {
  const estimator::FittedBeacon& beacon = report.fit.beacons[b];
  std::string line = fmt::format("{:<10} {:>7} {:>10.3f} {:>10.3f} {:>9.3f} {:>9.3f} {:>10.1f}",
                                 report.recording.beacons[b], ranges, beacon.position_m.x(),
                                 beacon.position_m.y(), half_axis_m(beacon.covariance_m2()),
                                 beacon.range_sigma_m, 100.0 * beacon.outlier_share);
  if (const auto& survey = report.surveys[b]) {
    line += fmt::format(" {:>9.3f} {:>7.2f}", survey->error_m, survey->nees);
  }
  return line;
}

}  // namespace

RangeReport report_of(RangeRecording recording, const std::vector<Survey>& surveys,
                      double fitted_share, const std::string& source) {
  if (recording.beacons.empty()) {
    const std::string why = left_out(recording);
    throw StartupError(
        fmt::format("{}: no beacon has {} usable ranges{}", source, estimator::kRangesOfBeaconMin,
                    why.empty() ? ": the input has no ranges" : " (left out: " + why + ")"));
  }
  RangeReport report;
  report.recording = std::move(recording);
  const std::vector<std::string>& names = report.recording.beacons;
  report.fit = estimator::fit_ranges(report.recording.ranges, static_cast<int>(names.size()));
  for (std::size_t b = 0; b < names.size(); ++b) {
    report.surveys.push_back(compare_with_survey(report.fit.beacons[b], names[b], surveys));
  }
  for (const Survey& survey : surveys) {
    if (std::find(names.begin(), names.end(), survey.beacon) == names.end()) {
      report.not_fitted.push_back(survey.beacon);
    }
  }
  const SplitRecording parts = split(report.recording, fitted_share);
  if (!parts.beacons.empty() && !parts.held_back.empty()) {
    report.held_back =
        judge(estimator::fit_ranges(parts.fitted, static_cast<int>(parts.beacons.size())),
              parts.held_back);
  }
  return report;
}

std::optional<double> mean_nees(const RangeReport& report) {
  double sum = 0.0;
  int count = 0;
  for (const auto& survey : report.surveys) {
    sum += survey ? survey->nees : 0.0;
    count += survey ? 1 : 0;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

std::vector<std::string> to_lines(const RangeReport& report) {
  const RangeRecording& recording = report.recording;
  const estimator::RangeFit& fit = report.fit;
  std::vector<std::string> out;
  out.push_back(fmt::format("ranges  {} to {} beacons in {:.1f} s", recording.ranges.size(),
                            recording.beacons.size(),
                            recording.times_s.back() - recording.times_s.front()));
  if (const std::string why = left_out(recording); !why.empty()) {
    out.push_back("left out: " + why);
  }
  if (recording.poses_left_out > 0) {
    out.push_back(fmt::format("poses left out: {}", recording.poses_left_out));
  }
  out.push_back(
      fmt::format("scale   {:.5f} ± {:.5f}", fit.calibration.range_scale, fit.range_scale_sigma));
  out.push_back(fmt::format("bias    {:.3f} ± {:.3f} m", fit.calibration.range_bias_m,
                            fit.range_bias_sigma_m));
  out.push_back(fmt::format(
      "number of correlated ranges with the information of one independent range: {:.1f}",
      fit.correlation));
  out.emplace_back();
  const std::optional<double> nees = mean_nees(report);
  out.push_back(fmt::format("{:<10} {:>7} {:>10} {:>10} {:>9} {:>9} {:>10}{}", "beacon", "ranges",
                            "x m", "y m", "sigma m", "noise m", "outliers %",
                            nees ? fmt::format(" {:>9} {:>7}", "error m", "NEES") : ""));
  const std::vector<int> ranges = ranges_of(recording);
  for (std::size_t b = 0; b < fit.beacons.size(); ++b) {
    out.push_back(beacon_line(report, b, ranges[b]));
  }
  for (std::size_t b = 0; b < fit.beacons.size(); ++b) {
    if (const estimator::FittedBeacon& beacon = fit.beacons[b]; beacon.other) {
      out.push_back(fmt::format(
          "{} has two possible positions: this one with probability {:.3f}, or {:.2f}, {:.2f}",
          recording.beacons[b], beacon.probability, beacon.other->x(), beacon.other->y()));
    }
  }
  out.emplace_back();
  if (nees) {
    out.push_back(fmt::format("mean NEES of the beacons {:.2f} (expected 2)", *nees));
  }
  if (!report.not_fitted.empty()) {
    out.push_back(fmt::format("surveyed, but not located (too few ranges): {}",
                              fmt::join(report.not_fitted, ", ")));
  }
  if (report.held_back) {
    out.push_back(fmt::format(
        "test on held-out ranges: {} innovations with mean NEES {:.2f} (expected 1), {} beyond "
        "4 sigma",
        report.held_back->inliers, report.held_back->nees, report.held_back->outliers));
  }
  out.push_back(fmt::format("calibration: {{range_scale: {:.5f}, range_bias_m: {:.3f}}}",
                            fit.calibration.range_scale, fit.calibration.range_bias_m));
  return out;
}

nlohmann::ordered_json to_json(const RangeReport& report) {
  const RangeRecording& recording = report.recording;
  const estimator::RangeFit& fit = report.fit;
  nlohmann::ordered_json json;
  json["range_scale"] = fit.calibration.range_scale;
  json["range_scale_sigma"] = fit.range_scale_sigma;
  json["range_bias_m"] = fit.calibration.range_bias_m;
  json["range_bias_sigma_m"] = fit.range_bias_sigma_m;
  json["correlation"] = fit.correlation;
  json["ranges"] = {{"used", recording.ranges.size()}, {"not_finite", recording.not_finite},
                    {"doubled", recording.doubled},    {"outside_poses", recording.outside_poses},
                    {"in_gaps", recording.in_gaps},    {"of_too_few", recording.of_too_few},
                    {"too_far", recording.too_far}};
  json["poses_left_out"] = recording.poses_left_out;
  json["beacons"] = nlohmann::ordered_json::array();
  const std::vector<int> ranges = ranges_of(recording);
  for (std::size_t b = 0; b < fit.beacons.size(); ++b) {
    const estimator::FittedBeacon& beacon = fit.beacons[b];
    const Eigen::Matrix2d P = beacon.covariance_m2();
    nlohmann::ordered_json one = {{"beacon", recording.beacons[b]},
                                  {"ranges", ranges[b]},
                                  {"x_m", beacon.position_m.x()},
                                  {"y_m", beacon.position_m.y()},
                                  {"covariance_m2", {P(0, 0), P(0, 1), P(1, 0), P(1, 1)}},
                                  {"range_sigma_m", beacon.range_sigma_m},
                                  {"outlier_share", beacon.outlier_share},
                                  {"probability", beacon.probability}};
    if (beacon.other) {
      one["other_m"] = {beacon.other->x(), beacon.other->y()};
    }
    if (const auto& survey = report.surveys[b]) {
      one["error_m"] = survey->error_m;
      one["nees"] = survey->nees;
    }
    json["beacons"].push_back(one);
  }
  json["too_few_ranges"] = recording.too_few;
  if (const auto nees = mean_nees(report)) {
    json["mean_nees"] = *nees;
  }
  json["surveyed_not_found"] = report.not_fitted;
  if (report.held_back) {
    json["held_back"] = {{"honest", report.held_back->inliers},
                         {"outliers", report.held_back->outliers},
                         {"nees", report.held_back->nees}};
  }
  return json;
}

std::string range_plot_script(const RangeReport& report, const std::string& picture_path) {
  const estimator::RangeFit& fit = report.fit;
  std::string out = "$ranges << EOD\n";  // columns: x y distance residual
  for (const estimator::TakenRange& range : report.recording.ranges) {
    const Eigen::Vector2d& beacon_m = fit.beacons[index(range.beacon)].position_m;
    out += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", range.robot_m.x(), range.robot_m.y(),
                       (beacon_m - range.robot_m).norm(), residual_m(fit, range));
  }
  out += "EOD\n$beacons << EOD\n";                      // x y width height angle name
  constexpr double kAxes95 = 2.0 * 2.4477468306808166;  // axis of the 95 % ellipse: 2 √χ²₂(0.95)
  for (std::size_t b = 0; b < fit.beacons.size(); ++b) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(fit.beacons[b].covariance_m2());
    const Eigen::Vector2d size_m = kAxes95 * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    const Eigen::Vector2d along = axes.eigenvectors().col(0);
    out += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.6g} {}\n", fit.beacons[b].position_m.x(),
                       fit.beacons[b].position_m.y(), size_m.x(), size_m.y(),
                       degrees(std::atan2(along.y(), along.x())),
                       gnuplot_text(report.recording.beacons[b]));
  }
  out += "EOD\n$surveys << EOD\n";
  for (const auto& survey : report.surveys) {
    if (survey) {
      out += fmt::format("{:.9g} {:.9g}\n", survey->position_m.x(), survey->position_m.y());
    }
  }
  out += "EOD\n";
  out += fmt::format(
      "set terminal {}\nset output {}\nset grid lt 1 lc rgb '#dddddd'\nset colorsequence podo\n"
      "set multiplot layout 1,2 title {}\nset size ratio -1\nset xlabel 'x, m'\n"
      "set ylabel 'y, m'\nset key below\n",
      plot_terminal(picture_path, 600), gnuplot_text(picture_path),
      gnuplot_text(fmt::format("scale {:.4f} ± {:.4f}, bias {:.2f} ± {:.2f} m",
                               fit.calibration.range_scale, fit.range_scale_sigma,
                               fit.calibration.range_bias_m, fit.range_bias_sigma_m)));
  out +=
      "plot $ranges using 1:2 with dots lt 1 title 'robot', $beacons using 1:2:3:4:5 with "
      "ellipses lt 3 lw 2 title 'beacon, 95 %', '' using 1:2:6 with labels offset 0,1 notitle";
  const bool is_surveyed = mean_nees(report).has_value();
  out += is_surveyed ? ", $surveys using 1:2 with points pt 1 lt 7 title 'survey'\n" : "\n";
  out +=
      "set size noratio\nset xlabel 'distance, m'\nset ylabel 'residual, m'\n"
      "plot $ranges using 3:4 with dots lt 1 notitle\nunset multiplot\n";
  return out;
}

}  // namespace vantage::tools
