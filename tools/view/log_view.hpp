#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "logs/file/seekable_log.hpp"
#include "logs/types/type_library.hpp"
#include "tools/view/broker.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/lead_up.hpp"
#include "tools/view/playback.hpp"

namespace vantage::tools {

/// Of longer logs the numbers are not read at the start.
inline constexpr std::size_t kWholeBytesMax = std::size_t{256} << 20U;

/// The History of a whole log, as its text(). "[]" for a log above 256 MiB, which would take too
/// long, and one whose first pass is not over. `audience` is asked whether it wants each topic
/// there is, so that it knows all of them, and is told nothing else but the names of types. Ends
/// early once `stop` says so.
std::string log_history(
    const logs::SeekableLog& log, const logs::TypeLibrary& types, logs::foxglove::Sink& audience,
    const std::function<bool()>& stop = [] { return false; });

/// One number of a topic over a whole log: a JSON list of [utime, value]. `pointer` (RFC 6901) says
/// which of the content's members: a number, or true (1) and false (0); records without it are left
/// out. "[]" for a log above 256 MiB. Reads the log once; on topics /lcm/ that channel alone.
std::string log_series(const logs::SeekableLog& log, const logs::TypeLibrary& types,
                       const std::string& topic, const std::string& pointer);

/// The first instant of which a picture shows a trial: every robot of the scenario has been placed
/// and has published a plan, and somebody knows a target or a map. Where that never comes within
/// the first two minutes and 16 MiB, the first instant that has most of it; the start of a log
/// without a scenario. Ends early once `stop` says so.
Time first_picture(
    const logs::SeekableLog& log, const std::function<bool()>& stop = [] { return false; });

/// Goes on with a log's first pass until it is over, or `stop` says so; viewers are told how far it
/// is ("12 % read") until it ends. To be called once, from a thread of its own.
void read_first_pass(logs::SeekableLog& log, Broker& broker, const std::function<bool()>& stop);

/// Plays a log to a broker, as its viewers command, while the log's first pass may go on in another
/// thread: once that is over, what is shown is made again, from all that is known now. One thread.
class LogView {
 public:
  /// Paused at `begin`. All of them must live as long.
  LogView(const logs::SeekableLog& log, const logs::TypeLibrary& types, Broker& broker, Time begin);

  /// Begins to play at its own speed.
  void play(std::int64_t now_ns) { playback_.control({true, 1.0F, std::nullopt, ""}, now_ns); }

  /// Obeys what viewers asked, and sends what the time since the last call brought. A short way on
  /// is no jump: what lies between is sent, and viewers are not told to begin anew.
  void tick(std::int64_t now_ns);

 private:
  /// Begins anew at `position`, with what led up to it.
  void go_to(Time position);
  /// Sends what is between where it is and `position`.
  void go_on_to(Time position);
  /// Hears from now on as if nothing had been heard before.
  void listen_anew();
  void feed(const logs::PlacedEvent& event);
  void on_surveyed(std::int64_t now_ns);

  const logs::SeekableLog& log_;
  const logs::TypeLibrary& types_;
  Broker& broker_;
  LeadUp lead_up_;
  PlaybackClock playback_;
  bus::VirtualClock clock_;
  std::unique_ptr<bus::InProcessHub> hub_;
  std::unique_ptr<bus::Transport> source_;
  std::unique_ptr<bus::Transport> endpoint_;
  std::unique_ptr<Feed> feed_;
  Time shown_{};           ///< until when all have been sent
  bool is_exact_ = false;  ///< all of the log was known when it went there
  std::int64_t time_told_ns_ = 0;
  PlaybackStatus status_told_ = PlaybackStatus::kPaused;
};

}  // namespace vantage::tools
