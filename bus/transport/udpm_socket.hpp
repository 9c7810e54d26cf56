#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <linux/filter.h>
#include <netinet/in.h>

#include "bus/transport/url.hpp"

namespace vantage::bus::udpm {

/// One datagram; `bytes` stay valid until the next receive().
struct Datagram {
  std::uint64_t source = 0;  ///< the sender's address and port
  std::span<const std::uint8_t> bytes;
};

/// Pair of sockets for one multicast group: one receives from the group, the other sends to it.
///
/// Opening does not block. Sent datagrams are also received on this host, including by the sender.
///
/// The network may disappear and return, for example when a route is deleted or a card is removed.
/// keep_joined() then joins the group again, because a new card does not have the old membership.
class MulticastSocket {
 public:
  /// Behaviour when no route or network card leads to the group at opening: throw, or wait for the
  /// network.
  enum class Absence { kError, kWait };
  static constexpr std::int64_t kRetryPeriodNs = 500'000'000;

  /// @throws StartupError that names the problem. With Absence::kError also when no route leads to
  ///         the group or the host does not have the interface.
  explicit MulticastSocket(const UdpmAddress& address, Absence absence = Absence::kError);
  ~MulticastSocket();
  MulticastSocket(const MulticastSocket&) = delete;
  MulticastSocket& operator=(const MulticastSocket&) = delete;
  MulticastSocket(MulticastSocket&&) = delete;
  MulticastSocket& operator=(MulticastSocket&&) = delete;

  /// Sends `head` and `payload` as one datagram. Returns false when the network refuses it, or when
  /// the send buffer stays full for 100 ms.
  /// @param stays_on_host  true: the datagram does not leave this host, as with ttl=0
  bool send(std::span<const std::uint8_t> head, std::span<const std::uint8_t> payload,
            bool stays_on_host = false);
  /// After a loss of the network, tries to join the group again, at most once per kRetryPeriodNs.
  /// Returns true while the network is present.
  bool keep_joined(std::int64_t monotonic_ns);
  /// Returns the error text of the last attempt to join the group; empty if it succeeded.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  /// Returns the number of times that the network was lost, or was missing at the start.
  [[nodiscard]] std::int64_t network_losses() const { return network_losses_; }
  /// Makes the kernel drop the datagrams that `filter` rejects; an empty filter rejects none. If
  /// the kernel refuses the filter, all datagrams are received.
  void set_filter(std::span<const sock_filter> filter);
  /// Call this before a series of receive() calls. It determines whether the receive buffer may
  /// have overflowed, because the kernel also counts filtered datagrams as dropped.
  void begin_receiving();
  /// Waits up to `timeout`; returns true when a datagram can be received.
  bool wait(std::chrono::nanoseconds timeout);
  /// Returns the next datagram that has arrived; nullopt when there is none. Never waits.
  std::optional<Datagram> receive();

  /// Returns the size of the receive buffer that the kernel granted.
  [[nodiscard]] std::int64_t receive_buffer_bytes() const { return receive_buffer_bytes_; }
  /// Returns the number of datagrams dropped since opening because the receive buffer was full.
  /// With a filter, datagrams that it dropped at the same time are counted, too.
  [[nodiscard]] std::int64_t kernel_drops() const { return kernel_drops_; }

 private:
  class Descriptor {
   public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor();
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    Descriptor(Descriptor&&) = delete;
    Descriptor& operator=(Descriptor&&) = delete;
    [[nodiscard]] int fd() const { return fd_; }

   private:
    int fd_;
  };

  void open_receiver(const UdpmAddress& address);
  void open_sender(const UdpmAddress& address);
  /// Joins the group. Returns the error text; empty: the group is joined and sending is possible.
  std::string join();
  std::string find_interface();

  UdpmAddress address_;
  sockaddr_in group_{};
  ip_mreqn membership_{};  ///< the group, and the card if one is configured
  Descriptor receiver_;
  Descriptor sender_;
  std::vector<std::uint8_t> buffer_;
  std::int64_t receive_buffer_bytes_ = 0;
  std::uint32_t kernel_drops_seen_ = 0;  ///< last value of the kernel's counter, which wraps
  std::int64_t kernel_drops_ = 0;
  bool is_filtered_ = false;
  bool was_filtered_ = false;  ///< the kernel's counter may contain filtered datagrams
  bool is_full_ = false;  ///< the buffer was full at the start of the present series of receive()
  bool is_overflow_possible_ = false;  ///< an overflow is possible after the last reported one
  bool is_joined_ = false;
  std::string fault_;
  std::int64_t network_losses_ = 0;
  std::int64_t next_try_ns_ = 0;
  int ttl_set_ = 0;  ///< TTL that is set in sender_
};

}  // namespace vantage::bus::udpm
