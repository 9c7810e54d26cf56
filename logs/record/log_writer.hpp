#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/time.hpp"

namespace vantage::logs {

/// Writes an LCM event log whose event times are the stack's own, so that a trial in virtual time
/// plays back at its true speed (LCM's file:// publisher would stamp the wall clock).
class LogWriter {
 public:
  /// @throws StartupError when `path` cannot be written.
  explicit LogWriter(const std::string& path);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  LogWriter(LogWriter&&) = delete;
  LogWriter& operator=(LogWriter&&) = delete;

  /// False when the event could not be written (disk full); counted.
  bool write(Time time, std::string_view channel, std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::int64_t events() const { return events_; }
  [[nodiscard]] std::int64_t events_lost() const { return events_lost_; }

 private:
  struct File;
  std::unique_ptr<File> file_;
  std::int64_t events_ = 0;
  std::int64_t events_lost_ = 0;
};

}  // namespace vantage::logs
