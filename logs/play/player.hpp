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

/// One command of the user to a Player.
struct PlayCommand {
  enum class Kind { kPause, kResume, kToggle, kSeek, kStep, kSpeed, kFaster, kSlower, kQuit };
  Kind kind = Kind::kToggle;
  /// kSeek: s since LogSurvey::begin; kStep: s forward (> 0) or back (< 0); kSpeed: factor.
  double value = 0.0;
};

/// Parses a line: "pause", "resume", "seek 12.5", "step -5", "speed 2", "quit"; or a key: space, q,
/// + and −, f and b (5 s forward and back), and the arrow keys as terminals send them. Returns
/// nullopt for anything else.
std::optional<PlayCommand> parse_play_command(const std::string& text);

/// Steady clock, replaceable in tests.
struct PlayTimer {
  std::function<std::int64_t()> now_ns;
  std::function<void(std::int64_t)> sleep_until_ns;  ///< sleeps until this time; may return early
};
/// Returns a timer that uses CLOCK_MONOTONIC. Minimises the timer slack of the calling thread.
PlayTimer monotonic_timer();

struct PlayOptions {
  EditRules rules;  ///< selection of events and renaming of channels
  double speed = 1.0;
  bool loops = false;
  bool starts_paused = false;
  /// Larger jumps of the time stamps, forward or back, are skipped. Causes are damage and pauses.
  Duration gap_max = std::chrono::seconds(60);
};

struct PlayReport {
  std::int64_t published = 0;
  std::int64_t failed = 0;  ///< events that the sink or the renaming refused
  int passes = 0;           ///< number of times that the end was reached
  /// Delay between the due time and the publication of an event, over all events.
  double late_mean_us = 0.0;
  double late_worst_us = 0.0;
  std::int64_t late_over_1_ms = 0;
  std::int64_t gaps = 0;  ///< skipped jumps of the time stamps
};

/// Player that publishes a log to `sink` at the rate of the log's time stamps, multiplied by the
/// speed.
class Player {
 public:
  /// Polls `command` and calls `on_position` about every 20 ms. If the time stamps jump by more
  /// than gap_max, playback continues kAfterGap before the event after the jump, and `on_gap`
  /// receives both ends of the jump.
  Player(const IndexedLog& log, PlayOptions options, PlayTimer timer, EventSink sink);

  PlayReport run(const std::function<std::optional<PlayCommand>()>& command,
                 const std::function<bool()>& stop,
                 const std::function<void(const PlaySchedule&, Time)>& on_position = {},
                 const std::function<void(Time from, Time to)>& on_gap = {});
  static constexpr Duration kAfterGap = std::chrono::milliseconds(500);

 private:
  /// Executes a command. Returns true if the position in the log has changed or playback ends.
  bool execute(const PlayCommand& command);
  void seek(Time position);
  void publish(const LogEvent& event);

  const IndexedLog& log_;
  PlayOptions options_;
  PlayTimer timer_;
  EventSink sink_;
  Time begin_;
  Time end_;  ///< end of the played range, after its last event; limit of seeks
  PlaySchedule schedule_;
  LogScan scan_;
  std::optional<LocatedEvent> next_;
  bool is_over_ = false;
  PlayReport report_;
};

}  // namespace vantage::logs
