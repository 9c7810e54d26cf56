#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "core/check.hpp"
#include "logs/export/csv.hpp"
#include "logs/export/mcap_export.hpp"
#include "logs/file/wire_witness.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"

namespace vantage::tools {
namespace {

struct ExportArguments {
  std::string log;
  std::string format;
  std::string output;
  std::vector<std::string> include;
  bool messages_only = false;
  bool force = false;
};

/// One table being written.
struct Table {
  Table(const bus::WireSchema& schema, const std::string& path)
      : csv(schema), out(path, std::ios::binary) {
    if (!out) {
      throw StartupError(path + ": cannot be written");
    }
    out << csv.header();
  }
  logs::CsvTable csv;
  std::ofstream out;
};

int report(const std::string& output, std::uint64_t messages, std::int64_t not_exported,
           bool is_written) {
  print_line(fmt::format("{}: {} messages", output, messages));
  if (not_exported > 0) {
    fmt::print(stderr, "{} events are no messages of this version and were left out\n",
               not_exported);
  }
  if (!is_written) {
    fmt::print(stderr, "{}: not all could be written\n", output);
  }
  return is_written ? 0 : 1;
}

int export_csv(const ExportArguments& arguments, const logs::IndexedLog& log,
               logs::ChannelFilter& channels) {
  std::filesystem::create_directories(arguments.output);
  std::map<std::string, std::unique_ptr<Table>, std::less<>> tables;
  std::uint64_t messages = 0;
  std::int64_t not_exported = 0;
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    if (!channels.takes(event->channel)) {
      continue;
    }
    const bus::WireSchema* schema = logs::type_of(event->data);
    auto table = tables.find(event->channel);
    if (schema != nullptr && table == tables.end()) {
      const std::string name(event->channel);
      const std::string path = arguments.output + "/" + name + ".csv";
      table = tables.emplace(name, std::make_unique<Table>(*schema, path)).first;
    }
    const std::string lines =
        schema == nullptr ? "" : table->second->csv.lines(event->time, event->data);
    if (lines.empty()) {
      ++not_exported;
      continue;
    }
    table->second->out << lines;
    ++messages;
  }
  bool is_written = true;
  for (auto& [name, table] : tables) {
    is_written &= table->out.flush().good();
  }
  return report(arguments.output, messages, not_exported, is_written);
}

int run(const ExportArguments& arguments) {
  const logs::IndexedLog log(arguments.log, progress_line("reading"));
  logs::ChannelFilter channels(arguments.include, {});
  std::error_code error;
  if (!arguments.force && std::filesystem::exists(arguments.output, error) &&
      !std::filesystem::is_empty(arguments.output, error)) {
    throw StartupError(arguments.output + ": exists; --force writes over it");
  }
  if (arguments.format == "csv") {
    return export_csv(arguments, log, channels);
  }
  const logs::McapExportCounts counts = logs::export_mcap(
      log, arguments.output, channels, !arguments.messages_only, progress_line("writing"));
  return report(arguments.output, counts.messages, counts.not_exported, counts.is_written);
}

}  // namespace

void add_log_export_command(CLI::App& log, Runner& chosen) {
  CLI::App* command = log.add_subcommand("export", "Write a log as CSV tables or as an MCAP file.");
  auto arguments = std::make_shared<ExportArguments>();
  command->add_option("log", arguments->log, "LCM event log")->required();
  command->add_option("--to", arguments->format, "csv or mcap")
      ->required()
      ->check(CLI::IsMember({"csv", "mcap"}));
  command->add_option("--out", arguments->output, "csv: folder of CHANNEL.csv; mcap: file")
      ->required();
  command->add_option("--channels", arguments->include,
                      "the ones to write (expressions that match whole names); all else");
  command->add_flag("--messages-only", arguments->messages_only,
                    "mcap: without the pictures and events in the Foxglove schemas");
  command->add_flag("--force", arguments->force, "write over what is there");
  command->footer(
      "CSV: a message with a list (bodies, targets, …) is one line an element. MCAP: JSON "
      "messages\n"
      "with their schemas; Foxglove, Lichtblick and PlotJuggler open it. Details: docs/logs.md.\n"
      "Examples:\n"
      "  vantage log export flight.lcmlog --to csv --out flight-csv --channels 'PLAN_.*'\n"
      "  vantage log export flight.lcmlog --to mcap --out flight.mcap");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
