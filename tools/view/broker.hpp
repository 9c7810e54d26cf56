#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "logs/foxglove/stream.hpp"
#include "tools/view/outbox.hpp"
#include "tools/view/protocol.hpp"

namespace vantage::tools {

/// Connected viewer with its queue of outgoing frames. The threads of the bus and of the connection
/// fill the queue. The viewer's writer thread empties it, so a stalled viewer does not delay other
/// viewers.
class Client {
 public:
  Client(Outbox outbox, bool speaks_sdk) : speaks_sdk_(speaks_sdk), outbox_(std::move(outbox)) {}

  void push(Frame frame);
  /// Waits for the next frame and returns it; nullopt once the client is closed.
  std::optional<Frame> wait_pop();
  void close();
  [[nodiscard]] bool is_closed() const;
  [[nodiscard]] std::int64_t dropped() const;

 private:
  friend class Broker;
  const bool speaks_sdk_;
  /// Subscription ids by channel id; guarded by the Broker.
  std::map<std::uint32_t, std::vector<std::uint32_t>> subscriptions_;
  /// last reported number of dropped frames; guarded by the Broker
  std::int64_t drops_reported_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Outbox outbox_;
  bool is_closed_ = false;
};

/// Channels, viewers and their subscriptions. Thread-safe: the bus's thread writes records, and the
/// threads of the connections pass requests.
class Broker : public logs::foxglove::Sink {
 public:
  /// With info.range (a log) the broker stores the newest record of every topic except events,
  /// because a paused log sends no new records. Raw messages are stored only while a viewer
  /// subscribes to them. Without info.range (live) only states are stored. Records that are not
  /// stored are made only for subscribers.
  explicit Broker(ServerInfo info);

  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) override;
  void write(const std::string& topic, Time time, const logs::foxglove::Json& content) override;
  void name_type(const std::string& topic, const std::string& type) override;

  /// Stores records without sending them until release(). Used for records before a seek position.
  void hold();
  /// Sends the newest stored record of each topic to its subscribers and ends hold().
  void release();
  /// Discards the stored records before a jump in the log. The channels stay.
  void forget();

  /// Notes that all records of the log up to `time` have been counted.
  void reached(Time time);
  /// Sends the time in the log to all viewers; a newer time replaces an unsent time. New viewers
  /// receive the last time and playback state.
  void broadcast_time(Time time);
  void broadcast_playback(const PlaybackState& state);

  /// Shows a status message to all present and later viewers. The message replaces an earlier
  /// message with the same `id`; an empty message removes it.
  void set_status(const std::string& id, const std::string& message);
  /// Changes the range of the log. Viewers receive a new session with this range.
  void set_range(Time start, Time end);

  /// Adds a viewer and sends it the server info, channels and status messages. A viewer that does
  /// not support the newer subprotocol gets no playback states, because it cannot interpret them.
  std::shared_ptr<Client> connect(bool speaks_sdk);
  void disconnect(const std::shared_ptr<Client>& client);
  void on_request(Client& client, const Request& request);
  /// Returns the playback requests of viewers since the last call, oldest first.
  std::vector<PlaybackControl> take_controls();

  /// Returns JSON {topics, jumps, time_s}.
  /// - topics: list of {topic, schema, count, type}; count is the number of records since the
  ///   start, including records not made because no viewer subscribes; type is absent if the
  ///   schema implies it.
  /// - jumps: number of jumps in the log. Rates follow from two answers with equal numbers of
  /// jumps.
  /// - time_s: instant of the log up to which records have been counted, s since the Unix epoch;
  ///   null during a jump, and without a log.
  [[nodiscard]] std::string topics_text() const;
  [[nodiscard]] std::size_t clients() const;
  /// Returns the number of records dropped for slow viewers since the start.
  [[nodiscard]] std::int64_t dropped() const;
  /// Returns the number of received frames that violate the protocol.
  [[nodiscard]] std::int64_t malformed() const;

 private:
  struct Topic {
    ChannelInfo channel;
    std::string type;  ///< message type on the topic; empty: implied by the schema
    bool is_state = false;
    int subscribers = 0;
    std::int64_t count = 0;  ///< number of records, including records that were not made
    Time time{};             ///< time of the newest record
    std::shared_ptr<const std::string> newest;  ///< newest record; null if not stored
  };

  void send_channels(Client& client) const;
  void send(Client& client, std::uint32_t subscription_id, const Topic& topic);
  void report_drops(Client& client);
  [[nodiscard]] bool is_kept(const Topic& topic) const;
  void subscribe(Client& client, std::uint32_t subscription_id, std::uint32_t channel_id);
  void unsubscribe(Client& client, std::uint32_t subscription_id);

  mutable std::mutex mutex_;  ///< guards all members below
  ServerInfo info_;
  std::map<std::string, Topic> topics_;
  std::vector<std::string> topic_of_;  ///< topic by channel id − 1
  std::vector<std::shared_ptr<Client>> clients_;
  std::vector<PlaybackControl> controls_;
  std::optional<PlaybackState> playback_;        ///< playback state that was sent last
  std::map<std::string, std::string> statuses_;  ///< current status messages, by id
  bool is_holding_ = false;
  std::optional<Time> time_;  ///< time of the last reached() since the last jump
  std::int64_t jumps_ = 0;
  std::int64_t dropped_by_disconnected_ = 0;
  std::int64_t malformed_ = 0;
};

}  // namespace vantage::tools
