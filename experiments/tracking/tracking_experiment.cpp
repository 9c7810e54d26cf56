#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/sweep/compare.hpp"
#include "experiments/team/attackers.hpp"
#include "experiments/tracking/resilient_tracking.hpp"
#include "experiments/tracking/tracking_table.hpp"

namespace vantage::experiments {
namespace {

constexpr int kRuns = 10;  // number of runs in the dissertation

// Settings are ordered by attacker, then table row, then method.
std::size_t attacker_of(std::size_t setting) { return setting / (2 * kTrackingTable.size()); }
std::size_t table_index_of(std::size_t setting) { return setting / 2 % kTrackingTable.size(); }
const TrackingTableRow& row_of(std::size_t setting) {
  return kTrackingTable[table_index_of(setting)];
}
bool is_rain(std::size_t setting) { return setting % 2 == 1; }

TrackingSetting setting_of(const Extent& extent) {
  TrackingSetting setting;
  if (extent.is_smoke) {
    setting.task_steps = 2 * setting.plan_steps;
    setting.nodes_per_plan = 2'000;
  }
  return setting;
}

double mean_of(const std::vector<double>& values) {
  Sample sample;
  for (const double value : values) {
    sample.add(value);
  }
  return sample.mean();
}

UnitRows run_unit(TrackingSetting setting, std::size_t index, std::uint64_t seed) {
  const TrackingTableRow& row = row_of(index);
  setting.robots = row.robots;
  setting.targets.count = row.targets;
  setting.attacks = row.attacks;
  setting.attacker = kAttackers[attacker_of(index)].attacker;
  const TrackingRun run = track_under_attack(setting, is_rain(index), seed);
  UnitRows rows;
  rows.tables["runs"] = {fmt::format("{:.6f},{:.6f},{:.6f}", mean_of(run.rmse_m),
                                     *std::max_element(run.rmse_m.begin(), run.rmse_m.end()),
                                     mean_of(run.entropy_nats))};
  const bool is_drawn = row.is_drawn() && setting.attacker == planner::Attacker::kGreedy;
  for (std::size_t t = 0; is_drawn && t < run.rmse_m.size(); ++t) {
    rows.tables["steps"].push_back(
        fmt::format("{},{:.6f},{:.6f}", t + 1, run.rmse_m[t], run.entropy_nats[t]));
  }
  return rows;
}

struct RowSamples {
  std::array<Sample, 2> mean_m;  ///< index 0: CD; 1: RAIN
  std::array<Sample, 2> peak_m;
};

using TableSamples = std::array<RowSamples, kTrackingTable.size()>;

std::array<TableSamples, kAttackers.size()> samples_of(const Tables& tables) {
  std::array<TableSamples, kAttackers.size()> samples;
  for (const Record& record : tables.at("runs")) {
    const std::size_t setting = record.unit.setting;
    RowSamples& of_row = samples[attacker_of(setting)][table_index_of(setting)];
    const std::size_t method = is_rain(record.unit.setting) ? 1 : 0;
    of_row.mean_m[method].add(record.number(0));
    of_row.peak_m[method].add(record.number(1));
  }
  return samples;
}

std::string table_csv(const TableSamples& samples) {
  std::string text =
      "robots,targets,attacks,mean_cd_m,mean_cd_ci95,mean_rain_m,mean_rain_ci95,peak_cd_m,"
      "peak_cd_ci95,peak_rain_m,peak_rain_ci95,printed_mean_cd,printed_mean_rain,printed_peak_cd,"
      "printed_peak_rain\n";
  for (std::size_t i = 0; i < kTrackingTable.size(); ++i) {
    const TrackingTableRow& row = kTrackingTable[i];
    text += fmt::format("{},{},{}", row.robots, row.targets, row.attacks);
    for (const auto* of : {&samples[i].mean_m, &samples[i].peak_m}) {
      for (const Sample& sample : *of) {
        text += fmt::format(",{:.4f},{:.4f}", sample.mean(), sample.half_interval());
      }
    }
    text +=
        fmt::format(",{},{},{},{}\n", row.mean_m[0], row.mean_m[1], row.peak_m[0], row.peak_m[1]);
  }
  return text;
}

// Returns the quantities of the figure by step, as means over the runs.
std::string curves_csv(const Tables& tables) {
  std::map<std::pair<std::size_t, int>, std::pair<Sample, Sample>> curves;
  for (const Record& record : tables.at("steps")) {
    auto& [rmse_m, entropy_nats] =
        curves[{record.unit.setting, static_cast<int>(record.number(0))}];
    rmse_m.add(record.number(1));
    entropy_nats.add(record.number(2));
  }
  std::string text = "robots,targets,attacks,method,step,rmse_m,entropy_nats\n";
  for (const auto& [at, means] : curves) {
    const TrackingTableRow& row = row_of(at.first);
    text += fmt::format("{},{},{},{},{},{:.6f},{:.6f}\n", row.robots, row.targets, row.attacks,
                        kTrackingMethods[is_rain(at.first) ? 1 : 0], at.second, means.first.mean(),
                        means.second.mean());
  }
  return text;
}

bool is_rain_better(const RowSamples& row) {
  return row.mean_m[1].mean() < row.mean_m[0].mean() && row.peak_m[1].mean() < row.peak_m[0].mean();
}

void compare_table(const TableSamples& samples, const NamedAttacker& attacker, Summary& summary) {
  for (std::size_t i = 0; i < kTrackingTable.size(); ++i) {
    const TrackingTableRow& row = kTrackingTable[i];
    const RowSamples& ours = samples[i];
    const std::string name =
        fmt::format("n = {}, M = {}, α = {}", row.robots, row.targets, row.attacks);
    for (const std::size_t method : {0U, 1U}) {
      const char* label = method == 0 ? "CD" : "RAIN";
      // The printed values are for the greedy attacker.
      if (attacker.attacker == planner::Attacker::kGreedy) {
        summary.compared.push_back(compare_number(fmt::format("{}: mean RMSE of {}", name, label),
                                                  ours.mean_m[method], row.mean_m[method], "m"));
        summary.compared.push_back(compare_number(fmt::format("{}: peak RMSE of {}", name, label),
                                                  ours.peak_m[method], row.peak_m[method], "m"));
      }
    }
    summary.lines.push_back(
        fmt::format("{}, attacked: {}: mean RMSE {} m with CD and {} m with RAIN (published: {} "
                    "and {}); peak RMSE {} and {} (published: {} and {})",
                    name, attacker.text, mean_text(ours.mean_m[0]), mean_text(ours.mean_m[1]),
                    row.mean_m[0], row.mean_m[1], mean_text(ours.peak_m[0]),
                    mean_text(ours.peak_m[1]), row.peak_m[0], row.peak_m[1]));
  }
  const auto better = std::ranges::count_if(samples, is_rain_better);
  summary.compared.push_back(compare_claim(
      fmt::format("mean and peak RMSE of RAIN below those of CD (attacked: {})", attacker.text),
      fmt::format("in {} rows of {}", better, samples.size()), "in every row",
      better == std::ssize(samples)));
}

Summary summarise(const Tables& tables) {
  const auto samples = samples_of(tables);
  Summary summary;
  summary.files = {{"curves.csv", curves_csv(tables)}};
  for (std::size_t i = 0; i < kAttackers.size(); ++i) {
    summary.files[fmt::format("table_{}.csv", kAttackers[i].name)] = table_csv(samples[i]);
    compare_table(samples[i], kAttackers[i], summary);
  }
  summary.figure_script = resilient_tracking_figure();
  summary.figures = {"resilient-tracking"};
  summary.choices = {
      "The source does not state the targets' prior, the nodes per search and the update after a "
      "scan without detection: see the settings below.",
      "The attacker's worst case is approximated greedily, as in the source; the second table is "
      "for an attacker that chooses the robots whose single plans gain most."};
  return summary;
}

}  // namespace

Sweep resilient_tracking(const Extent& extent) {
  const TrackingSetting setting = setting_of(extent);
  Sweep sweep;
  sweep.plan.setting_columns = "attacker,robots,targets,attacks,method";
  for (const NamedAttacker& attacker : kAttackers) {
    for (const TrackingTableRow& row : kTrackingTable) {
      for (const char* method : kTrackingMethods) {
        sweep.plan.settings.push_back({fmt::format("{},{},{},{},{}", attacker.name, row.robots,
                                                   row.targets, row.attacks, method)});
      }
    }
  }
  sweep.plan.trials = extent.trials_or(kRuns);
  sweep.plan.parameters = parameters_of(setting);
  sweep.plan.tables = {{"runs", "mean_rmse_m,peak_rmse_m,mean_entropy_nats"},
                       {"steps", "step,rmse_m,entropy_nats"}};
  sweep.run = [setting](std::size_t index, std::uint64_t seed) {
    return run_unit(setting, index, seed);
  };
  sweep.summarise = summarise;
  return sweep;
}

}  // namespace vantage::experiments
