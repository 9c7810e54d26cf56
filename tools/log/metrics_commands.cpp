#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/process.hpp"
#include "core/utf8.hpp"
#include "core/write_file.hpp"
#include "logs/analysis/log_analysis.hpp"
#include "scenario/reader/differences.hpp"
#include "scenario/search_name.hpp"
#include "tools/compare/comparison.hpp"
#include "tools/live/screen.hpp"
#include "tools/live/status_table.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/log_plot.hpp"
#include "tools/log/log_scenario.hpp"

namespace vantage::tools {
namespace {

struct MetricsArguments {
  std::vector<std::string> logs;
  std::string output;  ///< path of the picture; empty: none
  bool as_json = false;
  bool is_of_latency = false;
  bool pools = false;
};

std::string row(const std::string& name, const logs::Spread& spread) {
  return fmt::format("{:<20} {:>8} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f}", name, spread.count,
                     1e3 * spread.mean_s, 1e3 * spread.median_s, 1e3 * spread.p95_s,
                     1e3 * spread.worst_s);
}

void print(const scenario::Scenario& scenario, const logs::LogAnalysis& analysis) {
  for (const std::string& line : summary_table(scenario, analysis.summary)) {
    print_line(line);
  }
  if (analysis.sets) {
    print_line(fmt::format("targets as a set, per robot: OSPA {:.3f} m, {:.2f} swaps per minute",
                           analysis.sets->ospa_m, analysis.sets->swaps_per_min));
  }
  print_line("");
  print_line(fmt::format("{:<20} {:>8} {:>9} {:>9} {:>9} {:>9}", "latency, ms", "count", "mean",
                         "median", "95 %", "worst"));
  for (const auto& [name, spread] : analysis.latencies) {
    print_line(row(name, spread));
  }
  print_line("");
  print_line(fmt::format("{:<20} {:>8} {:>9} {:>9} {:>14} {:>14}", "deadlines", "plans", "late",
                         "fallbacks", "min margin, ms", "avg margin, ms"));
  for (const auto& [robot, record] : analysis.deadlines) {
    print_line(fmt::format("{:<20} {:>8} {:>9} {:>9} {:>14.2f} {:>14.2f}", robot, record.plans,
                           record.late, record.fallbacks, 1e3 * record.margin.least_s,
                           1e3 * record.margin.mean_s));
  }
  if (analysis.times_outlying > 0) {
    print_line(fmt::format("left out: {} events that are more than a day away from all others",
                           analysis.times_outlying));
  }
  for (const auto& [channel, lost] : analysis.lost) {
    print_line(fmt::format("lost on {}: {} messages", readable(channel), lost));
  }
}

void warn_of_two_publishers(const std::string& path, const logs::LogAnalysis& analysis) {
  for (const std::string& channel : analysis.contested) {
    print_line(fmt::format("vantage: {}: two processes published {} at the same time; the results "
                           "mix both",
                           path, readable(channel)),
               stderr);
  }
}

void print_hops(const logs::LogAnalysis& analysis) {
  if (analysis.hops.empty()) {
    print_line(
        "no latencies in this log: only drivers of vehicles and motion capture measure them");
    return;
  }
  print_line(fmt::format("{:<16} {:<22} {:>9} {:>9} {:>9}", "latency, us", "from_to", "median",
                         "99 %", "worst"));
  for (const auto& [process, hops] : analysis.hops) {
    for (const logs::Hop& hop : hops) {
      print_line(fmt::format("{:<16} {:<22} {:>9} {:>9} {:>9}", process, hop.name, hop.p50_us,
                             hop.p99_us, hop.max_us));
    }
  }
}

/// Logs in groups. Within a group, all scenarios have equal values of the keys in `keys`.
struct LogGroups {
  std::vector<std::string> keys;  ///< keys whose values differ between the logs, except the seed
  std::vector<std::vector<std::string>> values;  ///< values of these keys, by group and key
  std::vector<TrialGroup> groups;
};

LogGroups grouped(const std::vector<scenario::Scenario>& scenarios,
                  const std::vector<logs::LogAnalysis>& analyses, bool pools) {
  std::vector<std::string> texts;
  for (const scenario::Scenario& scenario : scenarios) {
    texts.push_back(scenario.source_text);
  }
  std::map<std::string, std::vector<std::string>> differing;
  if (!pools) {
    differing = scenario::differing_keys(texts);
    differing.erase("seed");
  }
  LogGroups out;
  for (const auto& [key, column] : differing) {
    out.keys.push_back(key);
  }
  for (std::size_t i = 0; i < analyses.size(); ++i) {
    std::vector<std::string> values;
    for (const auto& [key, column] : differing) {
      values.push_back(column[i]);
    }
    const auto found = std::find(out.values.begin(), out.values.end(), values);
    const auto g = static_cast<std::size_t>(found - out.values.begin());
    if (found == out.values.end()) {
      out.values.push_back(values);
      out.groups.push_back(
          {out.keys.size() == 1 ? values.front() : fmt::format("group {}", g + 1), {}});
    }
    out.groups[g].trials.push_back({scenarios[i].seed, quantities_of(analyses[i])});
  }
  return out;
}

/// Prints means with confidence intervals over logs, one column per group, and draws them into
/// `svg_path` unless it is empty. Steps of one trial are correlated; only trials are independent
/// samples.
void print_groups(LogGroups logs, const std::string& svg_path) {
  if (logs.keys.empty()) {
    logs.groups.front().name = "all logs";
  } else {
    print_line(fmt::format("the scenarios differ in {}: one column per value; --pool averages all",
                           fmt::join(logs.keys, ", ")));
  }
  for (std::size_t g = 0; logs.keys.size() > 1 && g < logs.groups.size(); ++g) {
    for (std::size_t k = 0; k < logs.keys.size(); ++k) {
      print_line(fmt::format("{:<10} {}: {}", k == 0 ? logs.groups[g].name : "", logs.keys[k],
                             readable(logs.values[g][k])));
    }
  }
  for (const std::string& line : comparison_table(logs.groups)) {
    print_line(line);
  }
  if (!svg_path.empty()) {
    write_file(svg_path,
               comparison_figure(logs.groups, logs.keys.empty()
                                                  ? "all logs"
                                                  : fmt::format("{}", fmt::join(logs.keys, ", "))));
    print_line("picture  " + svg_path);
  }
}

int metrics(const MetricsArguments& arguments) {
  if (!arguments.output.empty()) {
    require(arguments.logs.size() > 1, "--svg: needs several logs; `log plot` draws one");
    require_writable(arguments.output);
  }
  const DefaultSignalScope reading;
  std::vector<logs::LogAnalysis> analyses;
  std::vector<scenario::Scenario> scenarios;
  for (const std::string& path : arguments.logs) {
    const logs::IndexedLog log(path, progress_line("reading"));
    scenarios.push_back(scenario_of(log));
    const scenario::Scenario& scenario = scenarios.back();
    logs::LogAnalysis analysis = logs::analyse_log(log, scenario, progress_line("evaluating"));
    warn_of_two_publishers(path, analysis);
    if (arguments.as_json) {
      print_json(logs::to_json(analysis));
    } else if (arguments.is_of_latency) {
      print_hops(analysis);
    } else if (arguments.logs.size() == 1) {
      print(scenario, analysis);
    }
    analyses.push_back(std::move(analysis));
  }
  if (!arguments.as_json && !arguments.is_of_latency && analyses.size() > 1) {
    print_groups(grouped(scenarios, analyses, arguments.pools), arguments.output);
  }
  return 0;
}

int plot(const MetricsArguments& arguments) {
  static_cast<void>(plot_terminal(arguments.output));  // checks the name before reading the log
  require_writable(arguments.output);
  const DefaultSignalScope drawing;
  const std::string& path = arguments.logs.front();
  const logs::IndexedLog log(path, progress_line("reading"));
  const scenario::Scenario scenario = scenario_of(log);
  const logs::LogAnalysis analysis = logs::analyse_log(log, scenario, progress_line("evaluating"));
  const std::string script = std::filesystem::path(arguments.output).replace_extension(".gp");
  const std::string title =
      fmt::format("{}: {} with {}", std::filesystem::path(path).filename().string(), scenario.name,
                  scenario::search_name(scenario.planner));
  const Result<std::string> drawn =
      draw_plot(plot_script(analysis, scenario, title, arguments.output), script, arguments.output);
  if (!drawn.ok()) {
    print_line("vantage: " + drawn.error().message, stderr);
    return 1;
  }
  print_line(drawn.value());
  return 0;
}

}  // namespace

void add_log_metrics_commands(CLI::App& log, Runner& chosen) {
  auto arguments = std::make_shared<MetricsArguments>();
  CLI::App* metrics_command = log.add_subcommand(
      "metrics",
      "Evaluate a log: RMSE, OSPA, swaps, entropy, NEES, discovery, deadlines, loss, latencies.");
  metrics_command
      ->add_option("log", arguments->logs,
                   "LCM event log. With several logs: means with confidence intervals, and one "
                   "column for each setting in which their scenarios differ")
      ->required();
  metrics_command->add_flag("--json", arguments->as_json, "print one JSON object per log");
  metrics_command->add_flag(
      "--latency", arguments->is_of_latency,
      "print only the latency of each driver between motion-capture frame and set-point");
  metrics_command->add_flag("--pool", arguments->pools,
                            "average all logs together, even if their scenarios differ");
  metrics_command
      ->add_option("--svg", arguments->output,
                   "with several logs: file for a figure of the comparison (SVG)")
      ->excludes("--json")
      ->excludes("--latency");
  metrics_command->footer(
      "A latency is the time from the instant for which the input is valid until the output is\n"
      "finished or logged; 'look' is the newest measurement that was used. The margin of a plan\n"
      "is the time left until its deadline.\n"
      "NEES is computed for each robot from its own belief; a consistent filter has mean 2 in the\n"
      "plane. OSPA (order 2, cutoff 1 m) and swaps compare the set of each robot's estimates\n"
      "with the set of targets, without their ids.\n"
      "Examples:\n"
      "  vantage log metrics flight.lcmlog --json\n"
      "  vantage log metrics flight.lcmlog --latency\n"
      "  vantage log metrics trial_*.lcmlog --svg comparison.svg");
  metrics_command->callback(
      [&chosen, arguments] { chosen = [arguments] { return metrics(*arguments); }; });

  CLI::App* plot_command =
      log.add_subcommand("plot", "Plot a trial over time as PNG, SVG or PDF (needs gnuplot).");
  arguments->logs.resize(1);
  plot_command->add_option("log", arguments->logs.front(), "LCM event log")->required();
  plot_command
      ->add_option(
          "--out", arguments->output,
          "picture to write: .png, .svg or .pdf; the gnuplot script is written next to it (.gp)")
      ->required();
  plot_command->footer(
      "Example:\n"
      "  vantage log plot flight.lcmlog --out flight.png\n"
      "  vantage log plot flight.lcmlog --out flight.pdf");
  plot_command->callback(
      [&chosen, arguments] { chosen = [arguments] { return plot(*arguments); }; });
}

}  // namespace vantage::tools
