#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <netinet/in.h>

#include "bus/transport/url.hpp"

namespace vantage::bus::udpm {

/// One datagram; `bytes` stay valid until the next receive().
struct Datagram {
  std::uint64_t source = 0;  ///< the sender's address and port
  std::span<const std::uint8_t> bytes;
};

/// A pair of sockets on one multicast group: one hears the group, one sends to it.
///
/// Opening never waits. Datagrams sent are heard on this host as well, by the sender too.
///
/// The network may go and come back: a route that is deleted, a card that is taken out. The group
/// is then joined again (keep_joined()), since a new card has no part in the old membership.
class MulticastSocket {
 public:
  /// The treatment of a group to which no route or card leads when it is opened.
  enum class Absence { kError, kWaits };
  static constexpr std::int64_t kTryPeriodNs = 500'000'000;

  /// @throws StartupError saying what is wrong. Where absence is an error, above all when no route
  ///         leads to the group or the host does not have the interface.
  explicit MulticastSocket(const UdpmAddress& address, Absence absence = Absence::kError);
  ~MulticastSocket();
  MulticastSocket(const MulticastSocket&) = delete;
  MulticastSocket& operator=(const MulticastSocket&) = delete;
  MulticastSocket(MulticastSocket&&) = delete;
  MulticastSocket& operator=(MulticastSocket&&) = delete;

  /// Sends `head` and `payload` as one datagram; false when the network refuses, or for 100 ms has
  /// no room.
  bool send(std::span<const std::uint8_t> head, std::span<const std::uint8_t> payload);
  /// After a loss of the network: tries to join the group again, at most each kTryPeriodNs. True
  /// while the network is there.
  bool keep_joined(std::int64_t monotonic_ns);
  /// The error of the last try to join; empty: it succeeded.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  /// Times that the network was lost, or not there at the start.
  [[nodiscard]] std::int64_t network_losses() const { return network_losses_; }
  /// Waits up to `timeout`; true when there is something to receive.
  bool wait(std::chrono::nanoseconds timeout);
  /// The next datagram that has arrived; nullopt when there is none. Never waits.
  std::optional<Datagram> receive();

  /// What the kernel grants for datagrams waiting to be received.
  [[nodiscard]] std::int64_t receive_buffer_bytes() const { return receive_buffer_bytes_; }
  /// Datagrams lost because that was full, since opening.
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
  /// Joins the group. Returns the error in words; empty: the group is joined and can be sent to.
  std::string join();
  std::string find_interface();

  UdpmAddress address_;
  sockaddr_in group_{};
  ip_mreqn membership_{};  ///< the group, and the card if one was named
  Descriptor receiver_;
  Descriptor sender_;
  std::vector<std::uint8_t> buffer_;
  std::int64_t receive_buffer_bytes_ = 0;
  std::uint32_t kernel_drops_seen_ = 0;  ///< the kernel's counter, which wraps
  std::int64_t kernel_drops_ = 0;
  bool is_joined_ = false;
  std::string fault_;
  std::int64_t network_losses_ = 0;
  std::int64_t next_try_ns_ = 0;
};

}  // namespace vantage::bus::udpm
