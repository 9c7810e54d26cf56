#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "logs/edit/edit.hpp"
#include "logs/file/log_index.hpp"
#include "logs/play/play_schedule.hpp"

namespace vantage::logs {

/// What the one who watches wants of a Player.
struct PlayCommand {
  enum class Kind { kPause, kResume, kToggle, kSeek, kStep, kSpeed, kFaster, kSlower, kQuit };
  Kind kind = Kind::kToggle;
  double value =
      0.0;  ///< kSeek: [s] since the log's begin (LogSurvey); kStep: [s] on or back; kSpeed
};

/// A line: "pause", "resume", "seek 12.5", "step -5", "speed 2", "quit"; or a key: space, q, + and
/// −, f and b (5 s on and back), and the arrows as terminals send them. nullopt for anything else.
std::optional<PlayCommand> parse_play_command(const std::string& text);

/// The machine's steady clock, so that a test can stand in for it.
struct PlayTimer {
  std::function<std::int64_t()> now_ns;
  std::function<void(std::int64_t)> sleep_until_ns;  ///< may return early
};
/// CLOCK_MONOTONIC; the thread's timer slack is set as low as the kernel allows.
PlayTimer monotonic_timer();

struct PlayOptions {
  EditRules rules;  ///< what to play, under which names
  double speed = 1.0;
  bool loops = false;
  bool starts_paused = false;
  /// Time stamps that lie farther apart, on or back, are broken or a pause that nobody waits out.
  Duration gap_max = std::chrono::seconds(60);
};

struct PlayReport {
  std::int64_t published = 0;
  std::int64_t failed = 0;  ///< the sink did not take
  int passes = 0;           ///< ends reached
  /// How late events went out (after the instant that they were due), over all of them.
  double late_mean_us = 0.0;
  double late_worst_us = 0.0;
  std::int64_t late_over_1_ms = 0;
  std::int64_t gaps = 0;  ///< that were not waited out
};

/// Plays a log into `sink` at its own pace.
class Player {
 public:
  /// `command` is asked at least every 20 ms; `on_position` is told about as often where it is.
  /// Where the time stamps jump by more than gap_max, kAfterGap later it goes on behind the jump;
  /// `on_gap` is told from where to where.
  Player(const IndexedLog& log, PlayOptions options, PlayTimer timer, EventSink sink);

  PlayReport run(const std::function<std::optional<PlayCommand>()>& command,
                 const std::function<bool()>& stop,
                 const std::function<void(const PlaySchedule&, Time)>& on_position = {},
                 const std::function<void(Time from, Time to)>& on_gap = {});
  static constexpr Duration kAfterGap = std::chrono::milliseconds(500);

 private:
  /// True when the scan must begin anew where the schedule now stands.
  bool obey(const PlayCommand& command);
  void seek(Time position);
  void publish(const LogEvent& event);

  const IndexedLog& log_;
  PlayOptions options_;
  PlayTimer timer_;
  EventSink sink_;
  Time begin_;
  Time end_;  ///< behind the last event that is played; seeks go no further
  PlaySchedule schedule_;
  LogScan scan_;
  std::optional<PlacedEvent> next_;
  bool is_over_ = false;
  PlayReport report_;
};

}  // namespace vantage::logs
