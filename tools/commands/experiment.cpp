#include "experiments/experiment.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "core/check.hpp"
#include "core/process.hpp"
#include "experiments/sweep/report_page.hpp"
#include "experiments/sweep/slurm_run.hpp"
#include "experiments/sweep/sweep_run.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"
#include "trial/observe/announcer.hpp"

namespace vantage::tools {
namespace {

struct ExperimentArguments {
  std::string name;
  std::string shard;
  std::uint64_t seed = 1;
  experiments::Extent extent;
  experiments::SweepOptions options;
  bool is_on_slurm = false;
  bool is_detached = false;
  experiments::SlurmOptions slurm;
};

// Parses a shard: "2/8" is the second of eight.
experiments::Shard shard_of(const std::string& text) {
  experiments::Shard shard;
  char end = '\0';
  if (std::sscanf(text.c_str(), "%d/%d%c", &shard.number, &shard.of, &end) != 2 || shard.of < 1 ||
      shard.number < 1 || shard.number > shard.of) {
    throw StartupError("--shard: '" + text + "' is not i/n with 1 ≤ i ≤ n");
  }
  return shard;
}

// Replaces the current line of the terminal if standard error is a terminal.
void show_line(const std::string& text) {
  if (::isatty(STDERR_FILENO) == 1) {
    fmt::print(stderr, "\r\033[K{}", text);
  }
}

std::string only_text(const ExperimentArguments& arguments) {
  std::string text;
  for (const std::string& beginning : arguments.options.only) {
    text += " --only " + shell_quoted(beginning);
  }
  return text;
}

// Prints the number of completed units and the command that continues the experiment.
void print_stopped(const ExperimentArguments& arguments, const experiments::SweepIdentity& identity,
                   const experiments::SweepProgress& progress) {
  fmt::print(
      stderr,
      "stopped with {} of {} units done; their rows are kept. To continue: {} --out {}{}{}\n",
      progress.done, progress.units, experiments::command_of(identity, arguments.extent.trials),
      shell_quoted(arguments.options.directory),
      arguments.shard.empty() ? "" : " --shard " + arguments.shard, only_text(arguments));
}

int print_outcome(const ExperimentArguments& arguments, const experiments::SweepIdentity& identity,
                  const experiments::SweepOutcome& outcome) {
  show_line("");
  for (const std::string& line : outcome.lines) {
    print_line(line);
  }
  const std::string command = experiments::command_of(identity, arguments.extent.trials) +
                              " --out " + shell_quoted(arguments.options.directory);
  if (outcome.is_stopped) {
    print_stopped(arguments, identity, outcome.progress);
    return 1;
  }
  if (!arguments.options.only.empty()) {
    print_line(fmt::format(
        "{} units done; their tables are in {}. To run all settings and write a report: {}",
        outcome.progress.done, arguments.options.directory, command));
  } else if (arguments.options.shard) {
    print_line(fmt::format("shard {}: {} units done. When all shards are done, run: {}",
                           arguments.shard, outcome.progress.done, command));
  }
  return 0;
}

// Returns the exit code; 1 if interrupted, or if jobs ended before all of their units were
// complete.
int run_as_jobs(ExperimentArguments& arguments, const experiments::SweepIdentity& identity,
                const experiments::Sweep& sweep, const char* what) {
  experiments::SlurmOptions& slurm = arguments.slurm;
  slurm.command = {std::filesystem::read_symlink("/proc/self/exe").string(), "experiment",
                   identity.experiment, "--seed", std::to_string(identity.seed)};
  const std::vector<std::string> extent =
      identity.is_smoke
          ? std::vector<std::string>{"--smoke"}
          : std::vector<std::string>{"--trials", std::to_string(arguments.extent.trials)};
  slurm.command.insert(slurm.command.end(), extent.begin(), extent.end());
  if (identity.planning_share != 1.0) {
    slurm.command.insert(slurm.command.end(),
                         {"--planning-share", fmt::format("{}", identity.planning_share)});
  }
  const std::string directory = std::filesystem::absolute(arguments.options.directory).string();
  slurm.command.insert(slurm.command.end(),
                       {"--jobs", std::to_string(arguments.options.jobs), "--out", directory});
  slurm.cores_per_task = arguments.options.jobs;
  slurm.is_waiting = !arguments.is_detached;
  slurm.print_line = [](const std::string& line) {
    show_line("");
    print_line(line);
  };
  slurm.progress = [](const experiments::SweepProgress& progress, const std::string& jobs) {
    show_line(experiments::progress_text(progress) + "; " + jobs);
  };
  const experiments::SlurmEnd end =
      experiments::run_on_slurm(sweep, identity, what, arguments.options, slurm);
  return end == experiments::SlurmEnd::kCollected ||
                 (end == experiments::SlurmEnd::kSubmitted && !slurm.is_waiting)
             ? 0
             : 1;
}

int run(ExperimentArguments arguments) {
  const std::vector<experiments::Experiment>& all = experiments::all_experiments();
  const auto experiment = std::find_if(
      all.begin(), all.end(),
      [&](const experiments::Experiment& each) { return each.name == arguments.name; });
  if (!arguments.shard.empty()) {
    arguments.options.shard = shard_of(arguments.shard);
  }
  if (arguments.options.directory.empty()) {
    arguments.options.directory = "experiments/" + arguments.name;
  }
  arguments.options.stop = stop_requested;
  const experiments::Sweep sweep = experiment->make(arguments.extent);
  arguments.extent.trials = sweep.plan.trials;
  if (arguments.extent.planning_share != 1.0 && !sweep.plan.parameters.contains("planning_share")) {
    throw UsageError(fmt::format(
        "--planning-share: experiment {} has no planning time to reduce; omit the option",
        arguments.name));
  }
  const experiments::SweepIdentity identity{arguments.name, trial::version(), arguments.seed,
                                            arguments.extent.is_smoke,
                                            arguments.extent.planning_share};
  // A unit may take minutes, so a stop discards running units, which have written no rows yet.
  arguments.options.progress = [&](const experiments::SweepProgress& progress) {
    show_line(progress.is_stopping ? "" : experiments::progress_text(progress));
    if (progress.is_stopping) {
      print_stopped(arguments, identity, progress);
      std::_Exit(1);
    }
  };
  if (arguments.is_on_slurm) {
    return run_as_jobs(arguments, identity, sweep, experiment->what);
  }
  return print_outcome(
      arguments, identity,
      experiments::run_sweep(sweep, identity, experiment->what, arguments.options));
}

// Adds --slurm and its options. --slurm cannot be combined with the options `others`.
void add_slurm_options(CLI::App& command, ExperimentArguments& arguments,
                       std::initializer_list<CLI::Option*> others) {
  CLI::Option* slurm = command.add_flag(
      "--slurm", arguments.is_on_slurm,
      "run as an array of Slurm jobs that share the folder --out: submit, wait, collect");
  for (CLI::Option* other : others) {
    slurm->excludes(other);
  }
  command
      .add_option("--shards", arguments.slurm.shards, "with --slurm: number of jobs in the array")
      ->check(number_between(1, 100'000))
      ->capture_default_str()
      ->needs(slurm);
  command
      .add_flag("--no-wait", arguments.is_detached,
                "with --slurm: submit the jobs without waiting for them")
      ->needs(slurm);
  command
      .add_option("--sbatch", arguments.slurm.sbatch,
                  "with --slurm: option for sbatch, such as --sbatch=--time=2:00:00; repeatable")
      ->needs(slurm);
}

}  // namespace

// Long function: it adds the options one by one.
void add_experiment_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "experiment",
      "Repeat an experiment of the dissertation; writes CSV tables, figures and a report.");
  auto arguments = std::make_shared<ExperimentArguments>();
  std::vector<std::string> names;
  std::string footer = "Experiments:\n";
  for (const experiments::Experiment& experiment : experiments::all_experiments()) {
    names.emplace_back(experiment.name);
    footer += fmt::format("  {:20} {}\n", experiment.name, experiment.what);
  }
  command->add_option("name", arguments->name, "experiment, see the list below")
      ->required()
      ->check(one_of(names));
  command
      ->add_option("--trials", arguments->extent.trials,
                   "trials per setting (default: the number that the dissertation used)")
      ->check(number_between(1, 1'000'000));
  command
      ->add_option("--seed", arguments->seed,
                   "seed of the first trial; each further trial uses the next number")
      ->check(seed_number())
      ->capture_default_str();
  command
      ->add_option("--jobs", arguments->options.jobs,
                   "number of threads; each needs about 0.7 GB of memory")
      ->check(number_between(1, 1024))
      ->capture_default_str();
  CLI::Option* shard =
      command->add_option("--shard", arguments->shard,
                          "i/n: run only the i-th of n parts (i from 1 to n) and write its rows");
  CLI::Option* only =
      command
          ->add_option(
              "--only", arguments->options.only,
              "run only settings whose first table cells are these, for example greedy,1,2; "
              "writes tables but no report; repeatable")
          ->allow_extra_args(false);
  add_slurm_options(*command, *arguments, {shard, only});
  command->add_option("--out", arguments->options.directory,
                      "folder for the results (default: experiments/NAME)");
  command
      ->add_option("--planning-share", arguments->extent.planning_share,
                   "share of the planning time to use, in (0, 1]; 0.2: a fifth of the search nodes "
                   "in a fifth of the time. Only for hardware, tracking-communication, "
                   "tracking-time and tracking-noise")
      ->check(number_between(1e-6, 1.0))
      ->capture_default_str();
  command->add_flag("--smoke", arguments->extent.is_smoke,
                    "quick test that the experiment runs: two trials with short horizons");
  command->footer(
      footer +
      "The same seed gives the same files, except for measured times; --jobs, --shard and\n"
      "interruptions do not change them. Ctrl-C, SIGTERM or a crash keeps completed units; the\n"
      "same command continues. Exit code 1 if interrupted.\n"
      "Examples:\n"
      "  vantage experiment dls-savings --jobs 2 --out results/dls-savings\n"
      "  vantage experiment dls-objective --trials 10 --seed 7\n"
      "  parallel vantage experiment resilient-mapping --out rm --shard {}/8 ::: $(seq "
      "8)\n"
      "  vantage experiment resilient-mapping --out rm\n"
      "  vantage experiment surveillance --only greedy,1,2 --only greedy,10,2 --out s\n"
      "  vantage experiment resilient-tracking --out rt --slurm --shards 20 "
      "--sbatch=--time=2:00:00");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
