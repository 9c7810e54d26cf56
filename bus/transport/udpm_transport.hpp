#pragma once

#include <deque>
#include <optional>
#include <string>

#include "bus/transport/transport.hpp"
#include "bus/transport/udpm_reassembly.hpp"
#include "bus/transport/udpm_socket.hpp"
#include "bus/transport/unicast_relay.hpp"

namespace vantage::bus::udpm {

/// Transport by LCM's UDP multicast, with the datagram format of LCM but without liblcm. A single
/// datagram can crash liblcm's receive thread, and liblcm waits up to 10 s on a network that
/// filters multicast. This class has no thread: all work is done inside handle(), on bytes that
/// were checked first.
///
/// Arrived datagrams are read from the kernel before and between handler calls, into a queue of
/// recv_buf_size bytes (at least max_message_size). A full queue drops its oldest messages. The
/// kernel's own buffer drops the newest messages instead and is seldom granted in the requested
/// size. It overflows only during a long handler call.
class UdpmTransport : public Transport {
 public:
  /// @param report  enables waiting for a missing network, as open_waiting_transport(); nullptr: a
  /// missing network is an error
  /// @throws StartupError as MulticastSocket.
  explicit UdpmTransport(const UdpmAddress& address, ReportNetwork report = nullptr);

  void subscribe(const std::string& channel, Handler handler) override;
  void unsubscribe(const std::string& channel) override;
  bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) override;
  bool publish_on_host(const std::string& channel, std::span<const std::uint8_t> bytes) override;
  /// Dispatches at most 4096 messages, and none later than 5 ms after `timeout`, so that a flood
  /// cannot block the caller. The remaining messages wait for the next call.
  /// @throws UsageError when called from a handler.
  int handle(std::chrono::microseconds timeout) override;
  [[nodiscard]] TransportStats stats() const override;
  /// Returns the number and size of messages that were refused because of their size, by channel.
  [[nodiscard]] const auto& oversized() const { return reassembler_.oversized(); }
  /// Returns `max_message_size` of the URL.
  [[nodiscard]] std::size_t message_bytes_max() const { return message_bytes_max_; }

 private:
  struct Subscription {
    std::string pattern;  ///< channel or prefix; empty: the entry is unused
    Handler handler;
  };
  void keep_network();
  /// Removes the channel filter until the next handle(), so that a changed set of subscriptions is
  /// effective at once.
  void reset_filter();
  void apply_filter();
  bool publish_to(const std::string& channel, std::span<const std::uint8_t> bytes, Reach reach);
  /// Returns false if the datagram was not sent to this host's group. Peers that cannot be reached
  /// do not end a message for the own host; they set is_sent_to_peers_ to false.
  bool send(std::span<const std::uint8_t> head, std::span<const std::uint8_t> payload, Reach reach);
  bool send_fragments(const std::string& channel, std::span<const std::uint8_t> bytes,
                      const Cut& cut, std::uint32_t sequence, Reach reach);
  void take_arrived();
  void take(const Datagram& datagram);
  void enqueue(AssembledMessage message);
  [[nodiscard]] bool is_wanted(std::string_view channel) const;
  void dispatch(const AssembledMessage& message);

  std::size_t message_bytes_max_;
  std::int64_t receive_buffer_requested_bytes_;
  std::size_t arrived_bytes_max_;
  MulticastSocket socket_;
  std::optional<UnicastRelay> relay_;  ///< set if the URL has peers
  bool is_sent_to_peers_ = true;       ///< whether the present message reached all peers so far
  ReportNetwork report_;
  bool is_loss_reported_ = false;
  Reassembler reassembler_;
  std::deque<AssembledMessage> arrived_;
  std::size_t arrived_bytes_ = 0;
  std::int64_t taken_at_ns_ = 0;            ///< time of the last read from the kernel
  std::deque<Subscription> subscriptions_;  ///< a deque, so that handlers may subscribe
  std::uint32_t next_sequence_ = 0;
  bool is_filter_current_ = false;  ///< the kernel drops channels without a subscription
  bool is_handling_ = false;
  TransportStats stats_;
};

}  // namespace vantage::bus::udpm
