#include "tools/up/log_tail.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/check.hpp"
#include "logs/file/log_scan.hpp"
#include "logs/file/mapped_file.hpp"
#include "logs/file/wire_witness.hpp"

namespace vantage::tools {
namespace {

// Twice the largest message that LCM's stock settings carry here.
constexpr std::size_t kTailBytes = std::size_t{8} << 20U;
constexpr std::size_t kSearchedBytes = std::size_t{1} << 20U;

std::span<const std::uint8_t> last_of(const logs::MappedFile& file, std::size_t bytes) {
  return file.bytes().last(std::min(bytes, file.bytes().size()));
}

}  // namespace

LogTail find_tail(std::span<const std::uint8_t> last_bytes) {
  LogTail tail;
  logs::LogScan scan(last_bytes, logs::wire_testimony);
  while (const auto event = scan.next()) {
    tail.whole_bytes = event->offset + event->size_bytes();
    tail.last = event->time;
  }
  return tail;
}

TrimmedLog trim_log(const std::string& path) {
  TrimmedLog trimmed;
  std::error_code error;
  trimmed.size_bytes = std::filesystem::file_size(path, error);
  if (error) {
    return {};
  }
  {
    const logs::MappedFile file(path);
    const auto last_bytes = last_of(file, kTailBytes);
    const LogTail tail = find_tail(last_bytes);
    trimmed.last = tail.last;
    trimmed.dropped_bytes = tail.last ? last_bytes.size() - tail.whole_bytes : 0;
  }
  if (trimmed.dropped_bytes > 0) {
    trimmed.size_bytes -= trimmed.dropped_bytes;
    std::filesystem::resize_file(path, trimmed.size_bytes, error);
    if (error) {
      throw StartupError(path + ": its unfinished end cannot be cut off: " + error.message());
    }
  }
  return trimmed;
}

std::optional<Time> event_time_at(const std::string& path, std::uint64_t offset) {
  const logs::MappedFile file(path);
  const auto event =
      offset < file.bytes().size() ? logs::event_at(file.bytes(), offset) : std::nullopt;
  return event ? std::optional(event->time) : std::nullopt;
}

bool ends_with(const std::string& path, std::span<const std::uint8_t> bytes) {
  const logs::MappedFile file(path);
  const auto last_bytes = last_of(file, kSearchedBytes);
  return std::search(last_bytes.begin(), last_bytes.end(), bytes.begin(), bytes.end()) !=
         last_bytes.end();
}

}  // namespace vantage::tools
