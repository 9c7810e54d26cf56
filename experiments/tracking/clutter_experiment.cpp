#include <array>
#include <map>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/sweep/compare.hpp"
#include "experiments/tracking/clutter_trial.hpp"
#include "experiments/tracking/team_trial.hpp"

namespace vantage::experiments {
namespace {

constexpr int kTrials = 10;
constexpr double kDuration_s = 300.0;
constexpr double kSmoke_s = 30.0;
constexpr std::array<double, 3> kClutter = {0.0, 1.0, 5.0};
constexpr std::array<double, 3> kDetection = {0.7, 0.9, 1.0};

models::DetectionModel detection_of(std::size_t setting) {
  return {kDetection[setting % kDetection.size()], kClutter[setting / kDetection.size()]};
}

// Columns of a table row; column 0 is the method's name.
enum Column : std::size_t { kOspa = 1, kSwaps, kRmse, kTracks, kColumnsEnd };

using MethodSamples = std::map<std::string, std::array<Sample, kColumnsEnd>>;

UnitRows run_unit(double duration_s, std::size_t setting, std::uint64_t seed) {
  const scenario::Scenario lab = scenario_of(TeamTrial{"lab.yaml"}, seed);
  const ClutterScores scores = track_in_clutter(lab, detection_of(setting), duration_s, seed);
  UnitRows rows;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const ClutterScore& of = scores[i];
    rows.tables["runs"].push_back(fmt::format("{},{:.6f},{:.4f},{:.6f},{:.4f}", kClutterMethods[i],
                                              of.ospa_m, of.swaps_per_min, of.matched_rmse_m,
                                              of.tracks));
    rows.times_s.emplace_back(fmt::format("a step of {}", kClutterMethods[i]), of.step_cpu_s);
  }
  return rows;
}

Summary summarise(const Tables& tables) {
  std::map<std::size_t, MethodSamples> by_setting;
  for (const Record& record : tables.at("runs")) {
    for (const std::size_t column : {kOspa, kSwaps, kRmse, kTracks}) {
      by_setting[record.unit.setting][record.cells.front()][column].add(record.number(column));
    }
  }
  Summary summary;
  std::string csv = "clutter_per_look,detection_probability,method,trials";
  for (const char* const name : {"ospa_m", "swaps_per_min", "matched_rmse_m", "tracks"}) {
    csv += fmt::format(",{0},{0}_ci95", name);
  }
  csv += "\n";
  for (const auto& [setting, methods] : by_setting) {
    const models::DetectionModel detection = detection_of(setting);
    for (const char* const method : kClutterMethods) {
      const auto& of = methods.at(method);
      csv += fmt::format("{},{},{},{}", detection.clutter_per_look, detection.detection_probability,
                         method, of[kOspa].size());
      for (const std::size_t column : {kOspa, kSwaps, kRmse, kTracks}) {
        csv += fmt::format(",{:.6f},{:.6f}", of[column].mean(), of[column].half_interval());
      }
      csv += "\n";
      summary.lines.push_back(fmt::format(
          "clutter {}, detection {}, {}: OSPA {} m, {} swaps per minute, RMSE {} m, {} tracks",
          detection.clutter_per_look, detection.detection_probability, method, mean_text(of[kOspa]),
          mean_text(of[kSwaps]), mean_text(of[kRmse]), mean_text(of[kTracks])));
    }
  }
  summary.files["summary.csv"] = csv;
  summary.figure_script = tracking_clutter_figure(kClutterMethods);
  summary.figures = {"tracking-clutter"};
  summary.choices = {
      "The dissertation has no such figure: its detections contain the target's id.",
      "Every method is a central filter with the same motion model, measurement update and "
      "detections. The paths of the sensors are planned with the beliefs that use the known ids.",
      "OSPA has order 2 and a cutoff of 1 m. lmb receives the number of targets; jpda and "
      "nearest_neighbour confirm tracks by counts of hits and misses."};
  return summary;
}

}  // namespace

Sweep tracking_clutter(const Extent& extent) {
  Sweep sweep;
  sweep.plan.setting_columns = "clutter_per_look,detection_probability";
  for (std::size_t i = 0; i < kClutter.size() * kDetection.size(); ++i) {
    const models::DetectionModel of = detection_of(i);
    sweep.plan.settings.push_back(
        {fmt::format("{},{}", of.clutter_per_look, of.detection_probability)});
  }
  sweep.plan.trials = extent.trials_or(kTrials);
  const double duration_s = extent.is_smoke ? kSmoke_s : kDuration_s;
  sweep.plan.parameters = {{"duration_s", fmt::format("{}", duration_s)}, {"scenario", "lab.yaml"}};
  sweep.plan.tables = {{"runs", "method,ospa_m,swaps_per_min,matched_rmse_m,tracks"}};
  sweep.run = [duration_s](std::size_t setting, std::uint64_t seed) {
    return run_unit(duration_s, setting, seed);
  };
  sweep.summarise = summarise;
  return sweep;
}

}  // namespace vantage::experiments
