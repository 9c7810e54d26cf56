#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/time.hpp"
#include "logs/record/append_file.hpp"

namespace vantage::logs {

/// Synchronous writer of an LCM event log, for callers that may wait for the disk: trials in
/// virtual time, and copied parts of other logs. Real flights are recorded by a LogSpool.
///
/// Events are buffered up to 64 KiB. After the first error nothing more is written; the file then
/// ends with its last complete event.
class LogWriter {
 public:
  /// @throws StartupError if `path` cannot be written, or if it exists and `existing` is kRefuse.
  explicit LogWriter(const std::string& path, Existing existing = Existing::kRefuse,
                     const OpenFile& open = open_append_file);
  /// Calls close().
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  LogWriter(LogWriter&&) = delete;
  LogWriter& operator=(LogWriter&&) = delete;

  /// Returns false if the event is known to be lost; lost events are counted.
  bool write(Time time, std::string_view channel, std::span<const std::uint8_t> bytes);
  /// Writes the buffered events. Must not be called after close().
  void flush();
  /// Writes the buffered events and closes the file. Returns the error if an event is missing in
  /// the file. Nothing may be written afterwards.
  std::optional<Error> close();

  /// Returns the number of events in the file or in the buffer.
  [[nodiscard]] std::int64_t events() const { return events_; }
  [[nodiscard]] std::int64_t events_lost() const { return events_lost_; }
  /// Returns the error that ended the writing, with the file's name; nullopt if there was none.
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  std::unique_ptr<AppendFile> file_;
  std::vector<std::uint8_t> kept_;
  std::optional<Error> error_;
  std::int64_t events_ = 0;
  std::int64_t events_lost_ = 0;
};

}  // namespace vantage::logs
