#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "logs/file/log_scan.hpp"
#include "logs/file/usual_times.hpp"

namespace vantage::logs {

/// One channel of a log.
struct ChannelSurvey {
  std::string type;  ///< type of the first message; empty if not vantage's
  std::int64_t events = 0;
  std::uint64_t data_bytes = 0;
  Time first{};  ///< time of the first event, clamped to the log's begin and end
  Time last{};   ///< time of the last event, clamped to the log's begin and end
  /// Longest time between two consecutive events. Gaps of a day or more are ignored.
  Duration gap_max{};
  Time gap_at{};                    ///< start of the longest gap
  std::int64_t messages_lost = 0;   ///< missing sequence numbers of vantage messages
  std::int64_t other_types = 0;     ///< events of another type than the first
  bool has_two_publishers = false;  ///< see bus::PublisherWatch
  /// Bit b % 8 of byte b / 8 is 1 if an event of this channel begins in block b. The last byte
  /// contains the bit of the channel's last block.
  std::vector<std::uint8_t> in_block;
};

/// Section of about 256 KiB of a log that begins at the header of an event.
struct LogBlock {
  std::size_t offset = 0;
  std::int64_t first_event = 0;  ///< number of events before the block
  Time time_min{};
  Time time_max{};
};

/// Result of one pass over a log.
struct LogSurvey {
  std::uint64_t size_bytes = 0;
  ScanCounts scan;
  std::vector<DamagedStretch> stretches;  ///< the first LogScan::kStretchesKept stretches
  Time first{};                           ///< least event time
  Time last{};                            ///< greatest event time
  Time begin{};                           ///< least event time that is not outlying (UsualTimes)
  Time end{};                             ///< greatest event time that is not outlying
  std::int64_t times_outlying = 0;        ///< events before begin or after end
  /// Event numbers that are missing in the sequence (after filtering or loss).
  std::int64_t numbers_missing = 0;
  /// Number of times that the event numbers do not increase (concatenated logs).
  std::int64_t number_restarts = 0;
  std::int64_t times_backward = 0;  ///< events with a time before that of the preceding event
  Duration backward_max{};
  bool begins_with_scenario = false;
  std::map<std::string, ChannelSurvey> channels;
  std::vector<LogBlock> blocks;

  [[nodiscard]] double duration_s() const { return to_seconds(end - begin); }
  [[nodiscard]] bool is_usual(Time time) const { return time >= begin && time <= end; }
  [[nodiscard]] bool is_whole() const { return scan.stretches == 0 && scan.doubtful == 0; }
};

/// Incremental pass that surveys a log, for callers that cannot wait for the whole log.
class SurveyPass {
 public:
  /// Reads nothing yet. The bytes of `log` must outlive this object.
  explicit SurveyPass(std::span<const std::uint8_t> log);
  ~SurveyPass();
  SurveyPass(SurveyPass&&) noexcept;
  SurveyPass& operator=(SurveyPass&&) = delete;
  SurveyPass(const SurveyPass&) = delete;
  SurveyPass& operator=(const SurveyPass&) = delete;

  /// Continues until the events of `bytes` more bytes have been read. Returns false at the end of
  /// the log.
  bool advance(std::size_t bytes);
  /// Returns the current offset in the log.
  [[nodiscard]] std::size_t position() const;
  /// Returns the survey of the part that has been read. Its last block may still grow.
  [[nodiscard]] const LogSurvey& survey() const { return survey_; }
  /// Returns the complete survey and ends the pass. Precondition: advance() has returned false.
  LogSurvey take() { return std::move(survey_); }

 private:
  struct Streams;
  void add(const LocatedEvent& event);
  void add_times_and_number(const LocatedEvent& event);
  void add_to_block(const LocatedEvent& event);
  void add_to_channel(const LocatedEvent& event);
  void note_usual_times();
  void finish();

  std::size_t size_bytes_;
  LogScan scan_;
  LogSurvey survey_;
  /// Monitors of the channels with vantage messages; they count lost messages.
  std::unique_ptr<Streams> streams_;
  UsualTimes times_;
  std::int64_t events_ = 0;
  std::int64_t last_number_ = 0;
  Time last_time_{};
};

/// Surveys all of `log`. Calls `progress` about 100 times with the completed share, in [0, 1].
LogSurvey survey_log(std::span<const std::uint8_t> log,
                     const std::function<void(double)>& progress = {});

/// Returns the offset of the first event, in file order, with time ≥ `time`; log.size() if there is
/// none. `survey` must be the survey of `log`. Searches the list of blocks, then reads about one
/// block.
std::size_t seek_offset(std::span<const std::uint8_t> log, const LogSurvey& survey, Time time);

}  // namespace vantage::logs
