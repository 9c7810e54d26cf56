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
#include "tools/view/playback.hpp"
#include "tools/view/seek_preroll.hpp"

namespace vantage::tools {

/// Size of the largest log that log_history() and log_series() read, bytes.
inline constexpr std::size_t kWholeBytesMax = std::size_t{256} << 20U;

/// Returns History::text() of a complete log. Returns "[]" for a log above 256 MiB, which would
/// take too long, and if the log's first pass is not complete. Calls only wants() and name_type()
/// of `audience`, so that the audience knows all topics. Ends early if `stop` returns true.
std::string log_history(
    const logs::SeekableLog& log, const logs::TypeLibrary& types, logs::foxglove::Sink& audience,
    const std::function<bool()>& stop = [] { return false; });

/// Returns one number of a topic over a complete log, as a JSON list of [utime, value]. `pointer`
/// (RFC 6901) selects the member of the content: a number, or true (1) and false (0). Records
/// without this member are left out. Returns "[]" for a log above 256 MiB. Reads the log once; for
/// a topic /lcm/CHANNEL decodes only that channel.
std::string log_series(const logs::SeekableLog& log, const logs::TypeLibrary& types,
                       const std::string& topic, const std::string& pointer);

/// Returns the first instant with a complete picture of a trial: every robot of the scenario has a
/// position and a plan, and a target estimate or a map exists. If no instant within the first 2 min
/// and 16 MiB meets all these conditions, returns the first instant that meets the most conditions.
/// Returns the start of a log without a scenario. Ends early if `stop` returns true.
Time first_picture(
    const logs::SeekableLog& log, const std::function<bool()>& stop = [] { return false; });

/// Continues a log's first pass until it is complete or `stop` returns true. Until then, viewers
/// see the progress ("12 % read"). Call once, in a separate thread.
void read_first_pass(logs::SeekableLog& log, Broker& broker, const std::function<bool()>& stop);

/// Player of a log that sends records to a broker and obeys the playback requests of its viewers.
/// The log's first pass may run in another thread; when that pass is complete, the current picture
/// is built again from the complete log. Single-threaded.
class LogView {
 public:
  /// Starts paused at `begin`. The arguments must outlive this object.
  LogView(const logs::SeekableLog& log, const logs::TypeLibrary& types, Broker& broker, Time begin);

  /// Begins to play in real time.
  void play(std::int64_t now_ns) { playback_.control({true, 1.0F, std::nullopt, ""}, now_ns); }

  /// Obeys the requests of viewers and sends the records since the last call. A seek forward by at
  /// most 1 s sends the records in between and does not reset the viewers.
  void tick(std::int64_t now_ns);

 private:
  /// Jumps to `position`. Plays the messages before `position` to restore the state at `position`.
  void go_to(Time position);
  /// Sends the records between the current position and `position`.
  void advance_to(Time position);
  /// Replaces the feed, which discards everything received so far.
  void reset_feed();
  void feed(const logs::LocatedEvent& event);
  void on_surveyed(std::int64_t now_ns);

  const logs::SeekableLog& log_;
  const logs::TypeLibrary& types_;
  Broker& broker_;
  SeekPreroll preroll_;
  PlaybackClock playback_;
  bus::VirtualClock clock_;
  std::unique_ptr<bus::InProcessHub> hub_;
  std::unique_ptr<bus::Transport> source_;
  std::unique_ptr<bus::Transport> endpoint_;
  std::unique_ptr<Feed> feed_;
  Time shown_{};           ///< all records up to this time have been sent
  bool is_exact_ = false;  ///< the first pass was complete at the last jump
  std::int64_t time_sent_ns_ = 0;
  PlaybackStatus status_sent_ = PlaybackStatus::kPaused;
};

}  // namespace vantage::tools
