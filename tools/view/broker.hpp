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

/// One viewer, as the server sees it. Filled by the bus's thread and its connection's, emptied by a
/// writer of its own, so that a stalled viewer delays nobody.
class Client {
 public:
  Client(Outbox outbox, bool speaks_sdk) : speaks_sdk_(speaks_sdk), outbox_(std::move(outbox)) {}

  void push(Frame frame);
  /// Waits for the next frame; nullopt once close() was called.
  std::optional<Frame> wait_pop();
  void close();
  [[nodiscard]] bool is_closed() const;
  [[nodiscard]] std::int64_t dropped() const;

 private:
  friend class Broker;
  const bool speaks_sdk_;
  /// Channel → the subscription ids on it; guarded by the Broker.
  std::map<std::uint32_t, std::vector<std::uint32_t>> subscriptions_;
  std::int64_t dropped_told_ = 0;  ///< guarded by the Broker

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Outbox outbox_;
  bool is_closed_ = false;
};

/// Who wants what: channels, viewers and what goes between them. Thread-safe: written by the bus's
/// thread, asked by the connections'.
class Broker : public logs::foxglove::Sink {
 public:
  /// A server of a log keeps the newest record of every topic but events and raw messages, since in
  /// a log that is paused nothing else comes; of raw messages that somebody subscribes to as well;
  /// a live one keeps states only, and makes nothing nobody asked for.
  explicit Broker(ServerInfo info);

  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) override;
  void write(const std::string& topic, Time time, const logs::foxglove::Json& content) override;
  void name_type(const std::string& topic, const std::string& type) override;

  /// From now on records are kept and not sent: for what leads up to an instant in a log.
  void hold();
  /// Sends the newest of each kept topic, and goes on as usual.
  void release();
  /// Forgets what was kept (the log is left for another instant). Channels stay.
  void forget();

  /// All records of the log up to then have been counted.
  void reached(Time time);
  /// Tells everyone what time it is in the log; only the newest counts. Newcomers are told the last
  /// time and state of playback.
  void broadcast_time(Time time);
  void broadcast_playback(const PlaybackState& state);

  /// Says something to everyone, newcomers too, in the place of what `id` said before; empty: it is
  /// said no more.
  void tell(const std::string& id, const std::string& message);
  /// The log is longer or shorter than was said: viewers begin a new session where it is.
  void set_range(Time start, Time end);

  /// A new viewer, told who we are and what there is. One that does not speak the newer subprotocol
  /// is not told of playback, which it would not understand.
  std::shared_ptr<Client> connect(bool speaks_sdk);
  void disconnect(const std::shared_ptr<Client>& client);
  void on_request(Client& client, const Request& request);
  /// What viewers asked of the player since the last call, oldest first.
  std::vector<PlaybackControl> take_controls();

  /// JSON {topics, jumps, time_s}. Topics: a list of {topic, schema, count} of all that is known:
  /// how many records there were, made or not, since the start. time_s: up to which instant of the
  /// log they have been counted, in seconds since the Unix epoch; null on the way to another
  /// instant, and where there is no log. Whoever asks twice after as many jumps knows the rates.
  [[nodiscard]] std::string topics_text() const;
  [[nodiscard]] std::size_t clients() const;
  /// Records that slow viewers did not get, since the start.
  [[nodiscard]] std::int64_t dropped() const;
  /// Frames of viewers that broke the protocol.
  [[nodiscard]] std::int64_t malformed() const;

 private:
  struct Topic {
    ChannelInfo channel;
    std::string type;  ///< of a message on it; empty: its schema says it
    bool is_state = false;
    int subscribers = 0;
    std::int64_t count = 0;                     ///< records that there were, made or not
    Time time{};                                ///< of the newest
    std::shared_ptr<const std::string> newest;  ///< when kept
  };

  void tell_channels(Client& client) const;
  void send(Client& client, std::uint32_t subscription_id, const Topic& topic);
  void tell_drops(Client& client);
  [[nodiscard]] bool is_kept(const Topic& topic) const;
  void subscribe(Client& client, std::uint32_t subscription_id, std::uint32_t channel_id);
  void unsubscribe(Client& client, std::uint32_t subscription_id);

  mutable std::mutex mutex_;  ///< of all below
  ServerInfo info_;
  std::map<std::string, Topic> topics_;
  std::vector<std::string> topic_of_;  ///< by channel id − 1
  std::vector<std::shared_ptr<Client>> clients_;
  std::vector<PlaybackControl> controls_;
  std::optional<PlaybackState> playback_;    ///< as last told
  std::map<std::string, std::string> told_;  ///< what is said still, by id
  bool is_holding_ = false;
  std::optional<Time> time_;  ///< reached since the last jump
  std::int64_t jumps_ = 0;
  std::int64_t dropped_by_the_gone_ = 0;
  std::int64_t malformed_ = 0;
};

}  // namespace vantage::tools
