#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "logs/file/log_scan.hpp"
#include "logs/file/log_survey.hpp"
#include "logs/file/mapped_file.hpp"

namespace vantage::logs {

/// Events of a log by ascending time, whatever their order in the file, with random access. A log
/// of any length can be used immediately: with its index, or without one while the first pass is
/// still running. Results are exact in the part that the pass has read. Beyond that part, an
/// instant is found by bisection of the file, which assumes ascending times; the newest message of
/// a channel with rare messages may then be missing.
///
/// Only the requested parts of the file are read. Memory: 32 bytes for each block of 256 KiB, one
/// bit for each block and channel, and the headers of the most recently read blocks. Returned
/// events are valid during the lifetime of this object. Thread-safe except for advance() and
/// survey().
class SeekableLog {
 public:
  /// Reads the index of `path`; if there is none, reads the log's first 8 MiB and its end.
  /// @throws StartupError if the log cannot be read or contains no event (this requires reading it
  /// all).
  explicit SeekableLog(const std::string& path);

  [[nodiscard]] const std::string& path() const { return file_.path(); }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return file_.bytes(); }

  /// Continues the first pass by `bytes` bytes. Returns false once the whole log has been read; the
  /// index is then stored next to the log if possible.
  bool advance(std::size_t bytes);
  /// Returns the survey of the part that has been read. Must not be called while another thread is
  /// in advance().
  [[nodiscard]] const LogSurvey& survey() const { return pass_ ? pass_->survey() : survey_; }
  [[nodiscard]] bool is_surveyed() const;
  /// Returns the share of the log that the first pass has read, in [0, 1].
  [[nodiscard]] double surveyed_share() const;
  /// Returns the number of bytes that the first pass and the queries have read since the opening.
  [[nodiscard]] std::size_t bytes_read() const;
  /// Returns the least and the greatest event time without outliers (UsualTimes). Until
  /// is_surveyed() both times are from the events read so far and from the events at the end of the
  /// file.
  [[nodiscard]] std::pair<Time, Time> range() const;

  /// Returns the events with from ≤ time < to, by ascending time; equal times keep their file
  /// order.
  [[nodiscard]] std::vector<LocatedEvent> events(Time from, Time to) const;
  /// Returns the newest event before `time` of each channel, in the order of events().
  [[nodiscard]] std::vector<LocatedEvent> newest_before(Time time) const;
  /// Returns the least event time ≥ `from`; nullopt if there is none.
  [[nodiscard]] std::optional<Time> next_time(Time from) const;

 private:
  using Events = std::vector<LocatedEvent>;

  void publish(bool is_all);
  void read_end();
  /// Returns the events of block `index` by ascending time. The reference is valid until the next
  /// call.
  const Events& read_block(std::size_t index) const;
  [[nodiscard]] std::size_t block_end(std::size_t index) const;
  /// Calls `take` with the events from `offset` on, in file order, until `take` returns false.
  template <class Take>
  void scan_from(std::size_t offset, Take take) const;
  /// Returns the first event at or after `offset` that is followed by another event or the end of
  /// the file; nullopt if there is none within 8 MiB.
  [[nodiscard]] std::optional<LocatedEvent> sound_event(std::size_t offset) const;
  /// Returns an offset in the unread part from which to search for the first event with time ≥
  /// `time`.
  [[nodiscard]] std::size_t offset_of(Time time) const;
  void add_newest_from_blocks(Time time, std::map<std::string_view, LocatedEvent>& newest) const;

  MappedFile file_;
  std::optional<SurveyPass> pass_;  ///< empty once the whole log has been read
  LogSurvey survey_;

  mutable std::mutex mutex_;  ///< protects the members below
  bool is_surveyed_ = false;
  std::size_t surveyed_bytes_ = 0;  ///< all events that begin before this offset are in blocks_
  std::vector<LogBlock> blocks_;
  /// for each channel, one bit per block: 1 if the block contains an event of the channel
  std::map<std::string, std::vector<std::uint8_t>, std::less<>> in_block_;
  Time first_{};
  Time last_{};
  std::size_t pass_bytes_ = 0;           ///< bytes read by the first pass
  mutable std::size_t query_bytes_ = 0;  ///< bytes read by queries
  /// Cached blocks, most recently used first.
  mutable std::list<std::pair<std::size_t, Events>> read_;
};

}  // namespace vantage::logs
