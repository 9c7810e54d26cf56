#include <memory>
#include <optional>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/process.hpp"
#include "core/saturated_time.hpp"
#include "logs/edit/edit.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"

namespace vantage::tools {
namespace {

struct EditArguments {
  std::string input;
  std::vector<std::string> inputs;  ///< input logs of `merge`
  std::string output;
  bool force = false;
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::vector<std::string> include;
  std::vector<std::string> exclude;
  std::vector<std::string> renames;
  bool strict = false;
};

int report(const EditArguments& arguments, const logs::EditCounts& counts, OutputLog& output) {
  const std::string failure = output.finish();
  print_line(fmt::format("{}: {} events", arguments.output, output.events()));
  if (counts.invalid_names > 0) {
    fmt::print(stderr, "{} events left out: their new channel name is longer than 63 bytes\n",
               counts.invalid_names);
  }
  if (!failure.empty()) {
    print_line("vantage: " + failure, stderr);
  } else if (counts.is_stopped) {
    fmt::print(stderr, "vantage: interrupted: the output is valid, but incomplete\n");
  }
  return failure.empty() && !counts.is_stopped && counts.invalid_names == 0 ? 0 : 1;
}

logs::EditRules rules_for(const EditArguments& arguments, const logs::IndexedLog& log) {
  require_channels(log, arguments.include);
  logs::EditRules rules;
  rules.stop = stop_requested;
  rules.channels = logs::ChannelFilter(arguments.include, arguments.exclude);
  rules.names = logs::ChannelRenames(arguments.renames);
  rules.drops_doubtful = arguments.strict;
  if (arguments.from_s) {
    rules.from = saturated_sum(log.survey().begin, saturated_seconds(*arguments.from_s));
  }
  if (arguments.to_s) {
    rules.to = saturated_sum(log.survey().begin, saturated_seconds(*arguments.to_s));
  }
  require(rules.from < rules.to, "--from-s must be less than --to-s");
  return rules;
}

int edit(const EditArguments& arguments) {
  const logs::IndexedLog log = open_log(arguments.input);
  logs::EditRules rules = rules_for(arguments, log);
  OutputLog output(arguments.output, {arguments.input}, arguments.force);
  const logs::EditCounts counts = logs::edit_log(log, rules, output.sink());
  return report(arguments, counts, output);
}

int repair(const EditArguments& arguments) {
  const logs::IndexedLog log = open_log(arguments.input);
  const logs::ScanCounts& scan = log.survey().scan;
  print_line(fmt::format("{}: {} damaged parts dropped ({} bytes), {} doubtful events {}",
                         arguments.input, scan.stretches, scan.bytes_damaged, scan.doubtful,
                         arguments.strict ? "left out" : "kept"));
  return edit(arguments);
}

int merge(const EditArguments& arguments) {
  std::vector<std::unique_ptr<logs::IndexedLog>> opened;
  std::vector<const logs::IndexedLog*> inputs;
  for (const std::string& path : arguments.inputs) {
    opened.push_back(std::make_unique<logs::IndexedLog>(open_log(path)));
    inputs.push_back(opened.back().get());
  }
  OutputLog output(arguments.output, arguments.inputs, arguments.force);
  const logs::EditCounts counts = logs::merge_logs(inputs, output.sink(), stop_requested);
  return report(arguments, counts, output);
}

class Adder {
 public:
  Adder(CLI::App& log, Runner& chosen, const char* name, const char* what, const char* footer,
        int (*action)(const EditArguments&))
      : command_(*log.add_subcommand(name, what)), arguments_(std::make_shared<EditArguments>()) {
    command_.footer(footer);
    command_.add_flag("--force", arguments_->force, "overwrite the output file if it exists");
    command_.callback([&chosen, arguments = arguments_, action] {
      chosen = [arguments, action] { return action(*arguments); };
    });
  }
  Adder& one_input() {
    command_.add_option("log", arguments_->input, "LCM event log")->required();
    command_.add_option("output", arguments_->output, "log to write")->required();
    return *this;
  }
  CLI::App& command() { return command_; }
  EditArguments& arguments() { return *arguments_; }

 private:
  CLI::App& command_;
  std::shared_ptr<EditArguments> arguments_;
};

}  // namespace

// Long function: it adds the commands one by one.
void add_log_edit_commands(CLI::App& log, Runner& run) {
  Adder repair_command(log, run, "repair", "Write the intact events of a damaged log to a new log.",
                       "Every intact event is kept, even between wrong lengths and overwritten or\n"
                       "missing bytes. An incomplete last event is dropped. Events are\n"
                       "renumbered.\n"
                       "Example:\n"
                       "  vantage log repair torn.lcmlog whole.lcmlog",
                       repair);
  repair_command.one_input().command().add_flag(
      "--strict", repair_command.arguments().strict,
      "leave out doubtful events, whose data may be cut off");

  Adder slice(log, run, "slice", "Write the part of a log between two times to a new log.",
              "The new log begins with the last SCENARIO message before the slice. Times are in\n"
              "seconds after the first event.\n"
              "Example:\n"
              "  vantage log slice flight.lcmlog minute.lcmlog --from-s 60 --to-s 120",
              edit);
  slice.one_input();
  slice.command()
      .add_option("--from-s", slice.arguments().from_s,
                  "start of the part, s after the first event")
      ->check(any_number());
  slice.command()
      .add_option("--to-s", slice.arguments().to_s,
                  "end of the part (not included), s after the first event")
      ->check(any_number());

  Adder filter(log, run, "filter", "Write selected channels of a log to a new log.",
               "The regular expressions match whole names: write '.*VICON.*', '(A|B)'.\n"
               "Examples:\n"
               "  vantage log filter flight.lcmlog plans.lcmlog --channels 'PLAN_.*' SCENARIO\n"
               "  vantage log filter flight.lcmlog small.lcmlog --without VICON",
               edit);
  filter.one_input();
  filter.command().add_option("--channels", filter.arguments().include,
                              "channels to keep; regular expressions; default: all");
  filter.command().add_option("--without", filter.arguments().exclude,
                              "channels to leave out; regular expressions");

  Adder rename(log, run, "rename", "Rename channels of a log and write the result to a new log.",
               "Examples:\n"
               "  vantage log rename flight.lcmlog other.lcmlog --rule VICON=MOCAP\n"
               "  vantage log rename flight.lcmlog other.lcmlog --rule 'PLAN_*=OLD_PLAN_*'",
               edit);
  rename.one_input();
  rename.command()
      .add_option("--rule", rename.arguments().renames,
                  "OLD=NEW or OLD*=NEW*; the first matching rule applies")
      ->required();

  Adder merge_command(log, run, "merge", "Merge several logs into one log, ordered by time.",
                      "Example:\n"
                      "  vantage log merge host1.lcmlog host2.lcmlog --out both.lcmlog",
                      merge);
  merge_command.command()
      .add_option("logs", merge_command.arguments().inputs, "LCM event logs to merge, 2 to 64")
      ->required()
      ->expected(2, 64);
  merge_command.command()
      .add_option("--out", merge_command.arguments().output, "log to write")
      ->required();
}

}  // namespace vantage::tools
