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

/// What a transport itself saw go wrong; all since it was opened.
struct TransportStats {
  std::int64_t messages_sent = 0;
  std::int64_t messages_received = 0;
  std::int64_t send_errors = 0;
  std::int64_t malformed_datagrams = 0;   ///< not LCM, or lying about lengths
  std::int64_t incomplete_messages = 0;   ///< given up with fragments missing
  std::int64_t queue_overflows = 0;       ///< oldest message dropped for a newer one
  std::int64_t oversized_messages = 0;    ///< refused for announcing more than the size cap
  std::int64_t duplicate_fragments = 0;   ///< ignored
  std::int64_t kernel_drops = 0;          ///< datagrams for which the socket buffer had no room
  std::int64_t receive_buffer_bytes = 0;  ///< what the kernel granted; 0 without a socket
  std::int64_t receive_buffer_short_bytes = 0;  ///< asked for and not granted (net.core.rmem_max)
  std::int64_t network_losses = 0;  ///< times that no route or card led to the group any more
};

/// What handle() answers when nothing can come any more.
inline constexpr int kSourceEnded = -1;

/// Moves bytes under channel names. The one thing to replace in order to leave LCM.
///
/// Not thread-safe: one owner, one thread, unless a class says otherwise.
class Transport {
 public:
  using Handler = std::function<void(std::string_view channel, const Payload& bytes)>;

  Transport() = default;
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  Transport(Transport&&) = delete;
  Transport& operator=(Transport&&) = delete;

  /// Calls `handler`, inside handle(), with every message on `channel`; a name that ends in '*'
  /// stands for every channel with that prefix ("*": all).
  virtual void subscribe(const std::string& channel, Handler handler) = 0;
  /// Forgets the handlers of that very name or pattern. A handler may call it of another name than
  /// those that it listens to itself.
  virtual void unsubscribe(const std::string& channel) = 0;
  /// False when the message could not be handed to the network (counted).
  virtual bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) = 0;
  /// Waits up to `timeout` for a message, then dispatches everything that has arrived; returns how
  /// many, or kSourceEnded once nothing can come any more (a log that was read to its end). An
  /// exception from a handler comes out here and leaves the transport usable. Not to be called from
  /// a handler.
  virtual int handle(std::chrono::microseconds timeout) = 0;
  [[nodiscard]] virtual TransportStats stats() const = 0;
};

/// Opens a transport by URL: "udpm://239.255.76.67:7667?ttl=1&interface=eth1" (LCM's multicast, our
/// own bounded receiver; other options in bus/transport/url), "memq://" (one process) or
/// "file://LOG?mode=r" (LCM's). An empty URL means $LCM_DEFAULT_URL, else LCM's default.
/// @throws StartupError saying what is wrong (no multicast route, no such card, unknown scheme, no
/// such file).
std::unique_ptr<Transport> open_transport(const std::string& url);

/// Called with one sentence when the network is lost, and when it is back.
using ReportNetwork = std::function<void(const std::string& words)>;
/// As open_transport(), but waits for a network of udpm that is absent (no multicast route, no such
/// card) instead of throwing: until it is there nothing is sent or received, and handle() tries
/// again. For processes that must run without a network, above all the driver of a vehicle.
std::unique_ptr<Transport> open_waiting_transport(const std::string& url, ReportNetwork report);

/// A bus inside one process: every endpoint hears what any endpoint (itself included) publishes,
/// in order. Thread-safe across endpoints; each endpoint has its own bounded queue.
class InProcessHub {
 public:
  explicit InProcessHub(std::size_t queue_capacity = 10'000);
  ~InProcessHub();
  InProcessHub(const InProcessHub&) = delete;
  InProcessHub& operator=(const InProcessHub&) = delete;
  InProcessHub(InProcessHub&&) = delete;
  InProcessHub& operator=(InProcessHub&&) = delete;

  /// A new endpoint. The hub must outlive it. `on_arrival` is called with every message that is put
  /// into its queue, by whoever published it: it has to be quick, and may not use the hub.
  std::unique_ptr<Transport> connect(std::function<void()> on_arrival = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vantage::bus
