#include "trial/trial.hpp"

#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "core/process.hpp"
#include "core/write_file.hpp"
#include "scenario/node_budget.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/report.hpp"
#include "tools/live/screen.hpp"
#include "trial/recipe.hpp"

namespace vantage::tools {
namespace {

struct TrialArguments {
  std::string scenario;
  scenario::Overrides overrides;
  std::string log_path;
  std::string svg_path;
  bool as_json = false;
};

void show_progress(double share) {
  fmt::print(stderr, "\rtrial {:3.0f} %", 100.0 * share);
  if (share >= 1.0) {
    fmt::print(stderr, "\r           \r");
  }
}

int run(const TrialArguments& arguments) {
  scenario::Overrides overrides = arguments.overrides;
  scenario::Scenario scenario = scenario::load_scenario_with(arguments.scenario, overrides);
  if (scenario.planner.node_budget <= 0) {
    overrides.node_budget = scenario::kDefaultNodeBudget;
    scenario = scenario::load_scenario_with(arguments.scenario, overrides);
  }
  if (!arguments.svg_path.empty()) {
    require_writable(arguments.svg_path);
  }
  trial::TrialOptions options;
  options.log_path = arguments.log_path;
  if (::isatty(STDERR_FILENO) == 1) {
    options.progress = show_progress;
  }
  options.stop = stop_requested;
  const trial::TrialResult result =
      trial::run_trial(scenario, trial::trial_recipes(scenario), options);
  report_summary(scenario, result.summary, arguments.as_json);
  if (result.log_error) {
    print_line(fmt::format("vantage: {}; {} messages are missing in the log",
                           result.log_error->message, result.summary.messages_lost),
               stderr);
  }
  if (result.was_stopped) {
    fmt::print(stderr, "trial stopped after {:.1f} s of {:g} s\n", result.summary.duration_s,
               scenario.duration_s);
  }
  const bool has_pictures =
      arguments.svg_path.empty() ||
      write_pictures(arguments.svg_path, scenario, result.scene, result.summary);
  const bool is_good =
      result.summary.collisions == 0 && !result.log_error && !result.was_stopped && has_pictures;
  return is_good ? 0 : 1;
}

}  // namespace

void add_trial_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "trial", "Run one trial in virtual time, without a network; reproducible by its seed.");
  auto arguments = std::make_shared<TrialArguments>();
  add_scenario_option(*command, arguments->scenario);
  add_override_options(*command, arguments->overrides);
  command->add_option("--log", arguments->log_path,
                      "new file for an LCM event log of all messages");
  command->add_option("--svg", arguments->svg_path,
                      "file for a picture of the end of the trial (SVG; also PNG)");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Ctrl-C, SIGTERM, closing the terminal or a failure to write the log ends the trial early.\n"
      "Log, summary and pictures then cover the time until the end.\n"
      "Exit code 1: ended early, or a collision; 2: could not start, for example because the log\n"
      "file exists.\n"
      "Examples:\n"
      "  vantage trial config/lab.yaml --seed 3 --json\n"
      "  vantage trial config/lab.yaml --planner greedy --duration-s 60 --svg greedy.svg\n"
      "  vantage trial config/field.yaml --communication-range-m 10 --log field.lcmlog");
  run_on_scenario(*command, chosen, arguments, run);
}

}  // namespace vantage::tools
