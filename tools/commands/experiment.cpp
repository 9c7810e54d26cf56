#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "tools/commands/commands.hpp"
#include "tools/experiment/experiment_files.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

struct ExperimentArguments {
  std::string name;
  std::string directory;
  ExperimentOptions options;
};

void show_progress(double share) {
  fmt::print(stderr, "\rexperiment {:3.0f} %", 100.0 * share);
  if (share >= 1.0) {
    fmt::print(stderr, "\r                \r");
  }
}

int run(ExperimentArguments arguments) {
  if (::isatty(STDERR_FILENO) == 1) {
    arguments.options.progress = show_progress;
  }
  for (const Experiment& experiment : all_experiments()) {
    if (experiment.name != arguments.name) {
      continue;
    }
    const std::string directory =
        arguments.directory.empty() ? "experiments/" + arguments.name : arguments.directory;
    for (const std::string& line : run_experiment(experiment, arguments.options, directory)) {
      print_line(line);
    }
  }
  return 0;
}

}  // namespace

void add_experiment_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "experiment", "Repeat an experiment of the dissertation: CSV, manifest and figures.");
  auto arguments = std::make_shared<ExperimentArguments>();
  std::vector<std::string> names;
  std::string footer = "Experiments:\n";
  for (const Experiment& experiment : all_experiments()) {
    names.emplace_back(experiment.name);
    footer += fmt::format("  {:20} {}\n", experiment.name, experiment.what);
  }
  command->add_option("name", arguments->name, "which")->required()->check(CLI::IsMember(names));
  command
      ->add_option("--trials", arguments->options.trials,
                   "of each setting; when not given, as many as the dissertation ran")
      ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option("--seed", arguments->options.seed,
                   "of the first trial; the next one's is 1 more")
      ->capture_default_str();
  command->add_option("--out", arguments->directory,
                      "directory of the results; experiments/NAME when not given");
  command->add_flag("--smoke", arguments->options.smoke,
                    "two trials of the smallest settings: does it run at all");
  command->footer(footer +
                  "The same seed gives the same files, but for times.csv.\n"
                  "Examples:\n"
                  "  vantage experiment dls-savings --out results/dls-savings\n"
                  "  vantage experiment dls-objective --trials 10 --seed 7");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
