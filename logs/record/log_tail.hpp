#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/time.hpp"

namespace vantage::logs {

/// Where the last whole event among the last bytes of a log ends, and when it was logged.
struct LogTail {
  std::size_t whole_bytes = 0;  ///< counted from the first of these bytes; 0: no whole event
  std::optional<Time> last;
};

LogTail find_tail(std::span<const std::uint8_t> last_bytes);

struct TrimmedLog {
  std::uint64_t size_bytes = 0;     ///< now
  std::uint64_t dropped_bytes = 0;  ///< of an event that was cut in two
  std::optional<Time> last;         ///< when its last event was logged
};

/// Cuts off the event that a killed logger has left unfinished at the end, so that more can be
/// appended. A file without a whole event in its last 8 MiB, or none at all, is left alone.
/// Precondition: nobody writes to it. @throws StartupError when it cannot be read or cut.
TrimmedLog trim_log(const std::string& path);

/// When the event at `offset` was logged; nullopt while it is not all there, or cannot be read.
std::optional<Time> event_time_at(const std::string& path, std::uint64_t offset);

/// Whether `bytes` stand somewhere in the last mebibyte of the file; false when it cannot be read.
bool ends_with(const std::string& path, std::span<const std::uint8_t> bytes);

}  // namespace vantage::logs
