#include "logs/export/csv_export.hpp"

#include <cctype>
#include <filesystem>
#include <map>
#include <system_error>
#include <tuple>
#include <utility>

#include "core/check.hpp"
#include "logs/export/csv.hpp"
#include "logs/export/csv_file.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

/// The table of one channel.
struct Table {
  Table(const bus::WireSchema& schema, std::string path)
      : csv(schema), file(std::move(path), csv.header()) {}

  CsvTable csv;
  CsvFile file;
};

}  // namespace

std::string csv_file_name(std::string_view channel) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string out;
  for (const char c : channel) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = byte < 0x80U && (std::isalnum(byte) != 0 || c == '_' || c == '-' ||
                                           (c == '.' && !out.empty()));
    if (is_plain) {
      out += c;
    } else {
      out += {'%', kDigits[byte >> 4U], kDigits[byte & 0x0FU]};
    }
  }
  return out + ".csv";
}

ExportCounts export_csv(const IndexedLog& log, const std::string& folder, ChannelFilter& channels,
                        const std::function<void(double)>& progress,
                        const std::function<bool()>& stop) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw StartupError(folder + ": cannot be created: " + error.message());
  }
  std::map<std::string, Table, std::less<>> tables;
  ExportCounts counts;
  LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    counts.is_stopped = stop();
    if (counts.is_stopped || !counts.failure.empty()) {
      break;
    }
    if (progress && scan.counts().events % kEventsPerReport == 0) {
      progress(static_cast<double>(event->offset) / static_cast<double>(log.bytes().size()));
    }
    if (!channels.takes(event->channel)) {
      continue;
    }
    const std::string name(event->channel);
    const bus::WireSchema* schema = type_of(event->data);
    auto table = tables.find(name);
    if (schema != nullptr && table == tables.end()) {
      table = tables
                  .emplace(std::piecewise_construct, std::forward_as_tuple(name),
                           std::forward_as_tuple(*schema, folder + "/" + csv_file_name(name)))
                  .first;
    }
    const std::string lines =
        schema == nullptr ? "" : table->second.csv.lines(event->time, event->data);
    if (lines.empty()) {
      ++counts.left_out[name];
      continue;
    }
    if (table->second.file.write(lines)) {
      ++counts.messages;
    } else {
      counts.failure = table->second.file.failure();
    }
  }
  for (auto& [name, table] : tables) {
    table.file.close();
    if (counts.failure.empty()) {
      counts.failure = table.file.failure();
    }
  }
  if (progress) {
    progress(1.0);
  }
  return counts;
}

}  // namespace vantage::logs
