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
  std::string type;  ///< of the first message; empty when it is none of the house's
  std::int64_t events = 0;
  std::uint64_t data_bytes = 0;
  Time first{};                    ///< of the first event, held within the log's begin and end
  Time last{};                     ///< likewise of the last
  Duration gap_max{};              ///< longest time between two neighbouring events, if below a day
  Time gap_at{};                   ///< when it began
  std::int64_t messages_lost = 0;  ///< sequence numbers missing, of the house's messages
  std::int64_t other_types = 0;    ///< events whose type is not `type`
  /// Bit b % 8 of byte b / 8: an event of it begins in block b. Ends with the last such block.
  std::vector<std::uint8_t> in_block;
};

/// A stretch of about 256 KiB of a log, from the header of an event on.
struct LogBlock {
  std::size_t offset = 0;
  std::int64_t first_event = 0;  ///< how many events come before it
  Time time_min{};
  Time time_max{};
};

/// Everything that one pass over a log tells.
struct LogSurvey {
  std::uint64_t size_bytes = 0;
  ScanCounts scan;
  std::vector<DamagedStretch> stretches;  ///< the first of them
  Time first{};                           ///< least event time
  Time last{};                            ///< greatest
  Time begin{};                           ///< least event time that is not outlying (UsualTimes)
  Time end{};                             ///< greatest of these
  std::int64_t times_outlying = 0;        ///< events before begin or after end
  std::int64_t numbers_missing = 0;  ///< gaps in the logger's count (as after filtering or loss)
  std::int64_t number_restarts = 0;  ///< places where it goes back (logs put together)
  std::int64_t times_backward = 0;   ///< events earlier than the one before
  Duration backward_max{};
  bool begins_with_scenario = false;
  std::map<std::string, ChannelSurvey> channels;
  std::vector<LogBlock> blocks;

  [[nodiscard]] double duration_s() const { return to_seconds(end - begin); }
  [[nodiscard]] bool is_usual(Time time) const { return time >= begin && time <= end; }
  [[nodiscard]] bool is_whole() const { return scan.stretches == 0 && scan.doubtful == 0; }
};

/// The pass over a log that surveys it, for who cannot wait for all of it.
class SurveyPass {
 public:
  /// Nothing is read yet. `log` must live as long.
  explicit SurveyPass(std::span<const std::uint8_t> log);
  ~SurveyPass();
  SurveyPass(SurveyPass&&) noexcept;
  SurveyPass& operator=(SurveyPass&&) = delete;
  SurveyPass(const SurveyPass&) = delete;
  SurveyPass& operator=(const SurveyPass&) = delete;

  /// Goes on until the events of so many more bytes have been read; false: that was the last.
  bool go_on(std::size_t bytes);
  /// Where it is in the log.
  [[nodiscard]] std::size_t position() const;
  /// Of what it has passed; its last block may grow until the end.
  [[nodiscard]] const LogSurvey& survey() const { return survey_; }
  /// The survey, once go_on() has said that that was all. Ends the pass.
  LogSurvey take() { return std::move(survey_); }

 private:
  struct Streams;
  void add(const PlacedEvent& event);
  void add_times_and_number(const PlacedEvent& event);
  void add_to_block(const PlacedEvent& event);
  void add_to_channel(const PlacedEvent& event);
  void note_usual_times();
  void finish();

  std::size_t size_bytes_;
  LogScan scan_;
  LogSurvey survey_;
  std::unique_ptr<Streams> streams_;  ///< of the house's channels, for what was lost on them
  UsualTimes times_;
  std::int64_t events_ = 0;
  std::int64_t last_number_ = 0;
  Time last_time_{};
};

/// Reads all of `log`. `progress` hears the share that is done, about a hundred times.
LogSurvey survey_log(std::span<const std::uint8_t> log,
                     const std::function<void(double)>& progress = {});

/// Where the first event, in file order, that is not earlier than `time` begins; log.size() when
/// there is none. `survey` must be of `log`. Cost: the blocks, then at most about one of them read.
std::size_t seek_offset(std::span<const std::uint8_t> log, const LogSurvey& survey, Time time);

}  // namespace vantage::logs
