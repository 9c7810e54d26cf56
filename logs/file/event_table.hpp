#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "logs/file/log_event.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

/// The events of a log by ascending time, whatever their order in the file, for who goes to and fro
/// in it. 16 bytes of memory an event, and 8 for its channel; the events stay in the file.
class EventTable {
 public:
  /// One pass over the headers of `log`, which must live as long.
  /// @throws StartupError when there is no event in it.
  explicit EventTable(const IndexedLog& log);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] Time time(std::size_t index) const { return entries_[index].time; }
  [[nodiscard]] Time start() const { return entries_.front().time; }
  [[nodiscard]] Time end() const { return entries_.back().time; }
  [[nodiscard]] std::size_t file_bytes() const { return log_.bytes().size(); }
  /// Index of the first event at or after `time`; size() when there is none.
  [[nodiscard]] std::size_t first_at(Time time) const;
  /// For each channel its newest event before event `index`, by ascending index.
  [[nodiscard]] std::vector<std::size_t> newest_before(std::size_t index) const;
  /// Event `index`. Empty when the file's bytes have changed since.
  [[nodiscard]] LogEvent read(std::size_t index) const;

 private:
  struct Entry {
    Time time{};
    std::size_t offset = 0;
  };

  const IndexedLog& log_;
  std::vector<Entry> entries_;
  std::map<std::string, std::vector<std::size_t>, std::less<>> by_channel_;
};

}  // namespace vantage::logs
