#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace vantage::tools {

/// One event of an LCM log.
struct LogEvent {
  Time time{};  ///< when it was logged
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

/// Where every event of an LCM log stands, so that any instant can be gone to. 16 bytes of memory
/// an event; the events themselves stay in the file. A damaged stretch is skipped to the next
/// event, a torn end is left out; both are counted.
class LogIndex {
 public:
  /// Reads the whole file's headers once.
  /// @throws StartupError when it cannot be read or holds no event.
  explicit LogIndex(const std::string& path);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] Time time(std::size_t index) const { return from_utime(entries_[index].utime); }
  [[nodiscard]] Time start() const { return time(0); }
  [[nodiscard]] Time end() const { return time(size() - 1); }
  /// Index of the first event at or after `time`; size() when there is none.
  [[nodiscard]] std::size_t first_at(Time time) const;
  /// For each channel its newest event before event `index`, by ascending index.
  [[nodiscard]] std::vector<std::size_t> newest_before(std::size_t index) const;
  /// Bytes skipped or left out.
  [[nodiscard]] std::int64_t bytes_damaged() const { return bytes_damaged_; }
  [[nodiscard]] std::int64_t file_bytes() const { return file_bytes_; }

  /// Event `index`, by ascending time; empty when the file has changed since.
  LogEvent read(std::size_t index);

 private:
  struct Entry {
    std::int64_t utime;
    std::int64_t offset;
  };
  struct Header;

  bool read_header(std::int64_t offset, Header& header);
  /// Offset of the next sync word at or after `offset`; the file's end when there is none.
  std::int64_t find_sync(std::int64_t offset);

  std::ifstream file_;
  std::int64_t file_bytes_ = 0;
  std::vector<Entry> entries_;
  std::map<std::string, std::vector<std::size_t>> by_channel_;
  std::int64_t bytes_damaged_ = 0;
};

}  // namespace vantage::tools
