#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "bus/transport/payload.hpp"

namespace vantage::bus {

/// Numbers of messages and errors of a transport since it was opened.
struct TransportStats {
  std::int64_t messages_sent = 0;
  std::int64_t messages_received = 0;
  std::int64_t send_errors = 0;
  /// datagrams that are not in LCM's format or have inconsistent lengths
  std::int64_t malformed_datagrams = 0;
  std::int64_t incomplete_messages = 0;  ///< messages discarded because fragments were missing
  std::int64_t queue_overflows = 0;      ///< old messages dropped to make room for newer ones
  /// messages refused because their announced size exceeds the limit
  std::int64_t oversized_messages = 0;
  std::int64_t duplicate_fragments = 0;   ///< fragments received twice and ignored
  std::int64_t kernel_drops = 0;          ///< datagrams dropped because the socket buffer was full
  std::int64_t receive_buffer_bytes = 0;  ///< bytes granted by the kernel; 0 without a socket
  /// bytes requested but not granted (net.core.rmem_max)
  std::int64_t receive_buffer_short_bytes = 0;
  std::int64_t network_losses = 0;  ///< datagrams lost on the route or by the network card
};

/// Receivers of a message.
enum class Reach : std::uint8_t {
  kHost,  ///< the processes of the sender's host
  kAll,
};

/// Result of handle() when no more messages can arrive.
inline constexpr int kSourceEnded = -1;

/// Interface for the transfer of bytes under channel names. Another implementation of this
/// interface is sufficient to replace LCM.
///
/// Not thread-safe unless a class states otherwise.
class Transport {
 public:
  using Handler = std::function<void(std::string_view channel, const Payload& bytes)>;

  Transport() = default;
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  Transport(Transport&&) = delete;
  Transport& operator=(Transport&&) = delete;

  /// Registers `handler` for every message on `channel`; handle() calls it. A name that ends in '*'
  /// matches every channel with that prefix; "*" matches all channels.
  virtual void subscribe(const std::string& channel, Handler handler) = 0;
  /// Removes the handlers of exactly that name or pattern. A handler must not remove its own
  /// subscription.
  virtual void unsubscribe(const std::string& channel) = 0;
  /// Returns false when the message could not be handed to the network (counted).
  virtual bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) = 0;
  /// As publish(), but the message does not leave this host. By default the same as publish(), for
  /// transports that do not reach other hosts.
  virtual bool publish_on_host(const std::string& channel, std::span<const std::uint8_t> bytes) {
    return publish(channel, bytes);
  }
  /// Waits up to `timeout` for a message, then dispatches all messages that have arrived. Returns
  /// their number, or kSourceEnded if no more can arrive (a log was read to its end). An exception
  /// of a handler is passed on to the caller and leaves the transport usable. Must not be called
  /// from a handler.
  virtual int handle(std::chrono::microseconds timeout) = 0;
  [[nodiscard]] virtual TransportStats stats() const = 0;
};

/// Opens a transport by URL: "udpm://239.255.76.67:7667?ttl=1&interface=eth1" (LCM's multicast with
/// the bounded receiver of this stack; other options in bus/transport/url), "memq://" (one process)
/// or "file://LOG?mode=r" (a log, read by liblcm). An empty URL means $LCM_DEFAULT_URL, or else
/// LCM's default.
/// @throws StartupError that names the problem (no multicast route, no such card, unknown scheme,
/// no such file).
std::unique_ptr<Transport> open_transport(const std::string& url);

/// Callback that receives one sentence when the network is lost, and when the network returns.
using ReportNetwork = std::function<void(const std::string& words)>;
/// As open_transport(), but does not fail when the udpm network is missing (no multicast route, no
/// such card). Until the network is present, nothing is sent or received, and handle() retries. Use
/// this function for processes that must run without a network, such as the driver of a vehicle.
std::unique_ptr<Transport> open_waiting_transport(const std::string& url, ReportNetwork report);

/// Network between the hosts of an InProcessHub, for simulations.
class HubNetwork {
 public:
  HubNetwork() = default;
  virtual ~HubNetwork() = default;
  HubNetwork(const HubNetwork&) = delete;
  HubNetwork& operator=(const HubNetwork&) = delete;
  HubNetwork(HubNetwork&&) = delete;
  HubNetwork& operator=(HubNetwork&&) = delete;
  /// Called once for each published message.
  virtual void send(std::string_view channel, std::size_t bytes, Reach reach) = 0;
  /// True if the message of the last send() arrives at `host`.
  virtual bool arrives_at(const std::string& host) = 0;
};

/// Bus within one process. Every endpoint receives the messages of all endpoints, including its
/// own, in order of publication. Thread-safe across endpoints; each endpoint has its own bounded
/// queue.
class InProcessHub {
 public:
  explicit InProcessHub(std::size_t queue_capacity = 10'000);
  ~InProcessHub();
  InProcessHub(const InProcessHub&) = delete;
  InProcessHub& operator=(const InProcessHub&) = delete;
  InProcessHub(InProcessHub&&) = delete;
  InProcessHub& operator=(InProcessHub&&) = delete;

  /// Creates an endpoint. The hub must outlive the endpoint. For every message put into the
  /// endpoint's queue, the publisher's thread calls `on_arrival`, which must be quick and must not
  /// use the hub.
  /// With a network, an endpoint with a nonempty `host` receives only messages that arrive there.
  std::unique_ptr<Transport> connect(std::function<void()> on_arrival = {}, std::string host = "");
  /// Sets the network between hosts; null: every message arrives everywhere. `network` must outlive
  /// the hub.
  void use_network(HubNetwork* network);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vantage::bus
