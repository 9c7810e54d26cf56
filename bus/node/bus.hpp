#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/stream_monitor.hpp"
#include "bus/transport/channel_index.hpp"
#include "bus/transport/transport.hpp"

namespace vantage::bus {

namespace auth {
class Authenticator;
enum class Refusal : std::uint8_t;
}  // namespace auth
class AirBudget;

/// Returns a random, positive id for one start of a process.
std::int64_t random_run_id();

/// Publisher and subscriber of typed messages on one Transport.
///
/// handle() runs the handlers on the thread that calls it. Each message carries the run id of its
/// publisher and a sequence number per channel, which starts at 0. publish() sets both.
/// Receivers count gaps, duplicates, reordering and old runs. They drop duplicates, overtaken
/// messages and messages of a replaced run. Messages for which passes_every_filter() is true are
/// always delivered. On a shared channel, no run replaces another. Not thread-safe: use one Bus per
/// thread.
class Bus {
 public:
  /// @param publish_prefix  prepended to the name of every channel published on, so that a replay
  ///                        can run next to the original; subscribed names are unchanged
  Bus(Transport& transport, std::int64_t run_id, std::string publish_prefix = "");
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  Bus(Bus&&) = delete;
  Bus& operator=(Bus&&) = delete;

  /// Gives the Bus a clock, so that a run is only replaced after the lease of its channel has
  /// expired. `clock` must outlive the Bus. Without a clock, for example for a log, a run is
  /// replaced immediately.
  void use_clock(const Clock& clock) { clock_ = &clock; }

  /// Starts to sign published messages, and to verify signatures and times of received messages.
  /// Also calls use_clock(). An authenticator made by replay_authenticator_for() only signs.
  /// `clock` must outlive the Bus (docs/guide/security.md). nullptr: no effect.
  void secure(std::unique_ptr<auth::Authenticator> authenticator, const Clock& clock);
  /// Limits what this Bus sends to other hosts. `clock` must outlive the Bus. nullptr: no limit.
  void limit_air(std::unique_ptr<AirBudget> budget, const Clock& clock);
  /// Returns the largest payload on `channel` that the budget has room for; without a budget, no
  /// limit.
  [[nodiscard]] std::size_t air_left(const std::string& channel) const;
  /// Declares this process to be the vehicle `robot`: commands must be addressed to `robot` and
  /// echo its session. Commands that make it safer are always delivered. No effect without
  /// secure().
  void act_as_vehicle(const std::string& robot);
  /// Begins a new session; commands must echo its nonce. A vehicle calls this when it is armed.
  /// Returns false without secure(), because sessions do not exist then.
  bool renew_session();
  /// True if signed messages were received although this Bus has no authenticator.
  [[nodiscard]] bool receives_signed() const { return receives_signed_; }

  /// Sets the run id and the channel's next sequence number in `message`, and publishes it. The
  /// caller sets the time of the content. Returns the message as published.
  template <class Message>
  Message publish(const Channel<Message>& channel, Message message);

  /// Returns the reference to `published`, which this Bus published on `channel`.
  template <class Message>
  [[nodiscard]] models::InputRef ref_to(const Channel<Message>& channel,
                                        const Message& published) const {
    return models::ref_to(publish_prefix_ + channel.name, published.stamp);
  }

  /// Calls `handler` with every accepted message on `channel` while the Bus exists. Messages that
  /// do not decode or have impossible values are counted and dropped. A channel may have several
  /// handlers; each message is checked once. A Bus may be destroyed before its transport.
  template <class Message>
  void subscribe(const Channel<Message>& channel, std::function<void(const Message&)> handler);

  /// As subscribe(), but the handler also receives the full channel name, for prefix subscriptions.
  template <class Message>
  void subscribe_named(const Channel<Message>& channel,
                       std::function<void(const std::string& name, const Message&)> handler);

  /// As subscribe_named(), for handlers that store the message. All handlers share one copy.
  template <class Message>
  void subscribe_shared(
      const Channel<Message>& channel,
      std::function<void(const std::string& name, const std::shared_ptr<const Message>&)> handler);

  /// Removes every handler of exactly the channel `name`, and its stream. A later subscription
  /// begins a new stream, so messages sent in between are not counted as lost. A handler of another
  /// channel may call this function.
  void unsubscribe(const std::string& name);

  /// Waits up to `timeout`, then dispatches the messages that have arrived. Returns their number,
  /// or kSourceEnded. Exceptions of handlers are passed on to the caller.
  int handle(std::chrono::microseconds timeout);

  [[nodiscard]] std::int64_t run_id() const { return run_id_; }
  /// Returns the non-zero counters of the transport and of all received streams, by name.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  /// Returns the number of accepted messages that did not decode, over all channels.
  [[nodiscard]] std::int64_t undecoded() const { return undecoded_; }
  /// Returns the number of messages known to be missing (gaps) over all streams.
  [[nodiscard]] std::int64_t messages_lost() const;
  /// Returns the time spent in handlers since the start, for loop statistics.
  [[nodiscard]] double handling_s() const { return static_cast<double>(handling_ns_) * 1e-9; }

 private:
  /// maximum number of streams, sufficient for a thousand robots
  static constexpr std::size_t kStreamsMax = 16'384;

  /// One message while it is passed to the matching subscriptions.
  struct Delivery {
    std::string name;
    std::span<const std::uint8_t> bytes;
    std::optional<bool> is_fresh = std::nullopt;  ///< nullopt: not checked yet
    bool is_shared = false;                       ///< several publishers are expected
    Duration lease{};                             ///< lease of the channel
    Decoded* decoded = nullptr;  ///< decoded message, shared with other subscribers
    bool is_faulty = false;      ///< does not decode or has impossible values; counted
    std::uint64_t source = 0;    ///< sender's address and port; 0: unknown
    auth::Refusal echo{};        ///< result of the nonce check of a command
    bool is_echo_counted = false;
  };
  struct Subscription {
    std::string pattern;
    bool is_shared = false;
    Duration lease{};
    std::function<void(Delivery&)> deliver;
  };

  std::int64_t next_sequence(const std::string& channel);
  /// Signs the message in buffer_. `robot`: the addressee of a command. Precondition: secure() with
  /// an authenticator.
  void seal(const std::string& channel, const std::string& robot);
  /// Removes the signature from delivery.bytes; returns false when the message is refused.
  bool open(Delivery& delivery);
  /// True if the command's addressee and echoed nonce allow this process to obey the command.
  bool is_addressed_to_us(Delivery& delivery, const models::OperatorCommand& command);
  bool send(const std::string& channel, std::span<const std::uint8_t> bytes);
  void add_subscription(Subscription subscription);
  void on_message(const std::string& pattern, std::string_view name, const Payload& bytes);
  /// Returns the decoded message. If it does not decode or has impossible values, counts it and
  /// returns null.
  template <class Message>
  std::shared_ptr<const Message> message_of(Delivery& delivery);
  bool is_fresh(Delivery& delivery, const models::Stamp& stamp);
  /// Returns the counts of every received channel, by name.
  [[nodiscard]] std::map<std::string, StreamCounts> stream_counts() const;
  void count_fault(Delivery& delivery, std::map<std::string, std::int64_t>& counts);

  Transport& transport_;
  const Clock* clock_ = nullptr;
  std::unique_ptr<auth::Authenticator> authenticator_;
  const Clock* signing_clock_ = nullptr;
  std::unique_ptr<AirBudget> air_;
  const Clock* air_clock_ = nullptr;
  std::string vehicle_;
  bool receives_signed_ = false;
  std::int64_t run_id_;
  std::string publish_prefix_;
  std::deque<Subscription>
      subscriptions_;   ///< a deque, so that references stay valid when a handler subscribes
  ChannelIndex index_;  ///< indexes subscriptions_
  std::shared_ptr<Bus*> self_;  ///< lets the transport's handlers detect that the Bus was destroyed
  std::vector<std::uint8_t> buffer_;  ///< message being encoded
  std::int64_t handling_ns_ = 0;
  std::int64_t streams_refused_ = 0;  ///< messages beyond kStreamsMax channels
  ByName<std::int64_t> next_sequence_;
  ByName<StreamMonitor> streams_;
  ByName<SharedStreamMonitor> shared_streams_;
  StreamCounts unsubscribed_counts_;  ///< counts of streams that were unsubscribed
  std::int64_t undecoded_ = 0;
  std::map<std::string, std::int64_t>
      decode_errors_;  ///< number of messages of a wrong type or truncated, by channel
  std::map<std::string, std::int64_t>
      refused_;  ///< number of messages with impossible values, by channel
};

}  // namespace vantage::bus

#include "bus/node/bus_impl.hpp"  // IWYU pragma: export
