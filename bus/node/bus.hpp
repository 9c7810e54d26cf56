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

/// A random, non-zero identity for one start of one process.
std::int64_t random_run_id();

/// Typed, counted publishing and subscribing over one Transport.
///
/// Handlers run inside handle(), on the thread that called it. Every message carries the run id of
/// its publisher and a sequence number per channel from 0, both set here; receivers count gaps,
/// duplicates, reordering and old runs, and never see a duplicate, an overtaken message or one of
/// a run that has been replaced (on a shared channel no run replaces another), except those that
/// pass every filter (passes_every_filter). Not thread-safe: one Bus, one thread.
class Bus {
 public:
  /// @param publish_prefix  put before the name of every channel published on (for a replay
  ///                        beside the original); names subscribed to are not changed
  Bus(Transport& transport, std::int64_t run_id, std::string publish_prefix = "");
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  Bus(Bus&&) = delete;
  Bus& operator=(Bus&&) = delete;

  /// From now on runs are judged by when they were heard, too (a channel's lease). `clock` must
  /// outlive the Bus; without one, as for what a log says, a run is replaced at once.
  void keep_time(const Clock& clock) { clock_ = &clock; }

  /// Signs what is published, and judges what is received by its signature and by `clock`, which is
  /// kept as by keep_time(); `clock` must outlive the Bus (docs/guide/security.md). One that was made by
  /// replay_authenticator_for() signs alone and judges nothing. nullptr: changes nothing.
  void secure(std::unique_ptr<auth::Authenticator> authenticator, const Clock& clock);
  /// This process is the vehicle `robot`: commands must be said to it, in its session; those that
  /// make it safer are handed on all the same. Without secure() it does nothing.
  void answer_to(const std::string& robot);
  /// Begins a new session, which commands must echo: a vehicle's, when it is armed. False without
  /// secure(): there are no sessions.
  bool renew_session();
  /// Whether somebody signs, though this Bus neither signs nor judges.
  [[nodiscard]] bool hears_signed() const { return hears_signed_; }

  /// Stamps `message` with this run's id and the channel's next sequence number, and sends it.
  /// The content's time is the caller's. Returns the name under which others may refer to it.
  template <class Message>
  models::InputRef publish(const Channel<Message>& channel, Message message);

  /// Calls `handler` with every good message on `channel`, for the life of the Bus. Messages that
  /// do not decode or cannot be true are counted and dropped. Several handlers may hear the same
  /// channel; each message is judged once. A Bus may be destroyed before its transport.
  template <class Message>
  void subscribe(const Channel<Message>& channel, std::function<void(const Message&)> handler);

  /// As above with the full channel name first, for prefixes.
  template <class Message>
  void subscribe_named(const Channel<Message>& channel,
                       std::function<void(const std::string& name, const Message&)> handler);

  /// As above, for those who keep the message: many may keep the same.
  template <class Message>
  void subscribe_shared(
      const Channel<Message>& channel,
      std::function<void(const std::string& name, const std::shared_ptr<const Message>&)> handler);

  /// Forgets every handler of that very channel name, and the stream: heard again, it begins anew,
  /// and what was said in between is not lost. A handler of another channel may call it.
  void unsubscribe(const std::string& name);

  /// Waits up to `timeout`, then dispatches what has arrived; how many messages, or
  /// kSourceEnded. What a handler throws comes out here.
  int handle(std::chrono::microseconds timeout);

  [[nodiscard]] std::int64_t run_id() const { return run_id_; }
  /// Every counter of the transport and of the streams heard, non-zero ones, by name.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;
  /// Messages of believed senders that were of no type of ours, over all channels heard.
  [[nodiscard]] std::int64_t undecoded() const { return undecoded_; }
  /// Messages known to be missing (gaps) over all streams heard.
  [[nodiscard]] std::int64_t messages_lost() const;
  /// Time spent in handlers since the start, for loop statistics.
  [[nodiscard]] double handling_s() const { return static_cast<double>(handling_ns_) * 1e-9; }

 private:
  static constexpr std::size_t kStreamsMax = 16'384;  ///< of a thousand robots

  /// One message on its way through the subscriptions that hear it.
  struct Delivery {
    std::string name;
    std::span<const std::uint8_t> bytes;
    std::optional<bool> is_fresh = std::nullopt;  ///< once judged
    bool is_shared = false;                       ///< several publishers are expected
    Duration lease{};                             ///< of the channel
    Decoded* decoded = nullptr;                   ///< what the bytes are, shared with others
    bool is_faulty = false;                       ///< does not decode or cannot be true: counted
    std::uint64_t source = 0;                     ///< who sent it, as far as can be seen
    auth::Refusal echo{};                         ///< of a command, held against our nonce
    bool is_echo_counted = false;
  };
  struct Subscription {
    std::string pattern;
    bool is_shared = false;
    Duration lease{};
    std::function<void(Delivery&)> deliver;
  };

  std::int64_t next_sequence(const std::string& channel);
  /// Signs what stands in buffer_, if that is asked for. `robot`: to whom a command is said.
  void seal(const std::string& channel, const std::string& robot);
  /// Takes the signature off delivery.bytes; false when the message is not believed.
  bool open(Delivery& delivery);
  /// Whether a command is said to this process, as far as it asks.
  bool is_said_to_us(Delivery& delivery, const models::OperatorCommand& command);
  bool send(const std::string& channel, std::span<const std::uint8_t> bytes);
  void add_subscription(Subscription subscription);
  void on_message(const std::string& pattern, std::string_view name, const Payload& bytes);
  /// What is in the delivery; null, and counted, where that does not decode or cannot be true.
  template <class Message>
  std::shared_ptr<const Message> message_of(Delivery& delivery);
  bool is_fresh(Delivery& delivery, const models::Stamp& stamp);
  /// Counts of every channel heard, by name.
  [[nodiscard]] std::map<std::string, StreamCounts> stream_counts() const;
  void count_fault(Delivery& delivery, std::map<std::string, std::int64_t>& counts);

  Transport& transport_;
  const Clock* clock_ = nullptr;
  std::unique_ptr<auth::Authenticator> authenticator_;
  const Clock* signing_clock_ = nullptr;
  std::string answers_to_;
  bool hears_signed_ = false;
  std::int64_t run_id_;
  std::string publish_prefix_;
  std::deque<Subscription> subscriptions_;  ///< a deque: handlers may subscribe
  ChannelIndex index_;                      ///< of subscriptions_
  std::shared_ptr<Bus*> self_;              ///< the transport's handlers look whether it is gone
  std::vector<std::uint8_t> buffer_;        ///< of the message being encoded
  std::int64_t handling_ns_ = 0;
  std::int64_t streams_refused_ = 0;  ///< messages on more channels than kStreamsMax
  ByName<std::int64_t> next_sequence_;
  ByName<StreamMonitor> streams_;
  ByName<SharedStreamMonitor> shared_streams_;
  StreamCounts left_;  ///< of streams that are no more listened to
  std::int64_t undecoded_ = 0;
  std::map<std::string, std::int64_t> decode_errors_;  ///< by channel: wrong type or truncated
  std::map<std::string, std::int64_t> refused_;        ///< by channel: decoded, but cannot be true
};

}  // namespace vantage::bus

#include "bus/node/bus_impl.hpp"  // IWYU pragma: export
