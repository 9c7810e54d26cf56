#pragma once

#include <algorithm>
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
  Existing existing = Existing::kRefuse;  ///< kAppend continues the last file of `path`
  std::uint64_t rotate_bytes = 0;         ///< maximum size of a file; 0: one file only
  /// Maximum size of all files together, existing ones included; 0: none.
  std::uint64_t limit_bytes = 0;
  std::size_t queue_bytes_max = std::size_t{64} << 20U;
  std::chrono::milliseconds write_period{10};  ///< time between two writes
  std::chrono::milliseconds sync_period{40};   ///< time from the end of a sync to the next one
  std::chrono::milliseconds retry_period{200};
};

/// Counts and state of a LogSpool since its construction.
struct SpoolReport {
  std::string path;  ///< path of the current file
  int files = 1;
  std::int64_t events = 0;  ///< number of events written to files
  std::uint64_t bytes = 0;
  /// Events lost because the queue was full, the limit was reached or the disk refused them.
  std::int64_t events_lost = 0;
  std::int64_t write_errors = 0;
  std::int64_t sync_errors = 0;
  std::int64_t syncs_late = 0;        ///< syncs of data at risk for longer than at_risk_max()
  std::int64_t at_risk_worst_us = 0;  ///< longest time from write() until the data were synced
  std::uint64_t queue_bytes = 0;      ///< size of the events that are not yet in a file
  std::optional<std::uint64_t> free_bytes;  ///< free space of the disk
  bool is_written = true;
  bool is_full = false;             ///< limit_bytes is reached
  std::uint64_t trimmed_bytes = 0;  ///< incomplete event removed before appending

  /// True if no event was lost and the disk reported no error.
  [[nodiscard]] bool is_good() const {
    return events_lost == 0 && write_errors == 0 && sync_errors == 0;
  }
};

/// Asynchronous event recorder: callers never wait for the disk.
///
/// One thread writes the queued events every write_period; written data survive the end of this
/// process by any cause. Another thread syncs them, so that they survive a power failure. While the
/// disk refuses data (full, absent, read-only), writing is retried and the files stay valid. During
/// this time, events that do not fit into the queue are lost and counted. The newest events are
/// dropped, so that a log has one gap instead of many.
///
/// Further files are named `path` with a number from 2 on, and begin with the newest earlier
/// SCENARIO. No file is deleted or overwritten: numbers of existing files are skipped. When a log
/// is continued, an event that a killed logger left incomplete at the log's end is removed.
class LogSpool {
 public:
  /// Longest time for which data may be lost by a power failure, with the default periods.
  static constexpr std::chrono::milliseconds kAtRiskMax{100};
  /// Returns the longest time for which data may be lost with `options`: data are written, and then
  /// synced after the sync in progress.
  static constexpr std::chrono::milliseconds at_risk_max(const SpoolOptions& options) {
    return std::max(kAtRiskMax, options.write_period + 2 * options.sync_period);
  }

  /// @throws StartupError if the first file cannot be opened.
  explicit LogSpool(SpoolOptions options, OpenFile open = open_append_file);
  /// Calls close().
  ~LogSpool();
  LogSpool(const LogSpool&) = delete;
  LogSpool& operator=(const LogSpool&) = delete;
  LogSpool(LogSpool&&) = delete;
  LogSpool& operator=(LogSpool&&) = delete;

  /// Queues an event. Returns false if it is lost. Precondition: is_event_channel(channel).
  bool write(Time time, std::string_view channel, std::span<const std::uint8_t> data);
  /// Returns sentences about failures and recoveries since the last call.
  std::vector<std::string> take_notices();
  [[nodiscard]] SpoolReport report() const;
  /// Writes and syncs the queued events and waits for the disk. Events that the disk refuses now
  /// are lost, and the file ends with its last complete event.
  void close();

 private:
  using Lock = std::unique_lock<std::mutex>;
  void write_loop();
  void sync_loop();
  // Called by the writer thread only.
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
  std::vector<std::uint8_t> queued_;  ///< complete events that wait for the writer thread
  std::int64_t queued_since_ns_ = 0;  ///< time of the oldest queued event
  std::size_t taken_bytes_ = 0;       ///< bytes that the writer thread is writing
  std::int64_t taken_since_ns_ = 0;   ///< time of the oldest event being written
  std::vector<std::shared_ptr<AppendFile>> unsynced_;
  std::int64_t unsynced_since_ns_ = 0;  ///< time of the oldest event in unsynced_
  std::int64_t syncing_since_ns_ = 0;   ///< time of the oldest event being synced
  std::vector<std::string> notices_;
  SpoolReport report_;
  bool is_overflowing_ = false;
  bool is_closing_ = false;
  bool is_written_out_ = false;  ///< the writer thread has ended

  // Used by the writer thread only.
  std::shared_ptr<AppendFile> file_;
  std::uint64_t bytes_before_ = 0;      ///< bytes in all files at the start
  std::int64_t next_number_ = 0;        ///< number of the next event in this file
  std::vector<std::uint8_t> scenario_;  ///< the newest SCENARIO, as an event
  int path_number_ = 1;

  std::thread writer_;
  std::thread syncer_;
};

}  // namespace vantage::logs
