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

/// Writes an LCM event log in the caller's own time, for what can wait for a disk: trials in
/// virtual time, parts of other logs. What flies is recorded by a LogSpool.
///
/// Events are kept until 64 KiB of them are together. After the first error nothing more is
/// written; the file then ends with its last whole event.
class LogWriter {
 public:
  /// @throws StartupError when `path` cannot be written, or is there already and is to be refused.
  explicit LogWriter(const std::string& path, Existing existing = Existing::kRefuse,
                     const OpenFile& open = open_append_file);
  /// Closes.
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  LogWriter(LogWriter&&) = delete;
  LogWriter& operator=(LogWriter&&) = delete;

  /// False when the event is known not to come into the file; counted.
  bool write(Time time, std::string_view channel, std::span<const std::uint8_t> bytes);
  /// Writes what is kept. Not after close().
  void flush();
  /// Writes what is kept; why not everything is in the file, if so. Nothing may be written after.
  std::optional<Error> close();

  /// In the file, or kept for it.
  [[nodiscard]] std::int64_t events() const { return events_; }
  [[nodiscard]] std::int64_t events_lost() const { return events_lost_; }
  /// Why nothing is written any more, with the file's name; nullopt while all is.
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  std::unique_ptr<AppendFile> file_;
  std::vector<std::uint8_t> kept_;
  std::optional<Error> error_;
  std::int64_t events_ = 0;
  std::int64_t events_lost_ = 0;
};

}  // namespace vantage::logs
