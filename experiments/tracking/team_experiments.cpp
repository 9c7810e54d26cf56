#include <array>
#include <cmath>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/sweep/compare.hpp"
#include "experiments/sweep/manifest.hpp"
#include "experiments/tracking/team_trial.hpp"

namespace vantage::experiments {
namespace {

constexpr int kTrials = 10;  // number of trials in the dissertation
constexpr double kSmoke_s = 12.0;

// One setting of a sweep.
struct TeamCase {
  std::string cells;
  TeamTrial trial;
};

// Trend of a measure from the first to the last setting, as printed in the dissertation.
struct Trend {
  std::size_t column;  ///< index into kTeamTrialColumns
  const char* what;
  const char* unit;
  const char* printed;
};

// A sweep over one or several parameters of one scenario.
struct TeamSweep {
  std::string columns;  ///< columns of the swept values
  std::string axis;     ///< axis label in the figure
  std::string figure;
  std::vector<TeamCase> cases;
  std::vector<Trend> trends;
  bool is_improving = true;  ///< true: the dissertation states an improvement from case to case
  std::vector<std::string> choices;
};

constexpr std::size_t kRmse = 0;
constexpr std::size_t kEntropy = 1;
constexpr std::size_t kDiscovery = 2;
constexpr std::size_t kFound = 3;
constexpr std::size_t kTeamRmse = 4;
constexpr std::size_t kTeamEntropy = 5;
constexpr std::size_t kCollisions = 9;
constexpr std::size_t kViolations = 10;
constexpr std::size_t kColumns = 15;

// Samples of all trials of one setting, by column.
using CaseSamples = std::array<Sample, kColumns>;

std::vector<CaseSamples> samples_of(const Tables& tables, std::size_t cases) {
  std::vector<CaseSamples> samples(cases);
  for (const Record& record : tables.at("trials")) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double value = record.number(column);
      if (std::isfinite(value)) {
        samples[record.unit.setting][column].add(value);
      }
    }
  }
  return samples;
}

double sum_of(const Sample& sample) { return sample.mean() * static_cast<double>(sample.size()); }

std::string summary_csv(const TeamSweep& sweep, const std::vector<CaseSamples>& samples) {
  std::string text = "number," + sweep.columns + ",trials";
  for (const std::string& column : cells_of(kTeamTrialColumns)) {
    text += fmt::format(",{0},{0}_ci95", column);
  }
  text += "\n";
  for (std::size_t i = 0; i < samples.size(); ++i) {
    text += fmt::format("{},{},{}", i, sweep.cases[i].cells, samples[i][kEntropy].size());
    for (const Sample& sample : samples[i]) {
      text += fmt::format(",{:.6f},{:.6f}", sample.mean(), sample.half_interval());
    }
    text += "\n";
  }
  return text;
}

Summary summarise(const TeamSweep& sweep, const Tables& tables) {
  const std::vector<CaseSamples> samples = samples_of(tables, sweep.cases.size());
  Summary summary;
  summary.files["summary.csv"] = summary_csv(sweep, samples);
  summary.figure_script = team_figure(sweep.figure, sweep.axis, sweep.columns);
  summary.figures = {sweep.figure};
  summary.choices = sweep.choices;
  const std::string& first = sweep.cases.front().cells;
  const std::string& last = sweep.cases.back().cells;
  for (const Trend& trend : sweep.trends) {
    const Sample& from = samples.front()[trend.column];
    const Sample& to = samples.back()[trend.column];
    const bool is_lower = to.mean() < from.mean();
    summary.compared.push_back(
        compare_claim(trend.what,
                      fmt::format("{} {} at {}, {} {} at {}", mean_text(from), trend.unit, first,
                                  mean_text(to), trend.unit, last),
                      trend.printed, is_lower == sweep.is_improving));
  }
  double collisions = 0.0;
  double violations = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CaseSamples& of = samples[i];
    collisions += sum_of(of[kCollisions]);
    violations += sum_of(of[kViolations]);
    summary.lines.push_back(
        fmt::format("{} = {}: per robot RMSE {} m, entropy {} nats, discovery {} s, found {}; team "
                    "RMSE {} m, entropy {} nats",
                    sweep.columns, sweep.cases[i].cells, mean_text(of[kRmse]),
                    mean_text(of[kEntropy]), mean_text(of[kDiscovery]), mean_text(of[kFound]),
                    mean_text(of[kTeamRmse]), mean_text(of[kTeamEntropy])));
  }
  summary.lines.push_back(
      fmt::format("{:.0f} collisions, {:.0f} separation violations", collisions, violations));
  return summary;
}

Sweep sweep_of(TeamSweep team, const Extent& extent) {
  Sweep sweep;
  sweep.plan.setting_columns = team.columns;
  for (TeamCase& of : team.cases) {
    of.trial.planning_time_s *= extent.planning_share;
    if (extent.is_smoke) {
      of.trial.duration_s = kSmoke_s;
      of.trial.planning_time_s *= 0.02;
    }
    sweep.plan.settings.push_back({of.cells});
  }
  const TeamTrial& first = team.cases.front().trial;
  sweep.plan.trials = extent.trials_or(kTrials);
  sweep.plan.parameters = {{"scenario", first.file},
                           {"scenario_sha256", text_hash(scenario_text(first.file))},
                           {"reference_nodes_per_s", fmt::format("{}", kReferenceNodesPerS)},
                           {"planning_share", fmt::format("{}", extent.planning_share)},
                           {"length", extent.is_smoke ? fmt::format("{} s", kSmoke_s) : "in full"}};
  sweep.plan.tables = {{"trials", kTeamTrialColumns}};
  sweep.run = [cases = team.cases](std::size_t setting, std::uint64_t seed) {
    UnitRows rows;
    rows.tables["trials"] = {team_trial_row(cases[setting].trial, seed)};
    return rows;
  };
  sweep.summarise = [team = std::move(team)](const Tables& tables) {
    return summarise(team, tables);
  };
  return sweep;
}

std::vector<std::string> choices_with(const std::string& own) {
  return {own,
          "The figure shows means over the whole trial versus the swept parameter; the source "
          "shows them over time.",
          fmt::format("The time T_ARVI is converted to search nodes: {:g} nodes per second, split "
                      "evenly among the robots.",
                      kReferenceNodesPerS),
          "Starts, priors, exploration landmarks and separation are our own choices: see the "
          "scenario file."};
}

}  // namespace

Sweep tracking_communication(const Extent& extent) {
  TeamSweep sweep;
  sweep.columns = "communication_range_m";
  sweep.axis = "communication range [m]";
  sweep.figure = "tracking-communication";
  for (const int range_m : {0, 5, 10, 20, 30, 100}) {
    sweep.cases.push_back(
        {std::to_string(range_m), {.file = "field.yaml", .communication_range_m = range_m}});
  }
  sweep.trends = {
      {kRmse, "RMSE of a robot", "m", "falls with the communication range"},
      {kEntropy, "entropy of a robot's beliefs", "nats", "falls with the communication range"},
      {kDiscovery, "time until a robot discovers a target", "s",
       "falls with the communication range"}};
  sweep.choices =
      choices_with("100 m stands for the published ∞: it exceeds the field's diagonal.");
  return sweep_of(std::move(sweep), extent);
}

Sweep tracking_time(const Extent& extent) {
  TeamSweep sweep;
  sweep.columns = "planning_time_s";
  sweep.axis = "T_{ARVI} [s]";
  sweep.figure = "tracking-time";
  for (const double time_s : {0.05, 0.1, 0.2, 0.5, 1.0}) {
    sweep.cases.push_back({fmt::format("{}", time_s),
                           {.file = "field.yaml",
                            .communication_range_m = 30.0,
                            .planning_time_s = time_s,
                            .range_sigma_m = 0.3,
                            .bearing_sigma_deg = 10.0,
                            .robots = 10,
                            .targets = 25,
                            .duration_s = 300.0}});
  }
  sweep.trends = {
      {kRmse, "RMSE of a robot", "m", "falls with the planning time"},
      {kEntropy, "entropy of a robot's beliefs", "nats", "falls with the planning time"}};
  sweep.choices =
      choices_with("The values of T_ARVI are illegible in the source. Here: 0.05 to 1 s.");
  return sweep_of(std::move(sweep), extent);
}

Sweep tracking_noise(const Extent& extent) {
  TeamSweep sweep;
  sweep.columns = "range_sigma_m,bearing_sigma_deg";
  sweep.axis = "noise: σ_r [m], σ_b [°]";
  sweep.figure = "tracking-noise";
  constexpr std::array<std::array<double, 2>, 4> kNoise = {
      {{0.15, 5.0}, {0.3, 10.0}, {0.6, 20.0}, {1.2, 40.0}}};
  for (const auto& [range_sigma_m, bearing_sigma_deg] : kNoise) {
    sweep.cases.push_back({fmt::format("{},{}", range_sigma_m, bearing_sigma_deg),
                           {.file = "field.yaml",
                            .communication_range_m = 30.0,
                            .range_sigma_m = range_sigma_m,
                            .bearing_sigma_deg = bearing_sigma_deg,
                            .robots = 8,
                            .targets = 16}});
  }
  sweep.is_improving = false;
  sweep.trends = {{kRmse, "RMSE of a robot", "m", "rises with the noise"},
                  {kEntropy, "entropy of a robot's beliefs", "nats", "rises with the noise"}};
  sweep.choices = choices_with(
      "The swept values and T_max are illegible in the source. Here: (0.15 m, 5°) doubled three "
      "times, 500 s.");
  return sweep_of(std::move(sweep), extent);
}

Sweep hardware(const Extent& extent) {
  TeamSweep sweep;
  sweep.columns = "planner";
  sweep.axis = "planner";
  sweep.figure = "hardware";
  // ARVI is the planner used in the dissertation's flights. The dissertation states no trend from
  // random walk to ARVI.
  for (const char* planner : {"random_walk", "lawn_mower", "greedy", "arvi"}) {
    sweep.cases.push_back({planner, {.file = "lab.yaml", .planner = planner}});
  }
  sweep.trends = {
      {kTeamRmse, "RMSE of the team", "m", "a low tracking error (no value is printed)"},
      {kTeamEntropy, "entropy of the team", "nats", "none"}};
  sweep.choices = choices_with(
      "The trials are simulated, not flown. One-step greedy, lawn mower and random walk are our "
      "own additions.");
  return sweep_of(std::move(sweep), extent);
}

}  // namespace vantage::experiments
