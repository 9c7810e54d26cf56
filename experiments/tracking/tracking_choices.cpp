#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/sweep/cases.hpp"
#include "experiments/sweep/compare.hpp"
#include "experiments/team/attackers.hpp"
#include "experiments/tracking/resilient_tracking.hpp"
#include "experiments/tracking/tracking_table.hpp"

namespace vantage::experiments {
namespace {

constexpr int kRuns = 10;  // number of runs in the dissertation
constexpr int kSmokeNodes = 500;
// Rows of Table 4.1 (robots, targets, attacks): (5, 10, 2), (10, 5, 4) and (10, 10, 4).
constexpr std::array<std::size_t, 3> kRows = {1, 4, 7};

// Alternatives of each choice. The experiment for Table 4.1 uses the first one.
constexpr std::array<std::pair<BearingNoise, const char*>, 2> kBearingNoise = {
    {{BearingNoise::kByRange, "range"}, {BearingNoise::kByBearing, "bearing"}}};
constexpr std::array<NamedAttacker, 2> kChosenAttackers = {
    {kAttackers.front(),
     {planner::Attacker::kBestTogether, "best_together",
      "robots whose joint plans gain most, chosen greedily"}}};
constexpr std::array<std::pair<bool, const char*>, 2> kBeliefs = {
    {{true, "inside"}, {false, "free"}}};

// One combination of the three choices.
struct Choices {
  std::size_t bearing_noise = 0;
  std::size_t attacker = 0;
  std::size_t beliefs = 0;
  [[nodiscard]] std::string cells() const {
    return fmt::format("{},{},{}", kBearingNoise[bearing_noise].second,
                       kChosenAttackers[attacker].name, kBeliefs[beliefs].second);
  }
};

constexpr std::size_t kCombinations =
    kBearingNoise.size() * kChosenAttackers.size() * kBeliefs.size();

// One setting of the sweep. Settings are ordered by combination, then table row, then method.
struct ChoiceCase {
  Choices choices;
  std::size_t row = 0;  ///< row of Table 4.1
  bool is_rain = false;
  [[nodiscard]] std::string cells() const {
    return fmt::format("{},{},{},{},{}", choices.cells(), kTrackingTable[row].robots,
                       kTrackingTable[row].targets, kTrackingTable[row].attacks,
                       kTrackingMethods[is_rain ? 1 : 0]);
  }
};

std::vector<ChoiceCase> all_cases() {
  std::vector<ChoiceCase> cases;
  for (std::size_t i = 0; i < kCombinations; ++i) {
    for (const std::size_t row : kRows) {
      cases.push_back({{i / 4, i / 2 % 2, i % 2}, row, false});
      cases.push_back({{i / 4, i / 2 % 2, i % 2}, row, true});
    }
  }
  return cases;
}

TrackingSetting setting_of(const ChoiceCase& of, bool is_smoke) {
  TrackingSetting setting;
  const TrackingTableRow& row = kTrackingTable[of.row];
  setting.robots = row.robots;
  setting.targets.count = row.targets;
  setting.attacks = row.attacks;
  setting.bearing_noise = kBearingNoise[of.choices.bearing_noise].first;
  setting.attacker = kChosenAttackers[of.choices.attacker].attacker;
  setting.targets.beliefs_stay_inside = kBeliefs[of.choices.beliefs].first;
  if (is_smoke) {
    setting.task_steps = setting.plan_steps;
    setting.nodes_per_plan = kSmokeNodes;
  }
  return setting;
}

UnitRows run_unit(const ChoiceCase& of, bool is_smoke, std::uint64_t seed) {
  const TrackingRun run = track_under_attack(setting_of(of, is_smoke), of.is_rain, seed);
  Sample rmse_m;
  for (const double of_step_m : run.rmse_m) {
    rmse_m.add(of_step_m);
  }
  UnitRows rows;
  rows.tables["runs"] = {
      fmt::format("{:.6f},{:.6f}", rmse_m.mean(), *std::ranges::max_element(run.rmse_m))};
  return rows;
}

struct CaseSamples {
  Sample mean_m;
  Sample peak_m;
};

std::vector<CaseSamples> samples_of(const Tables& tables, std::size_t cases) {
  std::vector<CaseSamples> samples(cases);
  for (const Record& record : tables.at("runs")) {
    samples[record.unit.setting].mean_m.add(record.number(0));
    samples[record.unit.setting].peak_m.add(record.number(1));
  }
  return samples;
}

// Mean factor between our values and the printed values, in either direction: exp(mean |log
// ratio|).
class Factor {
 public:
  void add(double ours, double printed) { logs_.add(std::abs(std::log(ours / printed))); }
  [[nodiscard]] double value() const { return std::exp(logs_.mean()); }

 private:
  Sample logs_;
};

// Deviation of one combination from the printed values, over its rows and methods.
struct Distance {
  Factor mean;
  Factor peak;
  Factor both;
  int rain_better = 0;  ///< number of rows in which mean and peak are lower with RAIN

  void add(const TrackingTableRow& row, const CaseSamples& of, std::size_t method) {
    mean.add(of.mean_m.mean(), row.mean_m[method]);
    both.add(of.mean_m.mean(), row.mean_m[method]);
    peak.add(of.peak_m.mean(), row.peak_m[method]);
    both.add(of.peak_m.mean(), row.peak_m[method]);
  }
};

std::vector<Distance> distances_of(const std::vector<ChoiceCase>& cases,
                                   const std::vector<CaseSamples>& samples) {
  std::vector<Distance> distances(kCombinations);
  for (std::size_t i = 0; i + 1 < cases.size(); i += 2) {
    Distance& of = distances[i / (2 * kRows.size())];
    const TrackingTableRow& row = kTrackingTable[cases[i].row];
    of.add(row, samples[i], 0);
    of.add(row, samples[i + 1], 1);
    const bool is_better = samples[i + 1].mean_m.mean() < samples[i].mean_m.mean() &&
                           samples[i + 1].peak_m.mean() < samples[i].peak_m.mean();
    of.rain_better += is_better ? 1 : 0;
  }
  return distances;
}

std::string table_csv(const std::vector<ChoiceCase>& cases,
                      const std::vector<CaseSamples>& samples) {
  std::string text =
      "bearing_variance,attacker,beliefs,robots,targets,attacks,method,runs,mean_m,mean_ci95,"
      "printed_mean_m,peak_m,peak_ci95,printed_peak_m\n";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const TrackingTableRow& row = kTrackingTable[cases[i].row];
    const CaseSamples& of = samples[i];
    const std::size_t method = cases[i].is_rain ? 1 : 0;
    text +=
        fmt::format("{},{},{:.4f},{:.4f},{},{:.4f},{:.4f},{}\n", cases[i].cells(), of.mean_m.size(),
                    of.mean_m.mean(), of.mean_m.half_interval(), row.mean_m[method],
                    of.peak_m.mean(), of.peak_m.half_interval(), row.peak_m[method]);
  }
  return text;
}

Summary summarise(const Tables& tables) {
  const std::vector<ChoiceCase> cases = all_cases();
  const std::vector<CaseSamples> samples = samples_of(tables, cases.size());
  const std::vector<Distance> distances = distances_of(cases, samples);
  Summary summary;
  summary.files["table.csv"] = table_csv(cases, samples);
  std::string& nearness = summary.files["nearness.csv"];
  nearness = "bearing_variance,attacker,beliefs,factor_mean,factor_peak,factor,rain_better_rows\n";
  for (std::size_t i = 0; i < kCombinations; ++i) {
    const std::string cells = cases[i * 2 * kRows.size()].choices.cells();
    const Distance& of = distances[i];
    nearness += fmt::format("{},{:.4f},{:.4f},{:.4f},{}\n", cells, of.mean.value(), of.peak.value(),
                            of.both.value(), of.rain_better);
    summary.compared.push_back(
        compare_claim(fmt::format("{}: RAIN's mean and peak RMSE below those of CD", cells),
                      fmt::format("in {} rows of {}", of.rain_better, kRows.size()), "in every row",
                      of.rain_better == static_cast<int>(kRows.size())));
    summary.lines.push_back(
        fmt::format("{}: differs from the published means by a factor of {:.2f}, from the peaks by "
                    "{:.2f}, from both by {:.2f}",
                    cells, of.mean.value(), of.peak.value(), of.both.value()));
  }
  const auto nearest = std::ranges::min_element(distances, std::ranges::less{},
                                                [](const Distance& of) { return of.both.value(); });
  const auto at = static_cast<std::size_t>(nearest - distances.begin());
  summary.lines.push_back("Combination nearest to the published table: " +
                          cases[at * 2 * kRows.size()].choices.cells());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const TrackingTableRow& row = kTrackingTable[cases[i].row];
    const std::size_t method = cases[i].is_rain ? 1 : 0;
    summary.compared.push_back(compare_number(cases[i].cells() + ": mean RMSE", samples[i].mean_m,
                                              row.mean_m[method], "m"));
    summary.compared.push_back(compare_number(cases[i].cells() + ": peak RMSE", samples[i].peak_m,
                                              row.peak_m[method], "m"));
  }
  summary.figure_script = resilient_tracking_choices_figure();
  summary.figures = {"resilient-tracking-choices"};
  summary.choices = {
      "Compared settings: the variance of a bearing grows with the range or with the bearing; the "
      "attacker chooses, one after another, the robots whose loss costs most or those whose joint "
      "plans gain most; beliefs are reflected at the walls or not.",
      "The combination nearest to the published values has the smallest factor: exp of the mean "
      "|log(ours / published)| over rows, methods, means and peaks."};
  return summary;
}

}  // namespace

Sweep resilient_tracking_choices(const Extent& extent) {
  const std::vector<ChoiceCase> cases = all_cases();
  Sweep sweep = sweep_over("bearing_variance,attacker,beliefs,robots,targets,attacks,method", cases,
                           kRuns, extent, run_unit);
  const TrackingSetting setting = setting_of(cases.front(), extent.is_smoke);
  sweep.plan.parameters = parameters_of(setting);
  sweep.plan.tables = {{"runs", "mean_rmse_m,peak_rmse_m"}};
  sweep.summarise = summarise;
  return sweep;
}

}  // namespace vantage::experiments
