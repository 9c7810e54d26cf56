#include "trial/trial.hpp"

#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "core/process.hpp"
#include "core/write_file.hpp"
#include "scenario/node_budget.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/report.hpp"
#include "tools/compare/trial_batch.hpp"
#include "tools/live/screen.hpp"
#include "trial/recipe.hpp"
#include "trial/robot_processes.hpp"

namespace vantage::tools {
namespace {

struct TrialArguments {
  std::string scenario;
  scenario::Overrides overrides;
  std::vector<std::string> planners;
  std::string seeds;
  int jobs = 1;
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

void show_count(int done, int all) {
  fmt::print(stderr, "\r{} of {} trials{}", done, all,
             done == all ? "\r                    \r" : "");
}

std::string title_of(const TrialBatch& batch, const scenario::Scenario& scenario) {
  return fmt::format("{}: {} planners, {} seeds, {:g} s", scenario.name, batch.planners.size(),
                     batch.seeds.size(), scenario.duration_s);
}

/// Runs several trials and compares the planners.
int compare(const TrialArguments& arguments) {
  const scenario::Scenario scenario =
      scenario::load_scenario_with(arguments.scenario, arguments.overrides);
  TrialBatch batch;
  batch.scenario_path = arguments.scenario;
  batch.overrides = arguments.overrides;
  batch.planners = arguments.planners;
  if (batch.planners.empty()) {
    batch.planners.push_back(scenario.planner.algorithm);
  }
  batch.seeds = arguments.seeds.empty() ? std::vector<std::uint64_t>{scenario.seed}
                                        : parse_seeds(arguments.seeds);
  batch.log_folder = arguments.log_path;
  batch.jobs = arguments.jobs;
  if (!arguments.svg_path.empty()) {
    require_writable(arguments.svg_path);
  }
  const bool shows = ::isatty(STDERR_FILENO) == 1;
  BatchResult result = run_batch(batch, stop_requested, [shows](int done, int all) {
    if (shows) {
      show_count(done, all);
    }
  });
  clear_echo();
  for (const std::string& error : result.log_errors) {
    print_line("vantage: " + error + "; this trial is left out", stderr);
  }
  if (result.was_stopped) {
    print_line("vantage: stopped; incomplete trials are left out", stderr);
  }
  std::erase_if(result.groups, [](const TrialGroup& group) { return group.trials.empty(); });
  if (result.groups.empty()) {
    print_line("vantage: no trial is complete", stderr);
    return 1;
  }
  if (arguments.as_json) {
    print_json(comparison_json(result.groups));
  } else {
    print_line(title_of(batch, scenario));
    for (const std::string& line : comparison_table(result.groups)) {
      print_line(line);
    }
  }
  if (!arguments.svg_path.empty()) {
    write_file(arguments.svg_path, comparison_figure(result.groups, title_of(batch, scenario)));
  }
  return result.collisions == 0 && result.log_errors.empty() && !result.was_stopped ? 0 : 1;
}

/// Prints what each robot sent to the others, if the trial had a budget or a simulated network.
void print_air(const trial::TrialResult& result, std::size_t robots) {
  std::int64_t sum = 0;
  std::string kinds;
  const double robot_seconds = static_cast<double>(robots) * result.summary.duration_s;
  for (const models::NamedCount& each : result.air_bytes) {
    sum += each.count;
    kinds += fmt::format("{}{} {:.0f}", kinds.empty() ? "" : ", ", each.name,
                         static_cast<double>(each.count) / robot_seconds);
  }
  if (sum > 0) {
    print_line(fmt::format("sent to other robots, bytes per robot and second: {:.0f} ({})",
                           static_cast<double>(sum) / robot_seconds, kinds));
  }
}

int run(const TrialArguments& arguments) {
  if (arguments.planners.size() > 1 || !arguments.seeds.empty()) {
    return compare(arguments);
  }
  scenario::Overrides overrides = arguments.overrides;
  if (!arguments.planners.empty()) {
    overrides.planner = arguments.planners.front();
  }
  scenario::Scenario scenario = scenario::load_scenario_with(arguments.scenario, overrides);
  if (scenario.planner.node_budget <= 0) {
    overrides.node_budget = scenario::kDefaultNodeBudget;
    scenario = scenario::load_scenario_with(arguments.scenario, overrides);
  }
  trial::require_own_processes(scenario);
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
  if (!arguments.as_json) {
    print_air(result, scenario.robots.size());
  }
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
  add_override_options(*command, arguments->overrides, &arguments->planners);
  command
      ->add_option(
          "--seeds", arguments->seeds,
          "several seeds, such as 1-10 or 1,4,7-9; compares one trial per seed and planner")
      ->excludes("--seed");
  command->add_option("--jobs", arguments->jobs, "with several trials: number of threads")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--log", arguments->log_path,
                      "new file for an LCM event log of all messages; with several trials: a "
                      "folder for the logs PLANNER_SEED.lcmlog");
  command->add_option("--svg", arguments->svg_path,
                      "file for a picture of the end of the trial (SVG; also PNG); with several "
                      "trials: a figure of the comparison (SVG)");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Ctrl-C, SIGTERM, closing the terminal or a failure to write the log ends the trial early.\n"
      "Log, summary and pictures then cover the time until the end.\n"
      "Several planners or seeds: the table has a column per planner, with 95 % confidence\n"
      "intervals and the differences to the first planner, paired by seed.\n"
      "Exit code 1: ended early, or a collision; 2: could not start, for example because the log\n"
      "file exists.\n"
      "Examples:\n"
      "  vantage trial config/lab.yaml --seed 3 --json\n"
      "  vantage trial config/lab.yaml --planner greedy --duration-s 60 --svg greedy.svg\n"
      "  vantage trial config/lab.yaml --planner arvi,beam,greedy --seeds 1-10 --jobs 4\n"
      "  vantage trial config/field.yaml --communication-range-m 10 --log field.lcmlog");
  run_on_scenario(*command, chosen, arguments, run);
}

}  // namespace vantage::tools
