#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bus/channels.hpp"
#include "bus/convert.hpp"
#include "bus/stream_monitor.hpp"
#include "bus/transport.hpp"

namespace vantage::bus {

/// A random, non-zero identity for one start of one process.
std::int64_t random_run_id();

/// Typed, counted publishing and subscribing over one Transport.
///
/// Handlers run inside handle(), on the thread that called it. Every message carries the run id of
/// its publisher and a sequence number per channel from 0, both set here; receivers count gaps,
/// duplicates, reordering and old runs, and never see a duplicate, an overtaken message or one of
/// a run that has been replaced. Not thread-safe: one Bus, one thread.
class Bus {
 public:
  /// @param publish_prefix  put before the name of every channel published on (for a replay
  ///                        beside the original); names subscribed to are not changed
  Bus(Transport& transport, std::int64_t run_id, std::string publish_prefix = "");

  /// Stamps `message` with this run's id and the channel's next sequence number, and sends it.
  /// The content's time is the caller's. Returns the name under which others may refer to it.
  template <class Message>
  models::InputRef publish(const Channel<Message>& channel, Message message);

  /// Calls `handler` with every good message on `channel`, for the life of the Bus. Messages that
  /// do not decode or cannot be true are counted and dropped.
  template <class Message>
  void subscribe(const Channel<Message>& channel, std::function<void(const Message&)> handler);

  /// As above with the full channel name first, for prefixes.
  template <class Message>
  void subscribe_named(const Channel<Message>& channel,
                       std::function<void(const std::string& name, const Message&)> handler);

  /// Waits up to `timeout`, then dispatches what has arrived; how many messages.
  int handle(std::chrono::microseconds timeout);

  [[nodiscard]] std::int64_t run_id() const { return run_id_; }
  /// Every counter of the transport and of the streams heard, non-zero ones, by name.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  /// Messages known to be missing (gaps) over all streams heard.
  [[nodiscard]] std::int64_t messages_lost() const;

 private:
  std::int64_t next_sequence(const std::string& channel);
  void send(const std::string& channel, const std::vector<std::uint8_t>& bytes);

  Transport& transport_;
  std::int64_t run_id_;
  std::string publish_prefix_;
  std::map<std::string, std::int64_t> next_sequence_;
  std::map<std::string, StreamMonitor> streams_;
  std::map<std::string, std::int64_t> decode_errors_;  ///< by channel: wrong type or truncated
  std::map<std::string, std::int64_t> refused_;        ///< by channel: decoded, but cannot be true
};

}  // namespace vantage::bus

#include "bus/bus_impl.hpp"  // IWYU pragma: export
