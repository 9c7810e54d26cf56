#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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
class MulticastSocket {
 public:
  /// @throws StartupError saying what is wrong, above all when no route leads to the group, or the
  ///         interface is none of this host's.
  explicit MulticastSocket(const UdpmAddress& address);
  ~MulticastSocket();
  MulticastSocket(const MulticastSocket&) = delete;
  MulticastSocket& operator=(const MulticastSocket&) = delete;
  MulticastSocket(MulticastSocket&&) = delete;
  MulticastSocket& operator=(MulticastSocket&&) = delete;

  /// Sends `head` and `payload` as one datagram; false when the network refuses, or for 100 ms has
  /// no room.
  bool send(std::span<const std::uint8_t> head, std::span<const std::uint8_t> payload);
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

  void find_interface(const std::string& interface);
  void open_receiver(const UdpmAddress& address);
  void open_sender(const UdpmAddress& address);

  sockaddr_in group_{};
  ip_mreqn membership_{};  ///< the group, and the card if one was named
  Descriptor receiver_;
  Descriptor sender_;
  std::vector<std::uint8_t> buffer_;
  std::int64_t receive_buffer_bytes_ = 0;
  std::uint32_t kernel_drops_seen_ = 0;  ///< the kernel's counter, which wraps
  std::int64_t kernel_drops_ = 0;
};

}  // namespace vantage::bus::udpm
