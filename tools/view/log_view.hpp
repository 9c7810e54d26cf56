#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "bus/clock.hpp"
#include "bus/transport.hpp"
#include "logs/file/event_table.hpp"
#include "tools/view/broker.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/playback.hpp"

namespace vantage::tools {

/// A log as a JSON list of [topic, utime, content], oldest first: the numbers and events of the
/// whole, for charts and marks (at most one record a second and topic of vehicles and processes).
/// "[]" for a log above 256 MiB, which would take too long. `audience` is asked whether it wants
/// each topic there is, so that it knows all of them, and is told nothing else.
std::string log_history(const logs::EventTable& log, logs::foxglove::Sink& audience);

/// Plays a log to a broker, as its viewers command. One thread.
class LogView {
 public:
  LogView(const logs::EventTable& log, Broker& broker);

  /// Begins to play at its own speed.
  void play(std::int64_t now_ns) { playback_.control({true, 1.0F, std::nullopt, ""}, now_ns); }

  /// Obeys what viewers asked, and sends what the time since the last call brought.
  void tick(std::int64_t now_ns);

 private:
  /// Begins anew at `position`, with what led up to it.
  void go_to(Time position);
  void feed(std::size_t index);

  const logs::EventTable& log_;
  Broker& broker_;
  PlaybackClock playback_;
  bus::VirtualClock clock_;
  std::unique_ptr<bus::InProcessHub> hub_;
  std::unique_ptr<bus::Transport> source_;
  std::unique_ptr<bus::Transport> endpoint_;
  std::unique_ptr<Feed> feed_;
  std::size_t next_ = 0;  ///< event not yet sent
  std::int64_t time_told_ns_ = 0;
  PlaybackStatus status_told_ = PlaybackStatus::kPaused;
};

}  // namespace vantage::tools
