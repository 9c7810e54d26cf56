#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/time.hpp"

namespace vantage::logs {

/// End of the last complete event in the last bytes of a log, and the time at which it was logged.
struct LogTail {
  std::size_t whole_bytes = 0;  ///< bytes up to the end of the event; 0: no complete event
  std::optional<Time> last;
};

LogTail find_tail(std::span<const std::uint8_t> last_bytes);

struct TrimmedLog {
  std::uint64_t size_bytes = 0;     ///< size of the file after trimming
  std::uint64_t dropped_bytes = 0;  ///< size of the removed incomplete event
  std::optional<Time> last;         ///< logging time of the last event
};

/// Removes an event that a killed logger left incomplete at the end, so that more can be appended.
/// A file without a complete event in its last 8 MiB, or an empty file, is not changed.
/// Precondition: no process writes to the file. @throws StartupError if the file cannot be read or
/// cut.
TrimmedLog trim_log(const std::string& path);

/// Returns the logging time of the event at `offset`; nullopt if it is incomplete or unreadable.
std::optional<Time> event_time_at(const std::string& path, std::uint64_t offset);

/// True if the last MiB of the file contains `bytes`; false if the file cannot be read.
bool ends_with(const std::string& path, std::span<const std::uint8_t> bytes);

}  // namespace vantage::logs
