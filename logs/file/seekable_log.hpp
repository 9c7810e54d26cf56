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

/// The events of a log by ascending time, whatever their order in the file, for who goes to and fro
/// in it. It can be used at once, however long the log is: with its index, or else while the first
/// pass over it goes on. What that pass has come by is exact. Beyond it an instant is searched for
/// by halving the file, which takes for granted that times ascend there, and of channels that are
/// seldom heard the newest message may be missing.
///
/// Only what is asked for is read of the file; memory is 32 bytes for each 256 KiB of it, a bit for
/// each of these and channel, and the headers of the blocks that were looked at last. Events that
/// are handed out live as long as this object. Thread-safe but for go_on() and survey().
class SeekableLog {
 public:
  /// Reads the index beside `path`, or where there is none the log's first 8 MiB and its end.
  /// @throws StartupError when it cannot be read, or no event is in it (that is known at its end).
  explicit SeekableLog(const std::string& path);

  [[nodiscard]] const std::string& path() const { return file_.path(); }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return file_.bytes(); }

  /// Goes on with the first pass by so many bytes; false once all is read and the index is kept
  /// beside the log, where that is possible.
  bool go_on(std::size_t bytes);
  /// Of what was read; not while another thread is in go_on().
  [[nodiscard]] const LogSurvey& survey() const { return pass_ ? pass_->survey() : survey_; }
  [[nodiscard]] bool is_surveyed() const;
  /// How much of the log the first pass has come by, in [0, 1].
  [[nodiscard]] double surveyed_share() const;
  /// How much of the log was looked through since it was opened: by the first pass, and for what
  /// was asked.
  [[nodiscard]] std::size_t bytes_read() const;
  /// Returns the least and the greatest time of an event, outlying ones left out (UsualTimes);
  /// until is_surveyed() as the events that were read and those at the end of the file say.
  [[nodiscard]] std::pair<Time, Time> range() const;

  /// The events with from ≤ time < to, by ascending time, of one time as they lie in the file.
  [[nodiscard]] std::vector<PlacedEvent> events(Time from, Time to) const;
  /// For each channel its newest event before `time`, in the order of events().
  [[nodiscard]] std::vector<PlacedEvent> newest_before(Time time) const;
  /// The least time of an event that is not before `from`.
  [[nodiscard]] std::optional<Time> next_time(Time from) const;

 private:
  using Events = std::vector<PlacedEvent>;

  void publish(bool is_all);
  void read_end();
  /// Of block `index`, by time. Good until the next call.
  const Events& read_block(std::size_t index) const;
  [[nodiscard]] std::size_t block_end(std::size_t index) const;
  /// Calls `take` with the events from `offset` on, in file order, until it says false.
  template <class Take>
  void scan_from(std::size_t offset, Take take) const;
  /// The first event at or after `offset` that another one, or the end, follows; none within 8 MiB.
  [[nodiscard]] std::optional<PlacedEvent> sound_event(std::size_t offset) const;
  /// Of what was not surveyed: where to read from for the first event that is not before `time`.
  [[nodiscard]] std::size_t offset_of(Time time) const;
  void add_newest_of_blocks(Time time, std::map<std::string_view, PlacedEvent>& newest) const;

  MappedFile file_;
  std::optional<SurveyPass> pass_;  ///< none once all is read
  LogSurvey survey_;

  mutable std::mutex mutex_;  ///< of the rest
  bool is_surveyed_ = false;
  std::size_t surveyed_bytes_ = 0;  ///< all events that begin before are in blocks_
  std::vector<LogBlock> blocks_;
  std::map<std::string, std::vector<std::uint8_t>, std::less<>> in_block_;  ///< by channel
  Time first_{};
  Time last_{};
  std::size_t pass_bytes_ = 0;                              ///< read by the first pass
  mutable std::size_t asked_bytes_ = 0;                     ///< read for what was asked
  mutable std::list<std::pair<std::size_t, Events>> read_;  ///< blocks, the last looked at first
};

}  // namespace vantage::logs
