#pragma once

#include <deque>
#include <string>

#include "bus/transport/transport.hpp"
#include "bus/transport/udpm_reassembly.hpp"
#include "bus/transport/udpm_socket.hpp"

namespace vantage::bus::udpm {

/// LCM's UDP multicast, compatible on the wire, without liblcm: its receive thread can be crashed
/// by one datagram and waits up to 10 s for a network that filters. No thread: everything happens
/// inside handle(), on bytes that were checked first.
///
/// What has arrived is taken from the kernel before handlers are called and between them, into a
/// queue of recv_buf_size bytes (at least max_message_size); the oldest messages give way. The
/// kernel's own buffer, which keeps the oldest and is seldom granted in full, overflows only while
/// one handler runs for long.
class UdpmTransport : public Transport {
 public:
  /// @param report  for an absent network, as open_waiting_transport(); nullptr: that is an error
  /// @throws StartupError as MulticastSocket.
  explicit UdpmTransport(const UdpmAddress& address, ReportNetwork report = nullptr);

  void subscribe(const std::string& channel, Handler handler) override;
  void unsubscribe(const std::string& channel) override;
  bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) override;
  /// Dispatches at most 4096 messages, and none once 5 ms more than `timeout` have passed, so that
  /// a flood cannot keep the caller; what has arrived and is not dispatched waits for the next
  /// call.
  /// @throws UsageError when called from a handler.
  int handle(std::chrono::microseconds timeout) override;
  [[nodiscard]] TransportStats stats() const override;
  /// Messages that were refused for their size, by channel.
  [[nodiscard]] const auto& oversized() const { return reassembler_.oversized(); }
  /// `max_message_size` of the URL.
  [[nodiscard]] std::size_t message_bytes_max() const { return message_bytes_max_; }

 private:
  struct Subscription {
    std::string pattern;  ///< empty: nobody's place
    Handler handler;
  };
  void keep_network();
  bool send_fragments(const std::string& channel, std::span<const std::uint8_t> bytes,
                      const Cut& cut, std::uint32_t sequence);
  void take_arrived();
  void take(const Datagram& datagram);
  void enqueue(AssembledMessage message);
  [[nodiscard]] bool is_wanted(std::string_view channel) const;
  void dispatch(const AssembledMessage& message);

  std::size_t message_bytes_max_;
  std::int64_t receive_buffer_asked_bytes_;
  std::size_t arrived_bytes_max_;
  MulticastSocket socket_;
  ReportNetwork report_;
  bool is_loss_reported_ = false;
  Reassembler reassembler_;
  std::deque<AssembledMessage> arrived_;
  std::size_t arrived_bytes_ = 0;
  std::int64_t taken_at_ns_ = 0;            ///< when the kernel was asked last
  std::deque<Subscription> subscriptions_;  ///< a deque: handlers may subscribe
  std::uint32_t next_sequence_ = 0;
  bool is_handling_ = false;
  TransportStats stats_;
};

}  // namespace vantage::bus::udpm
