#include "logs/record/log_tail.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include "core/check.hpp"
#include "logs/file/log_scan.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

// Twice the largest message that LCM transports with its default settings.
constexpr std::size_t kTailBytes = std::size_t{8} << 20U;
constexpr std::size_t kSearchedBytes = std::size_t{1} << 20U;

using Bytes = std::vector<std::uint8_t>;

// Reads the file instead of mapping it: a disk error or a concurrent truncation then shortens the
// result instead of raising a signal. Returns no bytes if the log is missing or unreadable, because
// a missing log must not end a flight.
Bytes read_from(const std::string& path, std::uint64_t offset, std::size_t bytes_max) {
  std::ifstream file(path, std::ios::binary);
  Bytes out;
  if (file.seekg(0, std::ios::end) && file.tellg() > static_cast<std::streamoff>(offset)) {
    const auto rest = static_cast<std::uint64_t>(file.tellg()) - offset;
    out.resize(std::min<std::uint64_t>(bytes_max, rest));
    file.seekg(static_cast<std::streamoff>(offset));
    file.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    out.resize(static_cast<std::size_t>(file.gcount()));
  }
  return out;
}

}  // namespace

LogTail find_tail(std::span<const std::uint8_t> last_bytes) {
  LogTail tail;
  LogScan scan(last_bytes, check_wire_data);
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
  const std::uint64_t first =
      trimmed.size_bytes - std::min<std::uint64_t>(trimmed.size_bytes, kTailBytes);
  const Bytes last_bytes = read_from(path, first, kTailBytes);
  if (first + last_bytes.size() != trimmed.size_bytes) {
    throw StartupError(path + ": its end cannot be read");
  }
  const LogTail tail = find_tail(last_bytes);
  trimmed.last = tail.last;
  trimmed.dropped_bytes = tail.last ? last_bytes.size() - tail.whole_bytes : 0;
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
  const Bytes bytes = read_from(path, offset, kTailBytes);
  const auto event = bytes.empty() ? std::nullopt : event_at(bytes, 0);
  return event ? std::optional(event->time) : std::nullopt;
}

bool ends_with(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::error_code error;
  const std::uint64_t size_bytes = std::filesystem::file_size(path, error);
  if (error) {
    return false;
  }
  const Bytes last_bytes = read_from(
      path, size_bytes - std::min<std::uint64_t>(size_bytes, kSearchedBytes), kSearchedBytes);
  return std::search(last_bytes.begin(), last_bytes.end(), bytes.begin(), bytes.end()) !=
         last_bytes.end();
}

}  // namespace vantage::logs
