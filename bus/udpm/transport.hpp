#pragma once

#include <deque>
#include <string>

#include "bus/transport.hpp"
#include "bus/udpm/reassembly.hpp"
#include "bus/udpm/socket.hpp"

namespace vantage::bus::udpm {

/// LCM's UDP multicast, compatible on the wire, without liblcm: its receive thread can be crashed
/// by one datagram and waits up to 10 s for a network that filters. No thread: everything happens
/// inside handle(), on bytes that were checked first.
class UdpmTransport : public Transport {
 public:
  /// @throws StartupError as MulticastSocket.
  explicit UdpmTransport(const UdpmAddress& address);

  void subscribe(const std::string& channel, Handler handler) override;
  bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) override;
  /// Takes at most 4096 datagrams, and none once 5 ms more than `timeout` have passed, so that a
  /// flood cannot keep the caller; what has arrived and is not taken waits for the next call.
  /// @throws UsageError when called from a handler.
  int handle(std::chrono::microseconds timeout) override;
  [[nodiscard]] TransportStats stats() const override;

 private:
  struct Subscription {
    std::string pattern;
    Handler handler;
  };
  bool send_fragments(const std::string& channel, std::span<const std::uint8_t> bytes,
                      const Cut& cut, std::uint32_t sequence);
  /// How many messages were dispatched: 0 or 1.
  int take(const Datagram& datagram);
  int dispatch(std::string_view channel, std::span<const std::uint8_t> bytes);

  std::size_t message_bytes_max_;
  std::int64_t receive_buffer_asked_bytes_;
  MulticastSocket socket_;
  Reassembler reassembler_;
  std::deque<Subscription> subscriptions_;  ///< a deque: handlers may subscribe
  std::uint32_t next_sequence_ = 0;
  bool is_handling_ = false;
  TransportStats stats_;
};

}  // namespace vantage::bus::udpm
