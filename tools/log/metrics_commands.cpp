#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "core/process.hpp"
#include "core/utf8.hpp"
#include "core/write_file.hpp"
#include "logs/analysis/log_analysis.hpp"
#include "models/scenario/search_name.hpp"
#include "tools/live/screen.hpp"
#include "tools/live/status_table.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/log_plot.hpp"
#include "tools/log/log_scenario.hpp"

namespace vantage::tools {
namespace {

struct MetricsArguments {
  std::string log;
  std::string output;
  bool as_json = false;
};

std::string row(const std::string& name, const logs::Spread& spread) {
  return fmt::format("{:<20} {:>8} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f}", name, spread.count,
                     1e3 * spread.mean_s, 1e3 * spread.median_s, 1e3 * spread.p95_s,
                     1e3 * spread.worst_s);
}

void print(const models::Scenario& scenario, const logs::LogAnalysis& analysis) {
  for (const std::string& line : summary_table(scenario, analysis.summary)) {
    print_line(line);
  }
  print_line("");
  print_line(fmt::format("{:<20} {:>8} {:>9} {:>9} {:>9} {:>9}", "latency, ms", "count", "mean",
                         "median", "95 %", "worst"));
  for (const auto& [name, spread] : analysis.latencies) {
    print_line(row(name, spread));
  }
  print_line("");
  print_line(fmt::format("{:<20} {:>8} {:>9} {:>9} {:>14} {:>14}", "deadlines", "plans", "late",
                         "fallbacks", "least left, ms", "mean left, ms"));
  for (const auto& [robot, record] : analysis.deadlines) {
    print_line(fmt::format("{:<20} {:>8} {:>9} {:>9} {:>14.2f} {:>14.2f}", robot, record.plans,
                           record.late, record.fallbacks, 1e3 * record.margin.least_s,
                           1e3 * record.margin.mean_s));
  }
  for (const auto& [channel, lost] : analysis.lost) {
    print_line(fmt::format("lost on {}: {} messages", readable(channel), lost));
  }
}

int metrics(const MetricsArguments& arguments) {
  const EndsAtOnce reading;
  const logs::IndexedLog log(arguments.log, progress_line("reading"));
  const models::Scenario scenario = scenario_of(log);
  const logs::LogAnalysis analysis = logs::analyse_log(log, scenario, progress_line("judging"));
  if (arguments.as_json) {
    print_json(logs::to_json(analysis));
  } else {
    print(scenario, analysis);
  }
  return 0;
}

int plot(const MetricsArguments& arguments) {
  static_cast<void>(plot_terminal(arguments.output));  // refused before a long log is read
  require_writable(arguments.output);
  const EndsAtOnce drawing;
  const logs::IndexedLog log(arguments.log, progress_line("reading"));
  const models::Scenario scenario = scenario_of(log);
  const logs::LogAnalysis analysis = logs::analyse_log(log, scenario, progress_line("judging"));
  const std::string script = std::filesystem::path(arguments.output).replace_extension(".gp");
  const std::string title =
      fmt::format("{}: {} with {}", std::filesystem::path(arguments.log).filename().string(),
                  scenario.name, models::search_name(scenario.planner));
  const Result<std::string> drawn =
      draw_plot(plot_script(analysis, scenario, title, arguments.output), script, arguments.output);
  if (!drawn.ok()) {
    fmt::print(stderr, "vantage: {}\n", drawn.error().message);
    return 1;
  }
  print_line(drawn.value());
  return 0;
}

}  // namespace

void add_log_metrics_commands(CLI::App& log, Runner& chosen) {
  auto arguments = std::make_shared<MetricsArguments>();
  CLI::App* metrics_command = log.add_subcommand(
      "metrics", "Judge a log: RMSE, entropy, discovery, deadlines, loss, latencies.");
  metrics_command->add_option("log", arguments->log, "LCM event log")->required();
  metrics_command->add_flag("--json", arguments->as_json, "print one JSON object");
  metrics_command->footer(
      "Latencies are from the instants that messages are valid for to those they were made or\n"
      "logged at; 'look' is the newest measurement that something was made from.\n"
      "Example:\n"
      "  vantage log metrics flight.lcmlog --json");
  metrics_command->callback(
      [&chosen, arguments] { chosen = [arguments] { return metrics(*arguments); }; });

  CLI::App* plot_command =
      log.add_subcommand("plot", "Draw the course of a trial as PNG, SVG or PDF, with gnuplot.");
  plot_command->add_option("log", arguments->log, "LCM event log")->required();
  plot_command
      ->add_option("--out", arguments->output,
                   "the picture, .png, .svg or .pdf; its script lies beside it")
      ->required();
  plot_command->footer(
      "Example:\n"
      "  vantage log plot flight.lcmlog --out flight.png\n"
      "  vantage log plot flight.lcmlog --out flight.pdf");
  plot_command->callback(
      [&chosen, arguments] { chosen = [arguments] { return plot(*arguments); }; });
}

}  // namespace vantage::tools
