#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "tools/experiment/experiment.hpp"
#include "tools/experiment/figures.hpp"
#include "tools/experiment/resilient_tracking.hpp"
#include "tools/experiment/sample.hpp"

namespace vantage::tools {
namespace {

constexpr int kRuns = 10;  // as the dissertation

// A row of Table 4.1: what is printed there for coordinate descent and for RAIN.
struct TableRow {
  int robots;
  int targets;
  int attacks;
  double mean_cd;
  double mean_rain;
  double peak_cd;
  double peak_rain;
};

constexpr std::array<TableRow, 9> kTable = {{{5, 10, 1, 0.28, 0.19, 9.62, 2.09},
                                             {5, 10, 2, 1.47, 0.68, 26.07, 15.71},
                                             {5, 10, 4, 10.67, 4.9, 225.47, 103.82},
                                             {10, 5, 2, 0.35, 0.14, 57.65, 1.87},
                                             {10, 5, 4, 0.39, 0.28, 6.66, 3.17},
                                             {10, 5, 6, 2.07, 0.65, 93.27, 15.63},
                                             {10, 10, 2, 0.13, 0.08, 1.4, 1.32},
                                             {10, 10, 4, 0.24, 0.23, 4.19, 2.66},
                                             {10, 10, 6, 4.39, 1.2, 69.77, 26.4}}};

// All runs of one row by one way to plan.
struct RowResult {
  Sample mean_m;
  Sample peak_m;
  Sample entropy_nats;
  std::vector<double> rmse_sum_m;  ///< per step, over runs
  std::vector<double> entropy_sum_nats;
};

double mean_of(const std::vector<double>& values) {
  Sample sample;
  for (const double value : values) {
    sample.add(value);
  }
  return sample.mean();
}

void add_to(std::vector<double>& sums, const std::vector<double>& values) {
  sums.resize(values.size(), 0.0);
  for (std::size_t t = 0; t < values.size(); ++t) {
    sums[t] += values[t];
  }
}

class TrackingSweep {
 public:
  explicit TrackingSweep(const ExperimentOptions& options) : options_(options) {
    runs_ = options.smoke ? 2 : options.trials > 0 ? options.trials : kRuns;
    rows_ = options.smoke ? 1 : kTable.size();
    setting_.task_steps = options.smoke ? 2 * setting_.plan_steps : setting_.task_steps;
  }

  ExperimentResult run() {
    for (std::size_t row = 0; row < rows_; ++row) {
      RowResult cd = run_row(kTable[row], false);
      RowResult rain = run_row(kTable[row], true);
      table_ += table_line(kTable[row], cd, rain);
      lines_.push_back(report_line(kTable[row], cd, rain));
      note_steps(kTable[row], "cd", cd);
      note_steps(kTable[row], "rain", rain);
    }
    ExperimentResult result;
    result.files = {{"runs.csv", run_lines_}, {"steps.csv", steps_}, {"table.csv", table_}};
    result.settings = {{"runs", runs_},
                       {"task_steps", setting_.task_steps},
                       {"plan_steps", setting_.plan_steps},
                       {"nodes_per_plan", static_cast<double>(setting_.nodes_per_plan)},
                       {"prior_position_sigma_m", setting_.prior_position_sigma_m},
                       {"prior_velocity_sigma_mps", setting_.prior_velocity_sigma_mps},
                       {"detection_probability", setting_.detection_probability}};
    if (!options_.smoke) {
      result.figure = resilient_tracking_figure();
    }
    result.report = lines_;
    return result;
  }

 private:
  RowResult run_row(const TableRow& row, bool is_resilient) {
    RowResult result;
    TrackingSetting setting = setting_;
    setting.robots = row.robots;
    setting.targets = row.targets;
    setting.attacks = row.attacks;
    for (int i = 0; i < runs_; ++i) {
      const TrackingRun run =
          track_under_attack(setting, is_resilient, options_.seed + static_cast<std::uint64_t>(i));
      const double mean_m = mean_of(run.rmse_m);
      const double peak_m = *std::max_element(run.rmse_m.begin(), run.rmse_m.end());
      result.mean_m.add(mean_m);
      result.peak_m.add(peak_m);
      result.entropy_nats.add(mean_of(run.entropy_nats));
      add_to(result.rmse_sum_m, run.rmse_m);
      add_to(result.entropy_sum_nats, run.entropy_nats);
      run_lines_ +=
          fmt::format("{},{},{},{},{},{:.6f},{:.6f},{:.6f}\n", row.robots, row.targets, row.attacks,
                      is_resilient ? "rain" : "cd", i, mean_m, peak_m, mean_of(run.entropy_nats));
      if (options_.progress) {
        options_.progress(static_cast<double>(++done_) /
                          (2.0 * static_cast<double>(rows_) * runs_));
      }
    }
    return result;
  }

  static std::string table_line(const TableRow& row, const RowResult& cd, const RowResult& rain) {
    return fmt::format(
        "{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{},{},{}\n",
        row.robots, row.targets, row.attacks, cd.mean_m.mean(), cd.mean_m.half_interval(),
        rain.mean_m.mean(), rain.mean_m.half_interval(), cd.peak_m.mean(),
        cd.peak_m.half_interval(), rain.peak_m.mean(), rain.peak_m.half_interval(), row.mean_cd,
        row.mean_rain, row.peak_cd, row.peak_rain);
  }

  static std::string report_line(const TableRow& row, const RowResult& cd, const RowResult& rain) {
    return fmt::format(
        "n = {:2}, M = {:2}, α = {}: mean RMSE {:.2f} ± {:.2f} m of CD, {:.2f} ± {:.2f} of RAIN "
        "(printed {} and {}); peak {:.2f} ± {:.2f} and {:.2f} ± {:.2f} (printed {} and {})",
        row.robots, row.targets, row.attacks, cd.mean_m.mean(), cd.mean_m.half_interval(),
        rain.mean_m.mean(), rain.mean_m.half_interval(), row.mean_cd, row.mean_rain,
        cd.peak_m.mean(), cd.peak_m.half_interval(), rain.peak_m.mean(),
        rain.peak_m.half_interval(), row.peak_cd, row.peak_rain);
  }

  // The pictures show ten robots and ten targets.
  void note_steps(const TableRow& row, const char* method, const RowResult& result) {
    if (row.robots != 10 || row.targets != 10) {
      return;
    }
    for (std::size_t t = 0; t < result.rmse_sum_m.size(); ++t) {
      steps_ += fmt::format("{},{},{},{},{},{:.6f},{:.6f}\n", row.robots, row.targets, row.attacks,
                            method, t + 1, result.rmse_sum_m[t] / runs_,
                            result.entropy_sum_nats[t] / runs_);
    }
  }

  ExperimentOptions options_;
  TrackingSetting setting_;
  int runs_ = 0;
  std::size_t rows_ = 0;
  int done_ = 0;
  std::string run_lines_ =
      "robots,targets,attacks,method,run,mean_rmse_m,peak_rmse_m,mean_entropy_nats\n";
  std::string steps_ = "robots,targets,attacks,method,step,rmse_m,entropy_nats\n";
  std::string table_ =
      "robots,targets,attacks,mean_cd_m,mean_cd_ci95,mean_rain_m,mean_rain_ci95,peak_cd_m,"
      "peak_cd_ci95,peak_rain_m,peak_rain_ci95,printed_mean_cd,printed_mean_rain,printed_peak_cd,"
      "printed_peak_rain\n";
  std::vector<std::string> lines_;
};

}  // namespace

ExperimentResult run_resilient_tracking(const ExperimentOptions& options) {
  return TrackingSweep(options).run();
}

}  // namespace vantage::tools
