#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/process.hpp"
#include "core/utf8.hpp"
#include "core/write_file.hpp"
#include "logs/export/csv_export.hpp"
#include "logs/export/mcap_export.hpp"
#include "logs/export/result_tables.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/log_scenario.hpp"

namespace vantage::tools {
namespace {

struct ExportArguments {
  std::string log;
  std::string format;
  std::string output;
  std::vector<std::string> include;
  std::string profile = "foxglove";
  bool messages_only = false;
  bool is_raw = false;
  bool force = false;
};

// Prints one line for each channel with events left out, for at most kNamed channels.
void print_left_out(const logs::IndexedLog& log, const logs::ExportCounts& counts) {
  constexpr int kNamed = 20;
  int named = 0;
  for (const auto& [channel, events] : counts.left_out) {
    if (++named > kNamed) {
      print_line(fmt::format("{}: … and events of {} more channels", log.path(),
                             counts.left_out.size() - kNamed),
                 stderr);
      break;
    }
    const std::int64_t all = log.survey().channels.at(channel).events;
    print_line(
        fmt::format(
            "{}: {}: {} of {} events were not exported: they are not messages of this version of "
            "vantage",
            log.path(), readable(channel), events, all),
        stderr);
  }
}

int report(const logs::IndexedLog& log, const ExportArguments& arguments,
           const logs::ExportCounts& counts) {
  print_line(fmt::format("{}: {} messages", arguments.output, counts.messages));
  print_left_out(log, counts);
  if (counts.times_held > 0) {
    fmt::print(stderr,
               "{}: the times of {} messages were changed to the nearest time that MCAP supports "
               "(1970 to 2262)\n",
               log.path(), counts.times_held);
  }
  if (!counts.failure.empty()) {
    print_line("vantage: " + counts.failure, stderr);
  } else if (counts.is_stopped) {
    print_line(
        "vantage: interrupted: the output is valid, but contains only a part of " + arguments.log,
        stderr);
  }
  return counts.failure.empty() && !counts.is_stopped && counts.left_out.empty() ? 0 : 1;
}

int run(const ExportArguments& arguments) {
  const logs::IndexedLog log = open_log(arguments.log);
  require_channels(log, arguments.include);
  logs::ChannelFilter channels(arguments.include, {});
  std::error_code error;
  const bool is_there = std::filesystem::exists(arguments.output, error);
  if (arguments.format == "csv" && is_there &&
      !std::filesystem::is_directory(arguments.output, error)) {
    throw StartupError(arguments.output +
                       ": is not a folder; CSV tables need a folder; choose another --out");
  }
  if (!arguments.force && is_there && !std::filesystem::is_empty(arguments.output, error)) {
    throw StartupError(arguments.output +
                       ": exists already; choose another name, or overwrite it with --force");
  }
  if (arguments.format == "csv" && !arguments.is_raw && arguments.include.empty() &&
      find_scenario_notice(log)) {
    return report(log, arguments,
                  logs::export_results(log, scenario_of(log), arguments.output,
                                       progress_line("writing"), stop_requested));
  }
  if (arguments.format == "csv") {
    return report(log, arguments,
                  logs::export_csv(log, arguments.output, channels, progress_line("writing"),
                                   stop_requested));
  }
  require_writable(arguments.output);
  if (arguments.profile == "ros2") {
    return report(log, arguments,
                  logs::export_ros2(log, arguments.output, channels, progress_line("writing"),
                                    stop_requested));
  }
  return report(log, arguments,
                logs::export_mcap(log, arguments.output, channels, !arguments.messages_only,
                                  progress_line("writing"), stop_requested));
}

}  // namespace

void add_log_export_command(CLI::App& log, Runner& chosen) {
  CLI::App* command =
      log.add_subcommand("export", "Export a log as CSV tables or as an MCAP file.");
  auto arguments = std::make_shared<ExportArguments>();
  command->add_option("log", arguments->log, "LCM event log")->required();
  command->add_option("--to", arguments->format, "output format: csv or mcap")
      ->required()
      ->check(one_of({"csv", "mcap"}));
  command->add_option("--out", arguments->output, "csv: folder for the tables; mcap: file to write")
      ->required();
  command->add_option(
      "--channels", arguments->include,
      "channels to export; regular expressions that match whole names; default: all. With csv: "
      "as --raw");
  command
      ->add_option(
          "--profile", arguments->profile,
          "mcap: foxglove (all messages as JSON) or ros2 (messages that have a ROS 2 type, as CDR; "
          "see docs/guide/ros2.md)")
      ->check(one_of({"foxglove", "ros2"}))
      ->capture_default_str();
  command->add_flag(
      "--raw", arguments->is_raw,
      "csv: a table CHANNEL.csv with every field of every message, instead of results");
  command->add_flag("--messages-only", arguments->messages_only,
                    "mcap: leave out the drawings and events in Foxglove's schemas");
  command->add_flag("--force", arguments->force, "overwrite existing files");
  command->footer(
      "CSV: estimates.csv (t_s, robot, target, x_m, y_m, sigma_m, error_m), plans.csv,\n"
      "vehicles.csv, poses.csv and contacts.csv; t_s counts from the start of the log. With "
      "--raw,\n"
      "or without a SCENARIO message, each channel becomes a table CHANNEL.csv with every field;\n"
      "a message with a list (bodies, targets, …) becomes one row per element. MCAP: JSON\n"
      "messages with their schemas, for Foxglove, Lichtblick and PlotJuggler. Details:\n"
      "docs/guide/logs.md.\n"
      "Ctrl-C ends the export at once; the files are valid, but incomplete.\n"
      "Exit code 1: interrupted, or the disk is full, or events that are not messages of this\n"
      "version were left out (their channels are listed).\n"
      "Examples:\n"
      "  vantage log export flight.lcmlog --to csv --out flight-csv\n"
      "  vantage log export flight.lcmlog --to csv --out raw-csv --channels 'PLAN_.*'\n"
      "  vantage log export flight.lcmlog --to mcap --out flight.mcap\n"
      "  vantage log export flight.lcmlog --to mcap --profile ros2 --out flight-ros2.mcap");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
