#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/time.hpp"
#include "logs/record/append_file.hpp"

namespace vantage::logs {

struct SpoolOptions {
  std::string path;
  Existing existing = Existing::kRefuse;  ///< kAppend goes on with the last of `path`'s files
  std::uint64_t rotate_bytes = 0;         ///< no file gets longer; 0: there is one file
  std::uint64_t limit_bytes = 0;  ///< of all files together, those that are there included; 0: none
  std::size_t queue_bytes_max = std::size_t{64} << 20U;
  std::chrono::milliseconds write_period{10};  ///< from one write to the next
  std::chrono::milliseconds sync_period{40};   ///< from the end of a sync to the next
  std::chrono::milliseconds retry_period{200};
};

/// What became of what was handed to a LogSpool; since it was made.
struct SpoolReport {
  std::string path;  ///< the file that is written now
  int files = 1;
  std::int64_t events = 0;  ///< in files
  std::uint64_t bytes = 0;
  std::int64_t events_lost =
      0;  ///< for want of room in the queue, or below the limit, or on the disk
  std::int64_t write_errors = 0;
  std::int64_t sync_errors = 0;
  std::int64_t syncs_late = 0;        ///< that left something at risk for more than kAtRiskMax
  std::int64_t at_risk_worst_us = 0;  ///< from being handed over to being safe from a power cut
  std::uint64_t queue_bytes = 0;      ///< not in a file yet
  std::optional<std::uint64_t> free_bytes;  ///< on the disk
  bool is_written = true;
  bool is_full = false;             ///< the limit is reached
  std::uint64_t trimmed_bytes = 0;  ///< of an unfinished event, cut off before more was appended

  /// Nothing was lost, and the disk never refused.
  [[nodiscard]] bool is_good() const {
    return events_lost == 0 && write_errors == 0 && sync_errors == 0;
  }
};

/// Records events as they come, without ever making who hands them over wait for the disk.
///
/// One thread writes what has come, every write_period; that outlives this process, whatever kills
/// it. Another has it synced, so that it outlives a power cut. While the disk refuses (full, gone,
/// read-only) writing is tried again, and the files stay whole; what finds no room in the queue
/// meanwhile is lost and counted, the newest first, so that a log has one hole and not many.
///
/// A file after the first, `path` numbered from 2 on, begins with the newest SCENARIO from before
/// it. No file is deleted or written over: a number whose file is there is passed over. A log that
/// is gone on with loses the event that a killed logger has left unfinished at its end.
class LogSpool {
 public:
  /// Longest time that something may be lost by a power cut.
  static constexpr std::chrono::milliseconds kAtRiskMax{100};

  /// @throws StartupError when the first file cannot be opened.
  explicit LogSpool(SpoolOptions options, OpenFile open = open_append_file);
  /// Closes.
  ~LogSpool();
  LogSpool(const LogSpool&) = delete;
  LogSpool& operator=(const LogSpool&) = delete;
  LogSpool(LogSpool&&) = delete;
  LogSpool& operator=(LogSpool&&) = delete;

  /// Queues an event; false when it is lost. Precondition: is_event_channel(channel).
  bool write(Time time, std::string_view channel, std::span<const std::uint8_t> data);
  /// Sentences about what went wrong, or well again, since the last asking.
  std::vector<std::string> take_news();
  [[nodiscard]] SpoolReport report() const;
  /// Writes and syncs what is queued; waits for the disk. What that refuses now is lost, and the
  /// file ends with its last whole event.
  void close();

 private:
  using Lock = std::unique_lock<std::mutex>;
  void write_loop();
  void sync_loop();
  // The writer's.
  void put(std::span<std::uint8_t> events);
  void put_run(std::span<const std::uint8_t> events);
  bool open_next(Time time);
  bool wait_to_retry(const Error& error);
  void lose(std::int64_t events);
  void note_written(std::span<const std::uint8_t> events);
  [[nodiscard]] std::string path_of(int number) const;

  const SpoolOptions options_;
  const OpenFile open_;

  mutable std::mutex mutex_;
  std::condition_variable wake_writer_;
  std::condition_variable wake_syncer_;
  std::vector<std::uint8_t> queued_;  ///< whole events
  std::int64_t queued_since_ns_ = 0;  ///< the oldest of them
  std::size_t taken_bytes_ = 0;       ///< by the writer, being written
  std::int64_t taken_since_ns_ = 0;   ///< the oldest of them
  std::vector<std::shared_ptr<AppendFile>> unsynced_;
  std::int64_t unsynced_since_ns_ = 0;  ///< the oldest event in them that is not
  std::int64_t syncing_since_ns_ = 0;   ///< the oldest that is being synced
  std::vector<std::string> news_;
  SpoolReport report_;
  bool is_overflowing_ = false;
  bool is_closing_ = false;
  bool is_written_out_ = false;  ///< the writer has ended

  // The writer's own.
  std::shared_ptr<AppendFile> file_;
  std::uint64_t bytes_before_ = 0;      ///< in all files, when it began
  std::int64_t next_number_ = 0;        ///< of an event, in this file
  std::vector<std::uint8_t> scenario_;  ///< the newest, as an event
  int path_number_ = 1;

  std::thread writer_;
  std::thread syncer_;
};

}  // namespace vantage::logs
